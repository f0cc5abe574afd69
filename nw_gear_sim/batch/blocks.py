"""Memory of a block of points: state, scratch, sections, samples."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.batch.meshes import MeshState
from nw_gear_sim.batch.stepping import Laws, Samples, State, Strobe, Work


def new_state(laws: Laws) -> State:
    """Return a block at rest with all displacements zero, at step 0."""
    motions, lanes = laws.wheels.load.shape
    pairs, bearings = len(laws.ring.square), len(laws.rollers.radial)

    def zeros(*shape: int) -> Array:
        return np.zeros((*shape, lanes))

    return State(
        x=zeros(motions),
        moved=zeros(motions),
        before=zeros(motions),
        z=zeros(pairs, 2),
        turned=zeros(pairs, 2),
        sums=zeros(3),
        mesh=MeshState(*(zeros(7) for _ in MeshState._fields)),
        cos=zeros(bearings),
        sin=zeros(bearings),
        step=np.zeros(1, dtype=np.int64),
        diverged=np.full(lanes, -1, dtype=np.int64),
    )


def copy_state(state: State) -> State:
    """Return a copy that shares no memory."""
    parts = [MeshState(*(a.copy() for a in part)) if isinstance(part, MeshState) else part.copy() for part in state]
    return State(*parts)


def new_work(laws: Laws) -> Work:
    """Return scratch memory for a block."""
    motions, lanes = laws.wheels.load.shape
    return Work(np.zeros((motions, lanes)), np.zeros((6, lanes)), np.zeros((9, lanes)), np.zeros((7, lanes)))


def new_strobe(first: Array, period: Array) -> Strobe:
    """Return memory for sections at first + k period (steps, (7, lanes)), no points yet; period inf for none."""
    lanes = first.shape[1]
    due = np.floor(np.min(first)) + 2 if np.isfinite(first).any() else 2.0**62
    return Strobe(
        first=first,
        period=np.where(np.isfinite(first), period, 0.0),
        passed=np.zeros((7, lanes), dtype=np.int64),
        due=np.array([int(due)], dtype=np.int64),
        latest=np.zeros((4, 7, lanes)),
        count=np.zeros((7, lanes), dtype=np.int64),
        x=np.zeros((0, 7, lanes)),
        v=np.zeros((0, 7, lanes)),
    )


def with_room(strobe: Strobe, steps: int) -> Strobe:
    """Return the same sections with memory for the points of the next `steps` steps, and none counted."""
    shortest = float(np.min(strobe.period, initial=np.inf, where=strobe.period > 0))
    points = int(steps / shortest) + 2 if np.isfinite(shortest) else 0
    room = (points, *strobe.first.shape)
    strobe.count[:] = 0
    return strobe._replace(x=np.full(room, np.nan), v=np.full(room, np.nan))


def new_samples(lanes: int, done: int, steps: int, every: int) -> Samples:
    """Return memory for the samples of the steps `done` .. `done + steps`, one in `every` (0: none)."""
    rows = -(-(done + steps) // every) - -(-done // every) if every else 0
    return Samples(every, np.zeros((rows, 7, lanes)), np.zeros((rows, 7, lanes)))
