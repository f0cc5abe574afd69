"""From configurations to the constants of a block of points: arrays with the points in the last axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.assembly import assemble, masses, start_phases
from nw_gear_sim.batch import meshes, ringstep, rollers, stepping, wheels
from nw_gear_sim.batch.pairs import Key, Pair, Residual, ring_pairs
from nw_gear_sim.kinematics import Kinematics, derive
from nw_gear_sim.layout import Layout
from nw_gear_sim.model import Laws
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.friction import FrictionLaw, empty_table, fill_table

ZERO_PAIR = Pair(0, 0.0, 0.0, 0j, 0j, 0.0, 0j, 0.0)


@dataclass(frozen=True, eq=False)
class Point:
    """One parameter point before it is put into a lane.

    Attributes:
        laws, layout, kinematics, mass: as `Gearbox` has them.
        pairs, residual: of the ring.
        speed, torque: of the ring, rad/s and N m.
    """

    configuration: Configuration
    laws: Laws
    layout: Layout
    kinematics: Kinematics
    mass: Array
    pairs: dict[Key, Pair]
    residual: Residual
    speed: float
    torque: float

    @property
    def first(self) -> int:
        """The first motion that isn't the ring's."""
        return 4 * self.layout.segments


def make_points(configurations: Sequence[Configuration], excitation: str, ring: str) -> list[Point]:
    """Prepare the points.

    Raises:
        InputError: a value differs that has to be the same in all points.
    """
    first = configurations[0]
    for configuration in configurations[1:]:
        _refuse_different(first, configuration)
    known: dict[bytes, tuple[dict[Key, Pair], Residual]] = {}
    points = []
    for configuration in configurations:
        kinematics = derive(configuration)
        laws, layout = assemble(configuration, excitation)
        mass = masses(configuration, kinematics, layout)
        bandwidth = None if ring == "rigid" else configuration.numerics.ring_bandwidth
        key = _fingerprint(laws, mass[: 4 * layout.segments], bandwidth)
        if key not in known:
            known[key] = ring_pairs(laws, mass, bandwidth)
        speed, torque = kinematics.ring_speed, kinematics.input_torque
        points.append(Point(configuration, laws, layout, kinematics, mass, *known[key], speed, torque))
    return points


def _refuse_different(first: Configuration, other: Configuration) -> None:
    same = {"ring.segments": (first.ring.segments, other.ring.segments)}
    same["bearings.exponent"] = (first.bearings.exponent, other.bearings.exponent)
    for kind in ("pb1", "pb2", "sb", "b1", "b21", "b22"):
        counts = getattr(first.bearings, kind).rollers, getattr(other.bearings, kind).rollers
        same[f"bearings.{kind}.rollers"] = counts
    for place, (expected, got) in same.items():
        if expected != got:
            raise InputError(place, f"the same value in all points of a batch ({expected:g})", f"{got:g}")


def _fingerprint(laws: Laws, mass: Array, bandwidth: float | None) -> bytes:
    parts = [np.asarray(value, dtype=np.float64).tobytes() for value in (*laws.ring, *laws.engagement, mass)]
    return b"".join(parts) + repr(bandwidth).encode()


def block_laws(points: Sequence[Point], step: float, angle: Array) -> stepping.Laws:
    """Return the constants of a block.

    Args:
        points: one for each lane.
        step: of time, s.
        angle: of the ring at step 0, rad, (lanes,).
    """
    psi, cage = _psi(points, step, angle), _cage(points, step, angle)
    return stepping.Laws(
        wheels=_wheels(points, step),
        ring=_ring(points, step),
        mesh=_meshes(points, step, angle, psi),
        rollers=_rollers(points, cage),
        psi=psi,
        cage=cage,
    )


def _lanes(rows: Sequence[object]) -> Array:
    """Stack values of the points along a new last axis."""
    return np.ascontiguousarray(np.stack([np.asarray(row, dtype=np.float64) for row in rows], axis=-1))


def damped_step(square: Array, damping: Array, step: float) -> tuple[Array, Array]:
    """Return decay and gain of d' = decay d + gain (f - square x), exact for the free motion.

    decay = exp(-gamma h), gain = (1 - 2 sqrt(decay) cos(w h) + decay) / square with w^2 = square - gamma^2 / 4; for
    square = 0 the gain is h (1 - decay) / gamma, or h^2.
    """
    decay = np.exp(-damping * step)
    beat = np.sqrt((square - damping**2 / 4).astype(np.complex128))
    swing = (1 - 2 * np.sqrt(decay) * np.cos(beat * step).real + decay) / np.where(square > 0, square, 1.0)
    small = damping * step < 1e-9
    free = np.where(small, step**2, -step * np.expm1(-damping * step) / np.where(small, 1.0, damping))
    return decay, np.where(square > 0, swing, free)


def _wheels(points: Sequence[Point], step: float) -> wheels.WheelLaw:
    first, layout = points[0].first, points[0].layout
    rest = layout.size - first

    def place(name: str, motion: str) -> int:
        found = getattr(layout.nodes[name], motion) if name else -1
        return found - first if found >= 0 else rest

    chains = [[f"{part}_{j}" for part in ("pb1", "p1", "pb2", "p2")] for j in (1, 2, 3)]
    chains.append(["sb", "s", "h1", "b1"])
    rows = [[place(name, axis) for name in chain] for chain in chains for axis in ("x", "y", "z")]
    rows += [[place(name, axis) for name in ("b21", "h2", "b22", "")] for axis in ("x", "y")]
    twists = [[place(f"p1_{j}", "u"), place(f"p2_{j}", "u")] for j in (1, 2, 3)]
    twists += [[place("s", "u"), place("h1", "u")], [place("h2", "u"), rest]]
    springs = [_spring_tables(point, rows, twists, rest) for point in points]
    constant, damping, mass = zip(*(_motions(point) for point in points), strict=True)
    decay, gain = damped_step(np.zeros((rest + 1, len(points))), _lanes(damping), step)
    return wheels.WheelLaw(
        chain=np.array(rows),
        spring=_lanes([s[0] for s in springs]),
        twist=np.array(twists),
        aa=_lanes([s[1][0] for s in springs]),
        ab=_lanes([s[1][1] for s in springs]),
        bb=_lanes([s[1][2] for s in springs]),
        lag=_lanes([point.configuration.shafts.damping_time / (2 * step) for point in points]),
        twist_lag=_lanes([s[1][3] / (2 * step) for s in springs]),
        load=_lanes(constant),
        decay=decay,
        gain=gain / _lanes(mass),
    )


def _spring_tables(point: Point, rows: list[list[int]], twists: list[list[int]], rest: int) -> tuple[Array, Array]:
    """Return stiffness along the chains (chains, 3), and aa, ab, bb, damping time of the torsion springs, (4, twists)."""
    law = point.laws.springs
    known = {
        (int(i) - point.first, int(k) - point.first if i != k else rest): (aa, ab, bb, time)
        for i, k, aa, ab, bb, time in zip(*law, strict=True)
    }
    chain = np.array([[known.get((a, b), (0.0,))[0] for a, b in zip(row, row[1:], strict=False)] for row in rows])
    return chain, np.array([known[a, b] for a, b in twists]).T


def _motions(point: Point) -> tuple[Array, Array, Array]:
    """Return constant force (N), rate of damping to ground (1/s) and mass (kg) of gears' and bearings' motions."""
    laws, first = point.laws, point.first
    load = np.append(laws.weight[first:], 0.0)
    load[laws.output - first] += laws.output_push * point.torque
    damping = np.zeros(len(load))
    for place, value in zip(laws.bearings.place, laws.bearings.damping, strict=True):
        for k in place[place >= 0]:
            damping[k - first] = value
    mass = np.append(point.mass[first:], 1.0)
    return load, damping / mass, mass


def _ring(points: Sequence[Point], step: float) -> ringstep.RingLaw:
    keys = sorted(set().union(*(point.pairs for point in points)))
    pairs = [[point.pairs.get(key, ZERO_PAIR) for point in points] for key in keys]

    def column(name: str) -> Array:
        return np.array([[getattr(pair, name) for pair in row] for row in pairs])

    def parts(values: Array) -> Array:
        return np.ascontiguousarray(np.stack([values.real, values.imag], axis=1))

    decay, gain = damped_step(column("square"), column("damping"), step)
    there = np.array([[key in point.pairs for point in points] for key in keys])
    turns = sorted({_turns(key) for key in keys})
    angle = np.outer(turns, [point.speed * step for point in points])
    torque = np.array([point.torque for point in points])
    return ringstep.RingLaw(
        straight=sum(key[0] == 0 for key in keys),
        harmonic=np.array([turns.index(_turns(key)) for key in keys]),
        turn_cos=np.cos(angle),
        turn_sin=np.sin(angle),
        square=column("square"),
        decay=np.where(there, decay, 0.0),
        gain=np.where(there, gain, 0.0),
        normal=parts(column("normal")),
        slide=parts(column("slide")),
        roll=column("roll"),
        load=parts(column("weight") + 1j * column("push") * torque),
    )


def _turns(key: Key) -> int:
    return -key[1] if key[1] % 3 == 2 else key[1]


def _psi(points: Sequence[Point], step: float, angle: Array) -> Array:
    """Phase psi of the meshes at step 0 and its advance in a step, rad, (2, 7, lanes)."""
    found = np.empty((2, 7, len(points)))
    for lane, point in enumerate(points):
        ratio = point.laws.phase_ratio[list(meshes.STAGE)]
        found[0, :, lane] = ratio * angle[lane] + [g for stage in point.kinematics.stages for g in stage.planet_phases]
        found[1, :, lane] = ratio * point.speed * step
    return found


def _cage(points: Sequence[Point], step: float, angle: Array) -> Array:
    ratio = _lanes([point.laws.bearings.cage_ratio for point in points])
    return np.stack([ratio * angle, ratio * np.array([point.speed * step for point in points])])


def _meshes(points: Sequence[Point], step: float, angle: Array, psi: Array) -> meshes.MeshLaw:
    laws = [point.laws.mesh for point in points]
    stages = [[stage for stage in point.kinematics.stages for _ in stage.planet_phases] for point in points]
    swing = _lanes([[s.stiffness.normal * abs(s.stiffness.variation) for s in row] for row in stages])
    error = _lanes([[s.mesh.error_amplitude for s in row] for row in stages])
    starts = _lanes([np.array(start_phases(point.kinematics))[list(meshes.STAGE)] for point in points])
    first = _lanes([[1.0] * 3 + [0.0] * 4 for _ in points])
    own = np.array([point.residual.own - point.residual.neighbour for point in points])
    push = np.array([point.residual.push * point.torque for point in points])
    return meshes.MeshLaw(
        stiffness=_lanes([law.stiffness for law in laws]),
        swing=swing,
        error_mean=_lanes([law.error_mean for law in laws]) + first * push,
        error_swing=error,
        error_rate=error * psi[1] / step,
        turn_cos=np.cos(psi[1]),
        turn_sin=np.sin(psi[1]),
        backlash=_lanes([law.backlash for law in laws]),
        damping=_lanes([law.damping for law in laws]),
        gap_damping=_lanes([[float(law.damping_in_gap)] * 7 for law in laws]),
        flexible=first * own,
        beside=first * np.array([point.residual.neighbour for point in points]),
        per_step=1 / (2 * step),
        start=np.mod((psi[0] + starts) / (2 * math.pi), 1.0),
        advance=psi[1] / (2 * math.pi),
        table=_lanes([_friction_table(point.laws.friction, point.speed) for point in points]),
        gears=_gear_rows(points),
    )


def _gear_rows(points: Sequence[Point]) -> meshes.GearRows:
    nodes, first = points[0].layout.nodes, points[0].first
    rest = points[0].layout.size - first
    touching = [(f"p1_{j + 1}", j) for j in range(3)]
    touching += [(name, 3 + j) for j in range(3) for name in (f"p2_{j + 1}", "s")] + [("h1", 6), ("h2", 6)]
    places, shape = [], (len(touching), 4)
    for name, _ in touching:
        node = nodes[name]
        places.append([k - first if k >= 0 else rest for k in (node.u, node.x, node.y, node.z)])
    normal, slide, roll = [], [], []
    for point in points:
        tables = [np.zeros(shape) for _ in range(3)]
        rows = point.laws.rows
        for contact, (_, mesh) in enumerate(touching):
            for entry, place in enumerate(rows.place[mesh]):
                if place - first in places[contact]:
                    column = places[contact].index(place - first)
                    for table, source in zip(tables, (rows.normal, rows.slide, rows.roll), strict=True):
                        table[contact, column] = source[mesh, entry]
        normal.append(tables[0])
        slide.append(tables[1][:, :3])
        roll.append(tables[2][:, 0])
    return meshes.GearRows(
        place=np.array(places),
        mesh=np.array([mesh for _, mesh in touching]),
        normal=_lanes(normal),
        slide=_lanes(slide),
        roll=_lanes(roll),
    )


def _rollers(points: Sequence[Point], cage: Array) -> rollers.RollerLaw:
    laws, first = [point.laws.bearings for point in points], points[0].first
    rest = points[0].layout.size - first
    start, opposed, cos, sin = rollers.pattern(np.diff(laws[0].start))
    radial, axial = _lanes([law.radial for law in laws]), _lanes([law.axial for law in laws])
    stiffness = _lanes([law.stiffness for law in laws])
    return rollers.RollerLaw(
        place=np.where(laws[0].place >= 0, laws[0].place - first, rest),
        start=start,
        opposed=opposed,
        cos=cos,
        sin=sin,
        radial=radial,
        axial=axial,
        clearance=_lanes([law.clearance for law in laws]),
        radial_force=stiffness * radial,
        axial_force=stiffness * axial,
        turn_cos=np.cos(cage[1]),
        turn_sin=np.sin(cage[1]),
        power=rollers.power_law(points[0].configuration.bearings.exponent),
    )




def _friction_table(law: FrictionLaw, speed: float) -> Array:
    """Return g and g_1 (m) of the stages over the mesh phase at a ring speed (rad/s), (3, PHASES + 1, 2)."""
    table = empty_table()
    if law.base > 0.0 or law.growth > 0.0:
        fill_table(law, speed, table)
    return np.moveaxis(table, 1, 2)
