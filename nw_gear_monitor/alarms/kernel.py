"""What happens to every feature in a window: judged against its bin, then learned. Compiled; live and studies share it.

Statistics of one bin are rows of an array (ROWS, features), the state of the alarms rows of another. The arithmetic:

- y = ln(x + offset); mean and sum of squared deviations by Welford's recursion over all windows, overlapping or not.
- Where y is skewed to the right the standard deviation understates what lies above the mean. s is the larger one of it
  and of the root mean square of the deviations upwards, each taken from the mean as it was known then.
- Windows that overlap say the same thing several times. A window counts as independent where the last one that
  counted lies at least its own length back; n of these stand for the bin. The mean is uncertain by s/sqrt(n) and the
  spread of correlated values comes out too small by (n - 1)/n: s^2 (n + 1)/(n - 1) is the variance of a new value about
  the learned mean.
- limit = exp(mean + k s) - offset, s at least LEAST_SPREAD.
- A fault must not become the standard in the windows before it is found. Once a bin judges, a value over the limit of
  WARN is learned as that limit (Winsor's way) where none of the four windows before was over it, else not at all; nor
  is one over the limit of ERROR, nor any while the alarm lasts.
- A latch is set where 3 of the last 5 judged windows were over its limit, released after 5 in a row under 0.9 of it.
  Both latches give the level: ERROR, else WARN, else OK.
"""

from __future__ import annotations

import math

import numba
import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_monitor.alarms.settings import LEAST_SPREAD

COUNT, INDEPENDENT, LAST, MEAN, M2, ABOVE, M2_ABOVE = range(7)
STATISTICS = 7
"""Rows of a bin's statistics: windows; independent ones; hop of the last of these; mean and sum of squared deviations;
windows above the mean and their sum of squared deviations."""
WINDOWS, NEEDED = 5, 3
CLEARED = 0.9
ALL_BITS = (1 << WINDOWS) - 1
RECENT_BITS = ALL_BITS >> 1

Whole = npt.NDArray[np.int64]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def limit(statistics: Array, feature: int, offset: float, deviations: float) -> float:
    """Limit of a feature in its own unit; nan before two independent windows."""
    n = statistics[INDEPENDENT, feature]
    if n < 2:
        return math.nan
    variance = statistics[M2, feature] / statistics[COUNT, feature]
    if statistics[ABOVE, feature] > 0:
        variance = max(variance, statistics[M2_ABOVE, feature] / statistics[ABOVE, feature])
    variance *= (n + 1.0) / (n - 1.0)
    return math.exp(statistics[MEAN, feature] + deviations * max(math.sqrt(variance), LEAST_SPREAD)) - offset


@numba.njit(cache=True, nogil=True, error_model="numpy")
def latch(bits: int, under: int, is_set: bool, x: float, bound: float) -> tuple[int, int, bool]:
    """One judged window: bits of the last five (over the limit), windows in a row under 0.9 of it, the latch."""
    bits = ((bits << 1) | (1 if x > bound else 0)) & ALL_BITS
    under = min(under + 1, WINDOWS) if x < CLEARED * bound else 0
    over = 0
    for k in range(WINDOWS):
        over += (bits >> k) & 1
    if over >= NEEDED:
        return bits, under, True
    return bits, under, is_set and under < WINDOWS


@numba.njit(cache=True, nogil=True, error_model="numpy")
def learn(statistics: Array, feature: int, y: float, tick: float, spacing: float) -> None:
    """Take one window into the statistics."""
    statistics[COUNT, feature] += 1.0
    if not tick - statistics[LAST, feature] < spacing:  # nan before the first
        statistics[INDEPENDENT, feature] += 1.0
        statistics[LAST, feature] = tick
    before = y - statistics[MEAN, feature]
    if before > 0.0 and statistics[COUNT, feature] > 1.0:
        statistics[ABOVE, feature] += 1.0
        statistics[M2_ABOVE, feature] += before * before
    statistics[MEAN, feature] += before / statistics[COUNT, feature]
    statistics[M2, feature] += before * (y - statistics[MEAN, feature])


@numba.njit(cache=True, nogil=True, error_model="numpy")
def judge(states: Whole, feature: int, x: float, warn: float, error: float) -> bool:
    """Take one window into the latches of a feature; whether one of them is set."""
    alarmed = False
    for k in range(2):
        bits, under, is_set = latch(
            states[3 * k, feature],
            states[3 * k + 1, feature],
            states[3 * k + 2, feature] != 0,
            x,
            warn if k == 0 else error,
        )
        states[3 * k, feature], states[3 * k + 1, feature] = bits, under
        states[3 * k + 2, feature] = 1 if is_set else 0
        alarmed |= is_set
    return alarmed


@numba.njit(cache=True, nogil=True, error_model="numpy")
def window(
    which: Whole,
    values: Array,
    offsets: Array,
    spacing: float,
    tick: float,
    statistics: Array,
    states: Whole,
    deviations: tuple[float, float],
    windows: tuple[float, float],
    learning: bool,
) -> None:
    """Judge and learn one window of features that share a bin.

    Args:
        which: (n,) columns of the features in `statistics` and `states`.
        values, offsets: (n,) values, in the features' units, and offsets; values + offsets > 0.
        spacing: hops after which a window is independent of the one before.
        tick: number of the hop.
        statistics: (STATISTICS, features) of the bin.
        states: (6, features): bits, windows under 0.9, latch of WARN; the same of ERROR.
        deviations: of WARN and ERROR.
        windows: independent windows needed to judge, and after which learning ends.
        learning: whether anything is learned at all.
    """
    for i in range(which.size):
        feature, x, offset = which[i], values[i], offsets[i]
        fit, y = True, math.log(x + offset)
        if statistics[INDEPENDENT, feature] >= windows[0]:
            warn = limit(statistics, feature, offset, deviations[0])
            error = limit(statistics, feature, offset, deviations[1])
            fit = x <= warn or (x <= error and states[0, feature] & RECENT_BITS == 0)
            y = math.log(min(x, warn) + offset)
            fit &= not judge(states, feature, x, warn, error)
        if learning and fit and statistics[INDEPENDENT, feature] < windows[1]:
            learn(statistics, feature, y, tick, spacing)


def levels(states: Whole) -> Whole:
    """Level of every feature: 2 (ERROR), 1 (WARN) or 0, from its latches."""
    return np.where(states[5] != 0, 2, np.where(states[2] != 0, 1, 0))
