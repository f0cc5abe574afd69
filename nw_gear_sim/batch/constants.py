"""From points to the constants of a block: arrays with the points in the last axis (see `lanes`)."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.assembly import start_phases
from nw_gear_sim.batch import meshes, ringstep, rollers, stepping, wheels
from nw_gear_sim.batch.pairs import Key, Pair
from nw_gear_sim.batch.points import Point
from nw_gear_sim.kinematics import bearing_kind
from nw_gear_sim.layout import Layout
from nw_gear_sim.physics.friction import FrictionLaw, empty_table, fill_table

ZERO_PAIR = Pair(0, 0.0, 0.0, 0j, 0j, 0.0, 0j, 0.0)


def block_laws(points: Sequence[Point], step: float, angle: Array, keys: Sequence[Key]) -> stepping.Laws:
    """Return the constants of a block.

    Args:
        points: one for each lane.
        step: of time, s.
        angle: of the ring at step 0, rad, (LANES,).
        keys: of the ring's pairs, those of all points.
    """
    psi = _psi(points, step, angle)
    return stepping.Laws(
        wheels=_wheels(points, step),
        ring=_ring(points, step, keys),
        mesh=_meshes(points, step, psi),
        rollers=_rollers(points),
        psi=psi,
        cage=_cage(points, step, angle),
    )


def _lanes(rows: Sequence[object]) -> Array:
    """Stack values of the points along a new last axis, flat."""
    return np.stack([np.asarray(row, dtype=np.float64) for row in rows], axis=-1).reshape(-1)


def _tables(*columns: Sequence[object]) -> list[Array]:
    """Stack values of the points: (rows,) where all points have the same in all columns, else (rows, LANES)."""
    stacks = [np.stack([np.asarray(row, dtype=np.float64).reshape(-1) for row in rows], axis=-1) for rows in columns]
    if all(bool(np.all(stack == stack[:, :1])) for stack in stacks):
        return [np.ascontiguousarray(stack[:, 0]) for stack in stacks]
    return [np.ascontiguousarray(stack) for stack in stacks]


@cache
def damped_step(square: float, damping: float, step: float) -> tuple[float, float]:
    """Return decay and gain of d' = decay d + gain (f - square x), exact for the free motion.

    decay = exp(-gamma h), gain = (1 - 2 sqrt(decay) cos(w h) + decay) / square with w^2 = square - gamma^2 / 4; for
    square = 0 the gain is h (1 - decay) / gamma, or h^2.
    """
    decay = math.exp(-damping * step)
    if square > 0.0:
        beat = cmath.sqrt(square - damping**2 / 4)
        return decay, (1 - 2 * math.sqrt(decay) * cmath.cos(beat * step).real + decay) / square
    return decay, step**2 if damping * step < 1e-9 else -step * math.expm1(-damping * step) / damping


def _damped_steps(square: Array, damping: Array, step: float) -> tuple[Array, Array]:
    """Return `damped_step` of arrays, number by number: NumPy's functions round by the place in an array."""
    both = np.array([damped_step(w, g, step) for w, g in zip(square.flat, damping.flat, strict=True)])
    return both[:, 0].reshape(square.shape), both[:, 1].reshape(square.shape)


def _unit(angle: Array) -> tuple[Array, Array]:
    """Return cosine and sine, number by number."""
    cos = np.array([math.cos(a) for a in angle.flat]).reshape(angle.shape)
    return cos, np.array([math.sin(a) for a in angle.flat]).reshape(angle.shape)


@cache
def places(segments: int) -> tuple[Layout, npt.NDArray[np.int64]]:
    """Return the layout, and for each motion of `wheels` its place after the ring's in it, -1 for the one at rest."""
    layout = Layout(segments)
    chains = [[layout.nodes[f"{part}_{j}"] for part in ("pb1", "p1", "pb2", "p2")] for j in (1, 2, 3)]
    chains.append([layout.nodes[part] for part in ("sb", "s", "h1", "b1")])
    rows = [[getattr(node, axis) for node in chain] for chain in chains for axis in ("x", "y", "z")]
    output = [layout.nodes[part] for part in ("b21", "h2", "b22")]
    rows += [[*(getattr(node, axis) for node in output), -1] for axis in ("x", "y")]
    twists = [[layout.nodes[f"p1_{j}"].u, layout.nodes[f"p2_{j}"].u] for j in (1, 2, 3)]
    twists += [[layout.nodes["s"].u, layout.nodes["h1"].u], [layout.nodes["h2"].u, -1]]
    found = np.concatenate([np.array(rows).T.ravel(), np.array(twists).T.ravel()])
    return layout, np.where(found >= 0, found - 4 * segments, -1)


def _row(point: Point, place: int) -> int:
    """Row of a motion of the layout in a block; of the one at rest where it is none."""
    of = places(point.layout.segments)[1]
    wanted = place - point.first if place >= 0 else -1
    return int(np.flatnonzero(of == wanted)[0])


