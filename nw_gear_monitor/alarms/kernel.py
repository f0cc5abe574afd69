"""What happens to every feature in a window: judged against its bin, then learned. Compiled; live and studies share it.

Statistics of one bin are rows of an array (ROWS, features), the state of the alarms rows of another. The arithmetic:

- y = ln(x + offset); mean and sum of squared deviations by Welford's recursion over all windows, overlapping or not.
- Where y is skewed to the right the standard deviation understates what lies above the mean. s is the larger one of it
  and of the root mean square of the deviations upwards, each taken from the mean as it was known then.
- Windows that overlap say the same thing several times. A window counts as independent where the last one that
  counted lies at least its own length back; n of these stand for the bin. The mean is uncertain by s/sqrt(n) and the
  spread of correlated values comes out too small by (n - 1)/n: s^2 (n + 1)/(n - 1) is the variance of a new value about
  the learned mean. Their ratio has Student's distribution with n - 1 degrees of freedom: in the place of k stands its
  quantile of the same probability (3.3 for 3 and 8.5 for 6 at n = 30, 3.03 and 6.2 at n = 300).
- limit = exp(mean + k s) - offset, s at least LEAST_SPREAD.
- Windows are judged their own length apart, 8 s at most: three of five that are all but the same would be one.
- A fault must not become the standard in the windows before it is found. Once a bin judges, a value over the limit of
  WARN is learned as that limit (Winsor's way) where none of the four windows before was over it, else not at all; nor
  is one over the limit of ERROR, nor any while the alarm lasts.
- A latch is set where 3 (WARN) or 4 (ERROR) of the last 5 judged windows were over its limit, and released after 5 in a
  row under 0.9 of it. Both latches give the level: ERROR, else WARN, else OK.
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
WARN_LATCH, ERROR_LATCH, JUDGED = 2, 5, 6
COUNTED = [0, 1, 3, 4]
STATES = 7
"""Rows of the state: bits, windows under 0.9 and latch of WARN; the same of ERROR; hop of the last judgement."""
WINDOWS, WARN_NEEDED, ERROR_NEEDED = 5, 3, 4
MOST_APART = 8.0
CLEARED = 0.9
ALL_BITS = (1 << WINDOWS) - 1
RECENT_BITS = ALL_BITS >> 1

Whole = npt.NDArray[np.int64]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def student(z: float, freedom: float) -> float:
    """Quantile of Student's distribution whose probability is that of z in the normal one.

    Fisher and Cornish's expansion to the third power of 1/freedom (Abramowitz and Stegun 26.7.5); within 2 % for z up
    to 6 and a freedom of 19 or more.
    """
    first = (z**3 + z) / 4.0
    second = (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / 96.0
    third = (3.0 * z**7 + 19.0 * z**5 + 17.0 * z**3 - 15.0 * z) / 384.0
    return z + first / freedom + second / freedom**2 + third / freedom**3


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
    spread = max(student(deviations, n - 1.0) * math.sqrt(variance), deviations * LEAST_SPREAD)
    return math.exp(statistics[MEAN, feature] + spread) - offset


@numba.njit(cache=True, nogil=True, error_model="numpy")
def latch(bits: int, under: int, is_set: bool, x: float, bound: float, needed: int) -> tuple[int, int, bool]:
    """One judged window: bits of the last five (over the limit), windows in a row under 0.9 of it, the latch.

    `needed` of the last five set it.
    """
    bits = ((bits << 1) | (1 if x > bound else 0)) & ALL_BITS
    under = min(under + 1, WINDOWS) if x < CLEARED * bound else 0
    over = 0
    for k in range(WINDOWS):
        over += (bits >> k) & 1
    if over >= needed:
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
def judge(states: Whole, feature: int, x: float, warn: float, error: float) -> None:
    """Take one window into the latches of a feature."""
    for k in range(2):
        bits, under, is_set = latch(
            states[3 * k, feature],
            states[3 * k + 1, feature],
            states[3 * k + 2, feature] != 0,
            x,
            warn if k == 0 else error,
            WARN_NEEDED if k == 0 else ERROR_NEEDED,
        )
        states[3 * k, feature], states[3 * k + 1, feature] = bits, under
        states[3 * k + 2, feature] = 1 if is_set else 0


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
        spacing: length of the window in hops.
        tick: number of the hop.
        statistics: (STATISTICS, features) of the bin.
        states: (STATES, features).
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
            if tick - states[JUDGED, feature] >= min(spacing, MOST_APART):
                states[JUDGED, feature] = int(tick)
                judge(states, feature, x, warn, error)
            fit &= states[WARN_LATCH, feature] == 0
        if learning and fit and statistics[INDEPENDENT, feature] < windows[1]:
            learn(statistics, feature, y, tick, spacing)


def levels(states: Whole) -> Whole:
    """Level of every feature: 2 (ERROR), 1 (WARN) or 0, from its latches."""
    return np.where(states[ERROR_LATCH] != 0, 2, np.where(states[WARN_LATCH] != 0, 1, 0))
