"""The time loop of a block of points, with Poincare sections and samples taken on the way."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.batch.lanes import LANES, exact
from nw_gear_sim.batch.meshes import MeshLaw, MeshState, add_gear_forces, elongate, load_meshes
from nw_gear_sim.batch.ringstep import RingLaw, share_out, step_ring
from nw_gear_sim.batch.rollers import RollerLaw, add_rollers
from nw_gear_sim.batch.wheels import WheelLaw, set_spring_forces, step_wheels
from nw_gear_sim.compiled import apart

Indices = npt.NDArray[np.int64]

REFRESH = 512
"""Steps after which phases, which are turned step by step, are computed anew."""
CHECKED = 64
"""Steps between checks for divergence."""


class Phases(NamedTuple):
    """Phases that turn evenly: value at step 0 and advance in a step (rad), flat (rows, lanes).

    Attributes:
        turn: cosine and sine of the advance, flat (2, rows, lanes).
    """

    start: Array
    advance: Array
    turn: Array


class Laws(NamedTuple):
    """All constants of a block; psi: phases of the meshes, cage: of the bearings' cages."""

    wheels: WheelLaw
    ring: RingLaw
    mesh: MeshLaw
    rollers: RollerLaw
    psi: Phases
    cage: Phases


class State(NamedTuple):
    """Where a block is; flat arrays with points in the last axis.

    Attributes:
        x, moved, led: displacements of gears and bearings (m), those of the last step, and see `wheels.step_wheels`.
        z, sums: of the ring, see `ringstep.step_ring`.
        mesh: of the meshes.
        psi, cage: cosine and sine of the phases, (2, rows, lanes).
        step: steps done, (1,); diverged: step at which a point was seen to diverge, -1 where it didn't, (lanes,).
    """

    x: Array
    moved: Array
    led: Array
    z: Array
    sums: Array
    mesh: MeshState
    psi: Array
    cage: Array
    step: Indices
    diverged: Indices


class Work(NamedTuple):
    """Scratch, flat: force (motions, lanes), rollers (6, lanes), shares (9, lanes), y (7, lanes)."""

    force: Array
    rollers: Array
    shares: Array
    y: Array


class Strobe(NamedTuple):
    """Poincare sections: x and its rate where a phase passes 0, by a cubic through the four steps around it.

    Attributes:
        first, period: of the passages, in steps, (7, lanes), period 0 for none.
        passed: number of passages so far, (7, lanes).
        due: step at which the next passage of any point can be interpolated, (1,).
        latest: elongations of the last four steps, (4, 7 lanes).
        found: points since the call began, (7, lanes); x, v: m and m/s, (points, 7, lanes).
    """

    first: Array
    period: Array
    passed: Indices
    due: Indices
    latest: Array
    found: Indices
    x: Array
    v: Array


class Samples(NamedTuple):
    """Waveform: one row for each `every` steps (none where it is 0), x (m) and force (N), (rows, 7 lanes)."""

    every: int
    x: Array
    force: Array


@apart
def advance(
    laws: Laws, state: State, work: Work, strobe: Strobe, samples: Samples, steps: int, step: float, limit: float
) -> None:
    """Take steps.

    Args:
        laws, state, work: of the block; the state is changed in place.
        strobe, samples: filled on the way.
        steps: how many; step: of time, s.
        limit: displacement (m) beyond which a point counts as diverged.
    """
    begun, mesh = state.step[0], state.mesh
    for now in range(begun, begun + steps):
        if now % REFRESH == 0:
            set_phases(laws.psi, now, state.psi)
            set_phases(laws.cage, now, state.cage)
        load_meshes(laws.mesh, float(now), state.psi, mesh)
        copy(mesh.x, strobe.latest[now & 3])
        if now >= strobe.due[0]:
            _cut(strobe, now, 1.0 / step)
        if samples.every > 0 and now % samples.every == 0:
            row = now // samples.every - (begun + samples.every - 1) // samples.every
            copy(mesh.x, samples.x[row])
            copy(mesh.force, samples.force[row])
        move(laws, state, work)
        if (now + 1) % CHECKED == 0:
            check(state, now + 1, limit)
    state.step[0] = begun + steps


