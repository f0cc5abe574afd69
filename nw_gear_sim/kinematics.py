"""Everything that follows from the configuration alone: ratios, mesh phasing, geometry, stiffness, masses, frequencies.

`derive(configuration)` is computed once; neither the simulator nor the monitor derives such a number elsewhere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_sim.geometry import PairGeometry, solve_pair
from nw_gear_sim.params import Configuration, Mesh
from nw_gear_sim.stiffness import MeshStiffness, mesh_stiffness, roller_stiffness
from nw_gear_sim.structure import Body, RingSegments, ring_body, ring_segments, wheel_body

PLANETS = 3
PLANET_ANGLES = tuple(2 * math.pi * j / PLANETS for j in range(PLANETS))
"""Angles th_j of the planets' fixed axes about the gearbox axis, rad."""

SHAFT_OF_BEARING = {"pb1": "planet", "pb2": "planet", "sb": "sun", "b1": "sun", "b21": "output", "b22": "output"}
"""The shaft that turns in each kind of bearing."""


@dataclass(frozen=True)
class Stage:
    """One gear stage.

    Attributes:
        name: I, II or III.
        pair: its geometry, driver to driven.
        stiffness: of one of its meshes.
        mesh: its parameters (backlash, transmission error, damping ratio).
        mesh_ratio: mesh frequency (rad/s) over ring speed (rad/s).
        planet_phases: gamma_j, what the mesh phase of planet j has more than that of planet 1, in [0, 2 pi), rad;
            one entry in stage III.
    """

    name: str
    pair: PairGeometry
    stiffness: MeshStiffness
    mesh: Mesh
    mesh_ratio: float
    planet_phases: tuple[float, ...]


@dataclass(frozen=True)
class Bodies:
    """The gears as rigid bodies."""

    ring: Body
    planet_1: Body
    planet_2: Body
    sun: Body
    herringbone_1: Body
    herringbone_2: Body


@dataclass(frozen=True)
class Kinematics:
    """What `derive` found.

    Attributes:
        stages: I, II, III.
        bodies: masses and inertias of the gears.
        ring: one segment of the flexible ring.
        roller_stiffness: load constant of each kind of bearing, N/m^n.
        shaft_ratio: speed of ring, planet, sun, output (names.SHAFTS) over that of the ring, without sign.
        cage_ratio: speed of the cage of each kind of bearing over that of the ring.
        roller_pass_ratio: frequency (rad/s) at which rollers pass a fixed point, over ring speed.
        omega_n: sqrt(K_m / M_e) of stage II, the unit of dimensionless frequencies, rad/s.
        ring_speed: speed of the ring at the fixed operating point (`excitation.omega_e` or
            `operation.ring_speed`), rad/s.
        input_torque: torque on the ring there, N m.
    """

    stages: tuple[Stage, Stage, Stage]
    bodies: Bodies
    ring: RingSegments
    roller_stiffness: dict[str, float]
    shaft_ratio: dict[str, float]
    cage_ratio: dict[str, float]
    roller_pass_ratio: dict[str, float]
    omega_n: float
    ring_speed: float
    input_torque: float

    def stage(self, name: str) -> Stage:
        """Return a stage by its name, or by that of one of its meshes."""
        return self.stages[names.STAGES.index(names.STAGE_OF_MESH.get(name, name))]

    def mesh_frequency_hz(self, name: str, ring_speed: float) -> float:
        """Return the mesh frequency of a stage in Hz; ring speed in rad/s."""
        return self.stage(name).mesh_ratio * ring_speed / (2 * math.pi)

    @property
    def total_ratio(self) -> float:
        """Speed of the output shaft over that of the ring."""
        return self.shaft_ratio["output"]


def bearing_kind(bearing: str) -> str:
    """Return the kind (`pb1`) of a bearing (`pb1_2`)."""
    return bearing.partition("_")[0]


def derive(configuration: Configuration) -> Kinematics:
    """Compute all derived numbers of a gearbox.

    Raises:
        InputError: the gearbox can't be assembled: no working angle at the common centre distance, no path of contact,
            planets that collide or don't fit between sun and ring, a bore or rim without material.
    """
    pairs = _pairs(configuration)
    _check_assembly(configuration, pairs)
    bodies = _bodies(configuration, pairs)
    shaft_ratio = _shaft_ratio(pairs)
    stages = _stages(configuration, pairs, bodies, shaft_ratio)
    omega_n = math.sqrt(stages[1].stiffness.transverse / stages[1].stiffness.effective_mass)
    operation, omega_e = configuration.operation, configuration.excitation.omega_e
    kinds = {kind: getattr(configuration.bearings, kind) for kind in SHAFT_OF_BEARING}
    cage_ratio = {kind: kinds[kind].cage_factor * shaft_ratio[shaft] for kind, shaft in SHAFT_OF_BEARING.items()}
    gears = configuration.gears
    return Kinematics(
        stages=stages,
        bodies=bodies,
        ring=ring_segments(gears.ring, configuration.ring, configuration.toothing.I, pairs[0].driver),
        roller_stiffness={k: roller_stiffness(b, configuration.bearings.exponent) for k, b in kinds.items()},
        shaft_ratio=shaft_ratio,
        cage_ratio=cage_ratio,
        roller_pass_ratio={kind: kinds[kind].rollers * ratio for kind, ratio in cage_ratio.items()},
        omega_n=omega_n,
        ring_speed=operation.ring_speed if omega_e is None else omega_e * omega_n / stages[1].mesh_ratio,
        input_torque=operation.load * configuration.turbine.rated_torque,
    )


