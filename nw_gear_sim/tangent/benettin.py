"""Lyapunov exponents from deviations that are carried along a motion and made orthonormal again and again.

After every interval the deviations Y are factored, Y = Q R; Q goes on, and the logarithms of the diagonal of R, over
the time, average to the exponents in descending order (G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn,
Meccanica 15 (1980) 9-30). All of them sum up to the mean divergence of the flow.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array

BLOCKS = 16
"""Parts of a record whose means give the standard error."""
SETTLING = 0.2
"""Share of the intervals in which the deviations turn into their directions; they don't count."""
LEAST = 40
"""Fewest intervals."""
HISTORY = 200
"""Most points of the running means."""

Carry = Callable[[Array], tuple[Array, float]]
"""Carries deviations (states, count) over an interval; returns them and the mean divergence there, 1/s."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Exponents, the largest first.

    Attributes:
        rate: 1/s, (count,); error: standard errors, from the scatter between BLOCKS parts of the record, (count,).
        duration: of the record without settling, s.
        time: s since the deviations settled, (times,); history: means up to there, (times, count), 1/s.
        divergence: mean of the flow's, 1/s; it is the sum where there are as many exponents as states.
    """

    rate: Array
    error: Array
    duration: float
    time: Array
    history: Array
    divergence: float

    @property
    def dimension(self) -> float:
        """Kaplan-Yorke dimension of the attractor's section; NaN where too few exponents are known to tell."""
        return kaplan_yorke(self.rate)


def spectrum(carry: Carry, start: Array, interval: float, intervals: int) -> Spectrum:
    """Find as many exponents as there are deviations.

    Args:
        carry: over one interval.
        start: orthonormal deviations, (states, count).
        interval: s; within it the fastest decaying deviation may shrink by 1e-10 or so against the slowest.
        intervals: how many, at least LEAST; a fifth of them settles and doesn't count.

    Raises:
        InputError: too few intervals.
    """
    if intervals < LEAST:
        raise InputError("intervals of the exponents", f"at least {LEAST}", str(intervals))
    deviations, growth, spread = start, np.empty((intervals, start.shape[1])), np.empty(intervals)
    for k in range(intervals):
        carried, spread[k] = carry(deviations)
        deviations, triangle = scipy.linalg.qr(carried, mode="economic", overwrite_a=True, check_finite=False)
        with np.errstate(divide="ignore"):
            growth[k] = np.log(np.abs(np.diag(triangle))) / interval
    first = int(SETTLING * intervals)
    return summary(growth[first:], spread[first:], interval)


def summary(growth: Array, divergence: Array, interval: float) -> Spectrum:
    """Average rates of growth, (intervals, count), and divergences, (intervals,), over intervals of `interval` s."""
    intervals = len(growth)
    parts = [part.mean(axis=0) for part in np.array_split(growth, BLOCKS)]
    error = np.std(parts, axis=0, ddof=1) / np.sqrt(BLOCKS)
    seen = np.unique(np.linspace(1, intervals, min(HISTORY, intervals)).astype(int))
    means = np.cumsum(growth, axis=0)[seen - 1] / seen[:, None]
    return Spectrum(
        rate=growth.mean(axis=0),
        error=np.asarray(error),
        duration=intervals * interval,
        time=seen * interval,
        history=means,
        divergence=float(divergence.mean()),
    )


def kaplan_yorke(rates: Array) -> float:
    """Return j + (sum of the first j rates) / |rate j+1|, with the largest j whose sum isn't negative.

    Kaplan and Yorke (1979). 0 where all rates are negative; NaN where the sum of all rates isn't negative.
    """
    ordered = np.sort(rates)[::-1]
    sums = np.cumsum(ordered)
    negative = np.flatnonzero(sums < 0.0)
    if not len(negative):
        return float("nan")
    j = int(negative[0])
    return 0.0 if j == 0 else j + float(sums[j - 1]) / abs(float(ordered[j]))
