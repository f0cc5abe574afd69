"""The numbers of one gearbox as the compiled model takes them: floats and arrays, made once from a configuration."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim import kinematics
from nw_gear_sim.dynamics import layout
from nw_gear_sim.kinematics import Kinematics
from nw_gear_sim.params import Configuration

LANES = 8
"""Tables of rollers are padded to a multiple of this, so that their loops fill whole vector registers."""
FAR = 1e3
"""Distance (m) that keeps a padded entry of such a table from ever being in contact."""
DIRECTION = {"ring": 1.0, "planet": 1.0, "sun": -1.0, "output": 1.0}
"""Sense of rotation about +z of each shaft (ring and planets turn counter-clockwise)."""


REAL, INDEX = np.float64, np.int64

RING = np.dtype(
    [
        ("segments", INDEX),
        ("base", REAL),  # base radius r_br, turns psi into p = psi r_br, m
        ("radius", REAL),  # r_c, m
        ("cos_half", REAL),  # of pi / M
        ("sin_half", REAL),
        ("radial", REAL),  # springs of a joint, N/m
        ("tangential", REAL),
        ("rotational", REAL),  # N m/rad
        ("axial", REAL),
        ("damping_time", REAL),  # s
        ("radial_support", REAL),  # N/m and N s/m to ground
        ("radial_support_damping", REAL),
        ("axial_support", REAL),
        ("axial_support_damping", REAL),
        ("mass", REAL),  # kg
    ]
)
"""One segment of the ring and its joint."""

MESH = np.dtype(
    [
        ("normal_x", REAL),  # transverse direction n of the force
        ("normal_y", REAL),
        ("driver", INDEX),  # entry of u of each gear; the ring has none of its own
        ("driven", INDEX),
        ("axial", INDEX),  # 1 where the elongation has a part along z
        ("offset", REAL),  # mesh phase above that of planet 1, rad
        ("planet_angle", REAL),  # rad
        ("cos_helix", REAL),  # of beta_b
        ("sin_helix", REAL),  # 0 where herringbone
        ("working_angle", REAL),  # rad
        ("driver_base", REAL),  # base radii, m
        ("driven_base", REAL),
        ("driver_arm", REAL),  # r_b tan(alpha_wt), m
        ("driven_arm", REAL),
        ("friction_sign", REAL),  # sigma: sense of the friction force on the driven gear along z x n
        ("stiffness", REAL),  # mean along the normal, N/m
        ("variation", REAL),
        ("phase", REAL),  # rad
        ("damping", REAL),  # N s/m
        ("damping_in_gap", INDEX),
        ("half_backlash", REAL),  # m
        ("error_mean", REAL),  # m
        ("error_amplitude", REAL),  # m
        ("ratio", REAL),  # excitation frequency over ring speed
    ]
)
"""One mesh; the array follows names.MESHES."""

BEARING = np.dtype(
    [
        ("first", INDEX),  # entry of x
        ("axes", INDEX),  # 3, or 2 without z
        ("kind", INDEX),  # row of the roller tables
        ("rollers", INDEX),  # entries of its tables, padded
        ("load", REAL),  # N/m^n
        ("cos_contact", REAL),
        ("sin_contact", REAL),
        ("clearance", REAL),  # m
        ("cage", REAL),  # cage angle over ring angle, signed
        ("damping", REAL),  # N s/m
        ("exponent", REAL),
    ]
)
"""One bearing; the array follows names.BEARINGS."""

SPRING = np.dtype([("a", INDEX), ("b", INDEX), ("scale_a", REAL), ("scale_b", REAL), ("stiffness", REAL), ("damping", REAL)])
"""A spring with damper between two motions: elongation = scale_a q_a - scale_b q_b."""


class Constants(NamedTuple):
    """Everything that the right-hand side needs besides state, angle, speed and torque.

    Record arrays and few plain ones: compiled code pays for every array of an argument at every call.
    """

    ring: np.ndarray  # RING, one entry
    angles: Array  # (2, M) cos, sin of 2 pi i / M
    mesh: np.ndarray  # MESH (7,)
    bearing: np.ndarray  # BEARING (10,)
    rollers: Array  # (3, 6, n) cos, sin of the roller angles in the frame of the cage, and what marks padding
    spring: np.ndarray  # SPRING
    gravity: Array  # (2,) acceleration, m/s^2
    weight: Array  # (63,) forces of gravity on the motions behind the ring, N
    mass: Array  # (n,) kg
    inverse_mass: Array  # (n,)
    output: int  # entry of u of herringbone_2
    output_share: float  # 1 / (total ratio * its base radius), 1/m


def build(configuration: Configuration, excitation: str) -> Constants:
    """Put the constants together; excitation is `kinematic` or `tied`."""
    k = kinematics.derive(configuration)
    mass = _masses(configuration, k)
    direction = configuration.gravity.direction
    gravity = configuration.gravity.acceleration * np.array([math.cos(direction), math.sin(direction)])
    segments = k.ring.count
    angle = 2 * np.pi * np.arange(segments) / segments
    return Constants(
        ring=_ring(k),
        angles=np.array([np.cos(angle), np.sin(angle)]),
        mesh=_meshes(configuration, k, excitation),
        bearing=_bearings(configuration, k),
        rollers=_rollers(configuration),
        spring=_springs(configuration, k),
        gravity=gravity,
        weight=_weights(segments, mass, gravity),
        mass=mass,
        inverse_mass=1.0 / mass,
        output=layout.centre(segments) + layout.H2,
        output_share=1.0 / (k.total_ratio * k.bodies.herringbone_2.base_radius),
    )


def _ring(k: Kinematics) -> np.ndarray:
    ring = np.zeros(1, RING)
    derived = {
        "segments": k.ring.count,
        "base": k.bodies.ring.base_radius,
        "cos_half": math.cos(math.pi / k.ring.count),
        "sin_half": math.sin(math.pi / k.ring.count),
    }
    for field in RING.names or ():
        ring[field] = derived[field] if field in derived else getattr(k.ring, field)
    return ring


def _meshes(configuration: Configuration, k: Kinematics, excitation: str) -> np.ndarray:
    meshes = np.zeros(len(names.MESHES), MESH)
    centre = layout.centre(k.ring.count)
    for row, mesh in zip(meshes, names.MESHES, strict=True):
        stage, (name, _, planet) = k.stage(mesh), mesh.partition("_")
        pair, stiffness = stage.pair, stage.stiffness
        j = int(planet) - 1 if planet else 0
        first, angle = layout.planet(k.ring.count, j), pair.working_angle
        row["normal_x"], row["normal_y"] = _normal(name, kinematics.PLANET_ANGLES[j], angle)
        ends = {
            "I": (0, first + layout.P1),
            "II": (first + layout.P2, centre + layout.SUN),
            "III": (centre + layout.H1, centre + layout.H2),
        }
        row["driver"], row["driven"] = ends[name]
        row["axial"] = pair.halves == 1
        row["offset"], row["planet_angle"] = stage.planet_phases[j], kinematics.PLANET_ANGLES[j]
        row["cos_helix"] = math.cos(pair.base_helix)
        row["sin_helix"] = math.sin(pair.base_helix) if row["axial"] else 0.0
        row["working_angle"] = angle
        for end in ("driver", "driven"):
            row[f"{end}_base"] = getattr(pair, end).base_radius
            row[f"{end}_arm"] = getattr(pair, end).base_radius * math.tan(angle)
        row["friction_sign"] = -1.0 if name == "II" else 1.0
        row["stiffness"], row["variation"] = stiffness.normal, stiffness.variation
        row["phase"], row["damping"] = stiffness.phase, stiffness.damping
        row["damping_in_gap"], row["half_backlash"] = configuration.mesh.damping_in_gap, stage.mesh.backlash
        row["error_mean"], row["error_amplitude"] = stage.mesh.error_mean, stage.mesh.error_amplitude
        row["ratio"] = (stage if excitation == "kinematic" else k.stage("II")).mesh_ratio
    return meshes


def _normal(stage: str, planet_angle: float, angle: float) -> Array:
    """Transverse direction along which the driver's motion closes the mesh."""
    if stage == "III":
        return np.array([math.sin(angle), -math.cos(angle)])
    outward = np.array([math.cos(planet_angle), math.sin(planet_angle)])
    along = np.array([-math.sin(planet_angle), math.cos(planet_angle)])
    return -math.sin(angle) * outward + (math.cos(angle) if stage == "I" else -math.cos(angle)) * along