@apart
def move(laws: Laws, state: State, work: Work) -> None:
    """Take one step with the mesh forces that have been set."""
    mesh = state.mesh
    set_spring_forces(laws.wheels, state.led, work.force)
    add_gear_forces(laws.mesh.gears, mesh.force, mesh.sliding, mesh.rolling, work.force)
    add_rollers(laws.rollers, state.cage, state.x, work.rollers, work.force)
    share_out(mesh.force, mesh.sliding, mesh.rolling, work.shares)
    step_wheels(laws.wheels, work.force, state.x, state.moved, state.led)
    step_ring(laws.ring, work.shares, state.z, state.sums)
    elongate(laws.mesh, state.x, state.sums, work.y, mesh.force)
    for i in range(7 * LANES):
        mesh.before[i] = mesh.moved[i]
        mesh.moved[i] = work.y[i] - mesh.y[i]
        mesh.y[i] = work.y[i]
    turn(laws.psi.turn, state.psi)
    turn(laws.cage.turn, state.cage)


@apart
def turn(by: Array, unit: Array) -> None:
    """Turn unit vectors by others, flat (2, rows, lanes)."""
    half = len(unit) // 2
    for i in range(half):
        cos, sin = unit[i], unit[half + i]
        unit[i] = exact(cos, by[i]) - sin * by[half + i]
        unit[half + i] = exact(sin, by[i]) + cos * by[half + i]


@apart
def copy(source: Array, target: Array) -> None:
    """Copy a flat array."""
    for i in range(len(source)):
        target[i] = source[i]


@apart
def set_phases(phases: Phases, step: int, unit: Array) -> None:
    """Set cosine and sine of phases at a step, flat (2, rows, lanes)."""
    half = len(phases.start)
    for i in range(half):
        angle = phases.start[i] + exact(phases.advance[i], step)
        unit[i], unit[half + i] = math.cos(angle), math.sin(angle)


@apart
def check(state: State, step: int, limit: float) -> None:
    """Note points whose displacements left +-limit or aren't numbers."""
    for lane in range(LANES):
        if state.diverged[lane] < 0:
            for i in range(lane, len(state.x), LANES):
                if not abs(state.x[i]) <= limit:
                    state.diverged[lane] = step
                    break


@apart
def _cut(strobe: Strobe, now: int, rate: float) -> None:
    due = np.int64(2**62)
    for mesh in range(7):
        for lane in range(LANES):
            while strobe.period[mesh, lane] > 0.0:
                place = strobe.first[mesh, lane] + strobe.period[mesh, lane] * strobe.passed[mesh, lane]
                below = int(place)
                if below + 2 > now:
                    due = min(due, np.int64(below + 2))
                    break
                _interpolate(strobe, mesh, lane, below, place - below, rate)
                strobe.passed[mesh, lane] += 1
                strobe.found[mesh, lane] += 1
    strobe.due[0] = due


@apart
def _interpolate(strobe: Strobe, mesh: int, lane: int, below: int, s: float, rate: float) -> None:
    at = mesh * LANES + lane
    a = strobe.latest[(below - 1) & 3, at]
    b = strobe.latest[below & 3, at]
    c = strobe.latest[(below + 1) & 3, at]
    d = strobe.latest[(below + 2) & 3, at]
    first = c - a / 3.0 - b / 2.0 - d / 6.0
    second = 0.5 * (a + c) - b
    third = (d - a) / 6.0 + (b - c) / 2.0
    row = strobe.found[mesh, lane]
    strobe.x[row, mesh, lane] = b + s * (first + s * (second + s * third))
    strobe.v[row, mesh, lane] = rate * (first + s * (2.0 * second + 3.0 * s * third))
