"""The time loop of a block of points, with Poincare sections and samples taken on the way."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.batch.meshes import MeshLaw, MeshState, add_gear_forces, elongate, load_meshes
from nw_gear_sim.batch.ringstep import RingLaw, share_out, step_ring
from nw_gear_sim.batch.rollers import RollerLaw, add_rollers, turn
from nw_gear_sim.batch.wheels import WheelLaw, set_spring_forces, step_wheels
from nw_gear_sim.compiled import fused

Indices = npt.NDArray[np.int64]

REFRESH = 512
"""Steps after which phases, which are turned step by step, are computed anew."""
CHECKED = 64
"""Steps between checks for divergence."""


class Laws(NamedTuple):
    """All constants of a block; psi and cage: phase at step 0 and its advance in a step, rad, (2, rows, lanes)."""

    wheels: WheelLaw
    ring: RingLaw
    mesh: MeshLaw
    rollers: RollerLaw
    psi: Array
    cage: Array


class State(NamedTuple):
    """Where a block is; arrays with points in the last axis.

    Attributes:
        x, moved, before: displacements of gears and bearings (m), in the last step and the one before.
        z, turned: modal coordinates of the ring and their last displacement, see `ringstep`.
        sums: of `ringstep.step_ring`; mesh: of the meshes; cos, sin: of the cages' angles.
        step: steps done, (1,); diverged: step at which a point was seen to diverge, -1 where it didn't, (lanes,).
    """

    x: Array
    moved: Array
    before: Array
    z: Array
    turned: Array
    sums: Array
    mesh: MeshState
    cos: Array
    sin: Array
    step: Indices
    diverged: Indices


class Work(NamedTuple):
    """Scratch: force (motions, lanes), rollers (6, lanes), shares (9, lanes), y (7, lanes)."""

    force: Array
    rollers: Array
    shares: Array
    y: Array


class Strobe(NamedTuple):
    """Poincare sections: x and its rate where a phase passes 0, by a cubic through the four steps around it.

    Attributes:
        first, period: of the passages, in steps, (7, lanes); passed: number of passages so far, (7, lanes).
        due: step at which the next passage of any point can be interpolated, (1,).
        latest: elongations of the last four steps, (4, 7, lanes).
        count: points since the call began, (7, lanes); x, v: m and m/s, (points, 7, lanes).
    """

    first: Array
    period: Array
    passed: Indices
    due: Indices
    latest: Array
    count: Indices
    x: Array
    v: Array


class Samples(NamedTuple):
    """Waveform: one row for each `every` steps (none where it is 0), x (m) and force (N), (rows, 7, lanes)."""

    every: int
    x: Array
    force: Array


@fused
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
    begun = state.step[0]
    mesh, size = state.mesh, state.mesh.y.size
    y, moved, before, found = mesh.y.reshape(size), mesh.moved.reshape(size), mesh.before.reshape(size), work.y.reshape(size)
    for now in range(begun, begun + steps):
        if now % REFRESH == 0:
            set_phases(laws.psi, now, mesh.cos, mesh.sin)
            set_phases(laws.cage, now, state.cos, state.sin)
        load_meshes(laws.mesh, float(now), mesh)
        _copy(mesh.x, strobe.latest[now & 3])
        if now >= strobe.due[0]:
            _cut(strobe, now, 1.0 / step)
        if samples.every > 0 and now % samples.every == 0:
            row = now // samples.every - (begun + samples.every - 1) // samples.every
            _copy(mesh.x, samples.x[row])
            _copy(mesh.force, samples.force[row])
        set_spring_forces(laws.wheels, state.x, state.moved, state.before, work.force)
        add_gear_forces(laws.mesh, mesh, work.force)
        add_rollers(laws.rollers, state.cos, state.sin, state.x, work.rollers, work.force)
        share_out(mesh.force, mesh.sliding, mesh.rolling, work.shares)
        step_wheels(laws.wheels, work.force, state.x, state.moved, state.before)
        step_ring(laws.ring, work.shares, state.z, state.turned, state.sums)
        elongate(laws.mesh, state.x, state.sums, work.y, mesh)
        for i in range(size):
            before[i] = moved[i]
            moved[i] = found[i] - y[i]
            y[i] = found[i]
        turn(mesh.cos, mesh.sin, laws.mesh.turn_cos, laws.mesh.turn_sin)
        turn(state.cos, state.sin, laws.rollers.turn_cos, laws.rollers.turn_sin)
        if (now + 1) % CHECKED == 0:
            check(state, now + 1, limit)
    state.step[0] = begun + steps


@fused
def _copy(source: Array, target: Array) -> None:
    for i in range(source.shape[0]):
        for lane in range(source.shape[1]):
            target[i, lane] = source[i, lane]


@fused
def set_phases(phase: Array, step: int, cos: Array, sin: Array) -> None:
    """Set cosine and sine of phases at a step."""
    for i in range(cos.shape[0]):
        for lane in range(cos.shape[1]):
            angle = phase[0, i, lane] + phase[1, i, lane] * step
            cos[i, lane], sin[i, lane] = math.cos(angle), math.sin(angle)


@fused
def check(state: State, step: int, limit: float) -> None:
    """Note points whose displacements left +-limit or aren't numbers."""
    for lane in range(state.x.shape[1]):
        if state.diverged[lane] >= 0:
            continue
        for i in range(len(state.x)):
            if not abs(state.x[i, lane]) <= limit:
                state.diverged[lane] = step
                break


@fused
def _cut(strobe: Strobe, now: int, rate: float) -> None:
    due = np.int64(2**62)
    for mesh in range(7):
        for lane in range(strobe.first.shape[1]):
            while True:
                place = strobe.first[mesh, lane] + strobe.period[mesh, lane] * strobe.passed[mesh, lane]
                if not place < 1e18:
                    break
                below = int(place)
                if below + 2 > now:
                    due = min(due, below + 2)
                    break
                _interpolate(strobe, mesh, lane, below, place - below, rate)
                strobe.passed[mesh, lane] += 1
                strobe.count[mesh, lane] += 1
    strobe.due[0] = due


@fused
def _interpolate(strobe: Strobe, mesh: int, lane: int, below: int, s: float, rate: float) -> None:
    a = strobe.latest[(below - 1) & 3, mesh, lane]
    b = strobe.latest[below & 3, mesh, lane]
    c = strobe.latest[(below + 1) & 3, mesh, lane]
    d = strobe.latest[(below + 2) & 3, mesh, lane]
    first = c - a / 3.0 - b / 2.0 - d / 6.0
    second = 0.5 * (a + c) - b
    third = (d - a) / 6.0 + (b - c) / 2.0
    row = strobe.count[mesh, lane]
    strobe.x[row, mesh, lane] = b + s * (first + s * (second + s * third))
    strobe.v[row, mesh, lane] = rate * (first + s * (2.0 * second + 3.0 * s * third))