def _wheels(points: Sequence[Point], step: float) -> wheels.WheelLaw:
    loads, dampings, masses_, springs = zip(*(_motions(point) for point in points), strict=True)
    decay, gain = zip(
        *(_damped_steps(np.zeros_like(d), d, step) for d in dampings),
        strict=True,
    )
    gains = [np.where(np.isfinite(m), g / m, 0.0) for g, m in zip(gain, masses_, strict=True)]
    lags = [s[4] / (2 * step) for s in springs]
    tables = _tables(*([s[k] for s in springs] for k in range(4)), decay, gains, lags)
    spring, aa, ab, bb, decays, gained, lag = tables
    return wheels.WheelLaw(spring, aa, ab, bb, _lanes(loads), decays, gained, lag)


def _motions(point: Point) -> tuple[Array, Array, Array, tuple[Array, Array, Array, Array, Array]]:
    """Return constant force (N), rate of damping to ground (1/s), mass (kg) of the motions, and their springs."""
    laws, first = point.laws, point.first
    of = places(point.layout.segments)[1]
    there = of >= 0
    load = laws.weight[first:].copy()
    load[laws.output - first] += laws.output_push * point.torque
    damping = np.zeros(len(load))
    for place, value in zip(laws.bearings.place, laws.bearings.damping, strict=True):
        damping[place[place >= 0] - first] = value
    mass = np.where(there, point.mass[first:][of], np.inf)
    rate = np.where(there, damping[of] / mass, 0.0)
    return np.where(there, load[of], 0.0), rate, mass, _springs(point, of)


def _springs(point: Point, of: npt.NDArray[np.int64]) -> tuple[Array, Array, Array, Array, Array]:
    """Return `spring`, `aa`, `ab`, `bb` of `WheelLaw`, and the damping time of the springs at each motion, s."""
    law = point.laws.springs
    known = {
        (int(i) - point.first, int(k) - point.first if i != k else -1): values
        for i, k, *values in zip(*law, strict=True)
    }
    time = np.zeros(wheels.MOTIONS)

    def pair(first: int, second: int) -> list[float]:
        values = known.get((of[first], of[second]), [0.0, 0.0, 0.0, 0.0])
        if of[first] >= 0 and values[0]:
            time[[first, second]] = values[3]
        return values

    count = wheels.CHAINS
    chain = np.array([pair(part * count + c, (part + 1) * count + c)[0] for part in range(3) for c in range(count)])
    ends = range(4 * count, 4 * count + wheels.TWISTS)
    twists = np.array([pair(first, first + wheels.TWISTS) for first in ends])
    return chain, twists[:, 0].copy(), twists[:, 1].copy(), twists[:, 2].copy(), time


def _ring(points: Sequence[Point], step: float, keys: Sequence[Key]) -> ringstep.RingLaw:
    common = all(point.pairs is points[0].pairs for point in points)
    shown = points[:1] if common else points
    pairs = [[point.pairs.get(key, ZERO_PAIR) for point in shown] for key in keys]

    def column(name: str) -> npt.NDArray[Any]:
        return np.array([[getattr(pair, name) for pair in row] for row in pairs])

    def table(values: Array) -> Array:
        return np.ascontiguousarray(values[:, 0] if common else values)

    there = np.array([[key in point.pairs for point in shown] for key in keys])
    decay, gain = (there * part for part in _damped_steps(column("square"), column("damping"), step))
    turns = sorted({_turns(key) for key in keys})
    angle = np.outer(turns, [point.speed * step for point in points])
    force = column("weight") + 1j * column("push") * np.array([point.torque for point in points])
    loaded = np.flatnonzero(np.any(force != 0, axis=1))
    kick = (gain / np.where(there, decay, 1.0) * force)[loaded]
    return ringstep.RingLaw(
        straight=sum(key[0] == 0 for key in keys),
        harmonic=np.array([turns.index(_turns(key)) for key in keys]),
        turn=np.stack(_unit(angle), axis=1).reshape(-1),
        square=table(column("square")),
        decay=table(decay),
        gain=table(gain),
        normal_re=table(column("normal").real),
        normal_im=table(column("normal").imag),
        slide_re=table(column("slide").real),
        slide_im=table(column("slide").imag),
        roll=table(column("roll")),
        loaded=loaded,
        kick=np.stack([kick.real, kick.imag], axis=1).reshape(-1),
    )


def _turns(key: Key) -> int:
    return -key[1] if key[1] % 3 == 2 else key[1]


def _phases(start: Array, advance: Array) -> stepping.Phases:
    turn = np.stack(_unit(advance)).reshape(-1)
    return stepping.Phases(start.reshape(-1), advance.reshape(-1), turn)