def _bearings(configuration: Configuration, k: Kinematics) -> np.ndarray:
    bearings = np.zeros(len(names.BEARINGS), BEARING)
    centre, kinds = layout.centre(k.ring.count), list(kinematics.SHAFT_OF_BEARING)
    central = {"sb": layout.SB, "b1": layout.B1, "b21": layout.B21, "b22": layout.B22}
    for row, bearing in zip(bearings, names.BEARINGS, strict=True):
        kind, _, planet = bearing.partition("_")
        parameters = getattr(configuration.bearings, kind)
        if planet:
            within = layout.PB1 if kind == "pb1" else layout.PB2
            row["first"] = layout.planet(k.ring.count, int(planet) - 1) + within
        else:
            row["first"] = centre + central[kind]
        row["axes"] = 2 if kind in ("b21", "b22") else 3
        row["kind"], row["rollers"] = kinds.index(kind), _padded(parameters.rollers)
        row["load"], row["exponent"] = k.roller_stiffness[kind], configuration.bearings.exponent
        row["cos_contact"], row["sin_contact"] = math.cos(parameters.contact_angle), math.sin(parameters.contact_angle)
        row["clearance"], row["damping"] = parameters.clearance, parameters.damping
        row["cage"] = k.cage_ratio[kind] * DIRECTION[kinematics.SHAFT_OF_BEARING[kind]]
    return bearings


