"""Whole mesh cycles on equal steps of mesh phase, from displacement and velocity.

With the velocity known, Hermite interpolation (`hermite`) takes the place of the spline of `resample`: it needs four
samples around a point and no system of equations, and is exact to 1e-6 of a line of five samples a cycle.
"""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.signals.hermite import crossings, values

CYCLE = 2.0 * np.pi
LEAST_POINTS = 16
"""Points in a cycle, at least: eight harmonics."""


def points_per_cycle(phase: Array) -> int:
    """The power of two, at least LEAST_POINTS, that is no coarser than the samples where the mesh is slowest.

    Args:
        phase: (samples,) unwrapped mesh phase, rad, increasing.
    """
    slowest = float(np.min(np.diff(phase)))
    return int(2 ** np.ceil(np.log2(max(CYCLE / slowest, float(LEAST_POINTS)))))


def whole_cycles(phase: Array, x: Array, v: Array, step: float) -> Array:
    """Resample the whole mesh cycles of a record.

    Cycles begin at whole multiples of 2 pi of the phase; the newest ones are kept where a remainder is left.

    Args:
        phase: (samples,) unwrapped mesh phase, rad, increasing.
        x, v: (samples, channels) displacement and its derivative in time, any unit and that unit per second.
        step: sample interval, s.

    Returns:
        (channels, cycles, points per cycle), the unit of x; no cycles where the record holds none.
    """
    per_cycle = points_per_cycle(phase)
    first = int(np.ceil(phase[0] / CYCLE))
    last = int(np.floor(phase[-1] / CYCLE))
    cycles = max(last - first, 0)
    targets = CYCLE * (first + np.arange(cycles * per_cycle) / per_cycle)
    value = values(crossings(phase, targets), x, v, step)
    resampled: Array = np.ascontiguousarray(value.T).reshape(x.shape[1], cycles, per_cycle)
    return resampled


def mean_turn(cycles: Array, teeth: int) -> tuple[Array, int]:
    """Time-synchronous average of a gear, from the cycles of its mesh (see `average.synchronous_average`).

    Args:
        cycles: (cycles, points per cycle) of one mesh.
        teeth: of the gear: as many cycles make one turn.

    Returns:
        (teeth * points per cycle,) without its mean, and the turns averaged, the newest whole ones; an empty array for
        none.
    """
    turns = len(cycles) // teeth
    if turns == 0:
        return np.empty(0), 0
    kept = cycles[len(cycles) - turns * teeth :]
    mean = kept.reshape(turns, teeth * cycles.shape[1]).mean(axis=0)
    return mean - mean.mean(), turns
