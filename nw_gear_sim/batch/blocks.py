"""Memory of a block of points: state, scratch, sections, samples."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.batch.lanes import LANES
from nw_gear_sim.batch.meshes import MeshState
from nw_gear_sim.batch.stepping import Laws, Samples, State, Strobe, Work
from nw_gear_sim.batch.wheels import MOTIONS


def new_state(laws: Laws) -> State:
    """Return a block at rest with all displacements zero, at step 0."""

    def zeros(rows: int) -> Array:
        return np.zeros(rows * LANES)

    return State(
        x=zeros(MOTIONS),
        moved=zeros(MOTIONS),
        led=zeros(MOTIONS),
        z=zeros(4 * len(laws.ring.harmonic)),
        sums=zeros(3),
        mesh=MeshState(*(zeros(7) for _ in MeshState._fields)),
        psi=np.zeros(2 * len(laws.psi.start)),
        cage=np.zeros(2 * len(laws.cage.start)),
        step=np.zeros(1, dtype=np.int64),
        diverged=np.full(LANES, -1, dtype=np.int64),
    )


def copy_state(state: State) -> State:
    """Return a copy that shares no memory."""
    parts = {k: part.copy() for k, part in state._asdict().items() if k != "mesh"}
    return State(mesh=MeshState(*(part.copy() for part in state.mesh)), **parts)


def new_work() -> Work:
    """Return scratch memory for a block."""
    return Work(*(np.zeros(rows * LANES) for rows in (MOTIONS, 6, 9, 7)))


def new_strobe(first: Array, period: Array) -> Strobe:
    """Return memory for sections at first + k period (steps, (7, LANES)), no points yet; period 0 for none."""
    due = np.min(np.floor(first), initial=2.0**62, where=period > 0) + 2
    return Strobe(
        first=first,
        period=period,
        passed=np.zeros((7, LANES), dtype=np.int64),
        due=np.array([int(due)], dtype=np.int64),
        latest=np.zeros((4, 7 * LANES)),
        found=np.zeros((7, LANES), dtype=np.int64),
        x=np.zeros((0, 7, LANES)),
        v=np.zeros((0, 7, LANES)),
    )


def with_room(strobe: Strobe, steps: int) -> Strobe:
    """Return the same sections with memory for the points of the next `steps` steps, and none counted."""
    shortest = float(np.min(strobe.period, initial=np.inf, where=strobe.period > 0))
    points = int(steps / shortest) + 2 if np.isfinite(shortest) else 0
    strobe.found[:] = 0
    return strobe._replace(x=np.full((points, 7, LANES), np.nan), v=np.full((points, 7, LANES), np.nan))


def new_samples(done: int, steps: int, every: int) -> Samples:
    """Return memory for the samples of the steps `done` .. `done + steps`, one in `every` (0: none)."""
    rows = -(-(done + steps) // every) - -(-done // every) if every else 0
    return Samples(every, np.zeros((rows, 7 * LANES)), np.zeros((rows, 7 * LANES)))
