"""How fast the batch kernels are on this machine, for `nw_gear bench`."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from nw_gear_sim.batch.batch import Batch
from nw_gear_sim.batch.lanes import LANES
from nw_gear_sim.config import with_values
from nw_gear_sim.params import Configuration

REPEATS = 5


def load_sweep(configuration: Configuration, points: int) -> Sequence[Configuration]:
    """Return points from 5 % to rated load."""
    return [with_values({"operation.load": load}, configuration) for load in np.linspace(0.05, 1.0, points).tolist()]


def points_per_second(configuration: Configuration, *, ring: str, step: float, steps: int = 2000) -> float:
    """Return points times physical seconds per second of one processor; the best of REPEATS runs, on one thread.

    Args:
        configuration: of the gearbox.
        ring: `flexible` or `rigid`.
        step: of time, s; steps: of each run.
    """
    batch = Batch(load_sweep(configuration, LANES), ring=ring, step=step, threads=1)
    batch.advance(steps * step)
    costs = []
    for _ in range(REPEATS):
        before = time.process_time()
        batch.advance(steps * step)
        costs.append(time.process_time() - before)
    return LANES * steps * step / min(costs)