def _psi(points: Sequence[Point], step: float, angle: Array) -> stepping.Phases:
    """Phases psi of the meshes."""
    offset = np.array([[g for stage in p.kinematics.stages for g in stage.planet_phases] for p in points]).T
    ratio = np.array([point.laws.phase_ratio[list(meshes.STAGE)] for point in points]).T
    speed = np.array([point.speed for point in points])
    return _phases(ratio * angle + offset, ratio * speed * step)


def _cage(points: Sequence[Point], step: float, angle: Array) -> stepping.Phases:
    ratio = np.array([point.laws.bearings.cage_ratio for point in points]).T
    return _phases(ratio * angle, ratio * np.array([point.speed for point in points]) * step)


def _meshes(points: Sequence[Point], step: float, psi: stepping.Phases) -> meshes.MeshLaw:
    laws = [point.laws.mesh for point in points]
    stages = [[stage for stage in point.kinematics.stages for _ in stage.planet_phases] for point in points]
    error = _lanes([[s.mesh.error_amplitude for s in row] for row in stages])
    starts = _lanes([np.array(start_phases(point.kinematics))[list(meshes.STAGE)] for point in points])
    first = [1.0] * 3 + [0.0] * 4
    residuals = [point.residual for point in points]
    push = [np.multiply(first, point.residual.push * point.torque) for point in points]
    return meshes.MeshLaw(
        stiffness=_lanes([law.stiffness for law in laws]),
        swing=_lanes([[s.stiffness.normal * abs(s.stiffness.variation) for s in row] for row in stages]),
        error_mean=_lanes([law.error_mean + pushed for law, pushed in zip(laws, push, strict=True)]),
        error_swing=error,
        error_rate=error * psi.advance / step,
        backlash=_lanes([law.backlash for law in laws]),
        damping=_lanes([law.damping for law in laws]),
        gap_damping=_lanes([[float(law.damping_in_gap)] * 7 for law in laws]),
        flexible=_lanes([np.multiply(first, r.own - r.neighbour) for r in residuals]),
        beside=_lanes([np.multiply(first, r.neighbour) for r in residuals]),
        per_step=1 / (2 * step),
        start=np.mod((psi.start + starts) / (2 * math.pi), 1.0),
        advance=psi.advance / (2 * math.pi),
        table=np.stack([_friction_table(point.laws.friction, point.speed) for point in points], axis=1).copy(),
        gears=_gear_rows(points),
    )


def _gear_rows(points: Sequence[Point]) -> meshes.GearRows:
    point, nodes = points[0], points[0].layout.nodes
    touching = [(f"p1_{j + 1}", j) for j in range(3)]
    touching += [(name, 3 + j) for j in range(3) for name in (f"p2_{j + 1}", "s")] + [("h1", 6), ("h2", 6)]
    ends = [[nodes[name].u, nodes[name].x, nodes[name].y, nodes[name].z] for name, _ in touching]
    rows = []
    for other in points:
        tables = np.zeros((3, len(touching), 4))
        source = other.laws.rows
        for contact, (_, mesh) in enumerate(touching):
            for entry, place in enumerate(source.place[mesh]):
                if place >= other.first and place in ends[contact]:
                    column = ends[contact].index(place)
                    tables[:, contact, column] += [t[mesh, entry] for t in (source.normal, source.slide, source.roll)]
        rows.append(tables)
    normal, slide, roll = _tables([t[0] for t in rows], [t[1][:, :3] for t in rows], [t[2][:, 0] for t in rows])
    return meshes.GearRows(
        mesh=np.array([mesh for _, mesh in touching]),
        turning=np.array([_row(point, end[0]) for end in ends]),
        moving=np.array([_row(point, end[1]) for end in ends]),
        normal=normal,
        slide=slide,
        roll=roll,
    )


def _rollers(points: Sequence[Point]) -> rollers.RollerLaw:
    laws = [point.laws.bearings for point in points]
    kinds = [getattr(points[0].configuration.bearings, bearing_kind(name)) for name in names.BEARINGS]
    start, opposed, cos, sin = rollers.pattern(np.array([kind.rollers for kind in kinds]))
    return rollers.RollerLaw(
        first=np.array([_row(points[0], place[0]) for place in laws[0].place.tolist()]),
        start=start,
        opposed=opposed,
        cos=cos,
        sin=sin,
        radial=_lanes([law.radial for law in laws]),
        axial=_lanes([law.axial for law in laws]),
        clearance=_lanes([law.clearance for law in laws]),
        radial_force=_lanes([law.stiffness * law.radial for law in laws]),
        axial_force=_lanes([law.stiffness * law.axial for law in laws]),
        power=rollers.power_law(points[0].configuration.bearings.exponent),
    )


def _friction_table(law: FrictionLaw, speed: float) -> Array:
    """Return g and g_1 (m) of the stages over the mesh phase at a ring speed (rad/s), (3, PHASES + 1, 2)."""
    table = empty_table()
    if law.base > 0.0 or law.growth > 0.0:
        fill_table(law, speed, table)
    return np.moveaxis(table, 1, 2)