def _pairs(configuration: Configuration) -> tuple[PairGeometry, PairGeometry, PairGeometry]:
    gears, toothing, distance = configuration.gears, configuration.toothing, configuration.centre_distance
    return (
        solve_pair("I", toothing.I, (gears.ring.teeth, gears.planet_1.teeth), distance.planets, ring=True),
        solve_pair("II", toothing.II, (gears.planet_2.teeth, gears.sun.teeth), distance.planets),
        solve_pair("III", toothing.III, (gears.herringbone_1.teeth, gears.herringbone_2.teeth), distance.output),
    )


def _check_assembly(configuration: Configuration, pairs: tuple[PairGeometry, ...]) -> None:
    """Planets must not touch each other, and fit between ring and sun at equal angles.

    A planet at th = 2 pi / 3 fits where (z_sun z_p1 + z_ring z_p2) / 3 is a multiple of gcd(z_p1, z_p2).
    """
    gap = 2 * configuration.centre_distance.planets * math.sin(math.pi / PLANETS)
    tip = 2 * max(pairs[0].driven.tip_radius, pairs[1].driver.tip_radius)
    if tip >= gap:
        expected = f"planets whose tip diameter is less than the distance {gap:.6g} m of their axes"
        raise InputError("centre_distance.planets", expected, f"{tip:.6g} m")
    z_ring, z_1 = configuration.gears.ring.teeth, configuration.gears.planet_1.teeth
    z_2, z_sun = configuration.gears.planet_2.teeth, configuration.gears.sun.teeth
    total, step = z_sun * z_1 + z_ring * z_2, PLANETS * math.gcd(z_1, z_2)
    if total % step:
        expected = f"sun * planet_1 + ring * planet_2 divisible by {step}, so that three equal planets fit"
        raise InputError("gears: numbers of teeth", expected, str(total))


def _bodies(configuration: Configuration, pairs: tuple[PairGeometry, ...]) -> Bodies:
    gears = configuration.gears
    first, second, third = pairs
    return Bodies(
        ring=ring_body(gears.ring, configuration.ring, first.driver),
        planet_1=wheel_body("gears.planet_1", gears.planet_1, first.driven),
        planet_2=wheel_body("gears.planet_2", gears.planet_2, second.driver),
        sun=wheel_body("gears.sun", gears.sun, second.driven),
        herringbone_1=wheel_body("gears.herringbone_1", gears.herringbone_1, third.driver),
        herringbone_2=wheel_body("gears.herringbone_2", gears.herringbone_2, third.driven),
    )


def _shaft_ratio(pairs: tuple[PairGeometry, ...]) -> dict[str, float]:
    ratios = [1.0]
    for pair in pairs:
        ratios.append(ratios[-1] * pair.speed_ratio)
    return dict(zip(names.SHAFTS, ratios, strict=True))


def _stages(
    configuration: Configuration, pairs: tuple[PairGeometry, ...], bodies: Bodies, shaft_ratio: dict[str, float]
) -> tuple[Stage, Stage, Stage]:
    toothing, mesh = configuration.toothing, configuration.mesh
    ends = (
        (bodies.ring, bodies.planet_1),
        (bodies.planet_2, bodies.sun),
        (bodies.herringbone_1, bodies.herringbone_2),
    )
    shafts = ("ring", "planet", "sun")
    turns = (-configuration.gears.ring.teeth, configuration.gears.sun.teeth, None)

    def stage(k: int) -> Stage:
        name, pair, (driver, driven) = names.STAGES[k], pairs[k], ends[k]
        effective = driver.base_mass * driven.base_mass / (driver.base_mass + driven.base_mass)
        parameters: Mesh = getattr(mesh, name)
        stiffness = mesh_stiffness(pair, getattr(toothing, name), parameters, effective)
        return Stage(name, pair, stiffness, parameters, pair.driver.teeth * shaft_ratio[shafts[k]], _phases(turns[k]))

    return stage(0), stage(1), stage(2)


def _phases(teeth: int | None) -> tuple[float, ...]:
    """Phases teeth * th_j in [0, 2 pi); one zero where the stage has a single mesh."""
    if teeth is None:
        return (0.0,)
    return tuple(2 * math.pi / PLANETS * (teeth * j % PLANETS) for j in range(PLANETS))