def _padded(count: int) -> int:
    return -(-count // LANES) * LANES


def _rollers(configuration: Configuration) -> Array:
    counts = [getattr(configuration.bearings, kind).rollers for kind in kinematics.SHAFT_OF_BEARING]
    rollers = np.zeros((3, len(counts), _padded(max(counts))))
    rollers[2] = FAR
    for row, count in enumerate(counts):
        angle = 2 * np.pi * np.arange(count) / count
        rollers[:, row, :count] = np.cos(angle), np.sin(angle), np.zeros(count)
    return rollers


def _springs(configuration: Configuration, k: Kinematics) -> np.ndarray:
    shafts, torsion, generator = configuration.shafts, configuration.torsion, configuration.generator
    segments = k.ring.count
    rows: list[tuple[int, int, float, float, float, float]] = []

    def chain(parts: list[int], axes: str, stiffness: dict[str, float]) -> None:
        for a, b in zip(parts, parts[1:], strict=False):
            for i, axis in enumerate(axes):
                value = stiffness["z" if axis == "z" else "x"]
                rows.append((a + i, b + i, 1.0, 1.0, value, value * shafts.damping_time))

    def twist(a: int, b: int, radii: tuple[float, float], stiffness: float) -> None:
        rows.append((a, b, 1 / radii[0], 1 / radii[1], stiffness, stiffness * torsion.damping_time))

    bodies, centre = k.bodies, layout.centre(segments)
    for j in range(kinematics.PLANETS):
        p = layout.planet(segments, j)
        pin = {"x": shafts.planet_radial, "z": shafts.planet_axial}
        chain([p + layout.PB1, p + layout.P1 + 1, p + layout.PB2, p + layout.P2 + 1], "xyz", pin)
        radii = (bodies.planet_1.base_radius, bodies.planet_2.base_radius)
        twist(p + layout.P1, p + layout.P2, radii, torsion.planet)
    shaft = [centre + layout.SB, centre + layout.SUN + 1, centre + layout.H1 + 1, centre + layout.B1]
    chain(shaft, "xyz", {"x": shafts.sun_radial, "z": shafts.sun_axial})
    twist(centre + layout.SUN, centre + layout.H1, (bodies.sun.base_radius, bodies.herringbone_1.base_radius), torsion.sun)
    chain([centre + layout.B21, centre + layout.H2 + 1, centre + layout.B22], "xy", {"x": shafts.output_radial})
    output, radius = centre + layout.H2, bodies.herringbone_2.base_radius
    rows.append((output, output, 1 / radius, 0.0, generator.stiffness, generator.stiffness * generator.damping_time))
    return np.array(rows, SPRING)


def _masses(configuration: Configuration, k: Kinematics) -> Array:
    """Mass of every motion; u moves I / r_b^2, and so does p of a ring segment with its own inertia."""
    bearings, bodies, segments = configuration.bearings, k.bodies, k.ring.count

    def gear(body: object, axes: int) -> list[float]:
        return [body.base_mass, *[body.mass] * axes]  # type: ignore[attr-defined]

    planet = [*[bearings.pb1.mass] * 3, *gear(bodies.planet_1, 3), *[bearings.pb2.mass] * 3, *gear(bodies.planet_2, 3)]
    shaft = [*gear(bodies.sun, 3), *[bearings.sb.mass] * 3, *gear(bodies.herringbone_1, 3), *[bearings.b1.mass] * 3]
    output = [*gear(bodies.herringbone_2, 2), *[bearings.b21.mass] * 2, *[bearings.b22.mass] * 2]
    rotary = k.ring.inertia / bodies.ring.base_radius**2
    ring = [value for value in (k.ring.mass, k.ring.mass, rotary, k.ring.mass) for _ in range(segments)]
    return np.array([*ring, *planet * 3, *shaft, *output])


def _weights(segments: int, mass: Array, gravity: Array) -> Array:
    weight = np.zeros(layout.RIGID)
    for i, name in enumerate(layout.motions(segments)):
        axis = name.split()[-1]
        if i >= 4 * segments and axis in ("x", "y"):
            weight[i - 4 * segments] = mass[i] * gravity["xy".index(axis)]
    return weight
