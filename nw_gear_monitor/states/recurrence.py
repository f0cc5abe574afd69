"""Recurrence period: the smallest n whose mean cycles predict unseen cycles as well as any other n does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array

Whole = npt.NDArray[np.int64]
LONGEST = 16
LOOKED_AT = 33
"""Periods below this are tried, so that a motion of period 20 isn't taken for one of period 1 with noise."""
BLOCK = 8
BLOCKS = 24
SIGNIFICANT = 3.5
LEAST_SPLITTING = 4e-3
"""Splittings of an orbit below this share of the signal's standard deviation are no period."""


@dataclass(frozen=True, eq=False)
class Recurrence:
    """Outcome of the search.

    Attributes:
        period: the smallest period that does, up to LOOKED_AT - 1.
        residual: (cycles, points) what the mean cycles of this period leave, corrected for the means fitted.
        gain: how many standard errors this period is better than its best divisor (0 for period 1).
    """

    period: int
    residual: Array
    gain: float


def recurrence(rows: Array) -> Recurrence:
    """Find the recurrence period of cycles.

    For every n the cycles are predicted by the means of the groups k mod n, taken from other parts of the record
    (every second block of cycles), so that neither noise nor chaos looks periodic: their means predict nothing.

    Args:
        rows: (cycles, points).
    """
    periods = [n for n in range(1, LOOKED_AT) if 6 * n <= rows.shape[0]]
    errors = np.array([_unseen(rows, n) for n in periods])
    best = int(np.argmin(errors.mean(axis=1)))
    for index, n in enumerate(periods):
        if n == periods[best] or _as_good(errors[index], errors[best]):
            break
    chosen, place = n, index
    divisors = [i for i, n in enumerate(periods) if n < chosen and chosen % n == 0]
    gain = min((_gain(errors[i], errors[place]) for i in divisors), default=0.0)
    return Recurrence(chosen, residual(rows, chosen), gain)


def residual(rows: Array, n: int) -> Array:
    """What the means of the groups k mod n leave, times sqrt(N / (N - n))."""
    size = rows.shape[0]
    group: Whole = np.arange(size) % n
    left: Array = rows - _means(rows, group, n)[group]
    return np.asarray(left * np.sqrt(size / max(size - n, 1)))


def _means(rows: Array, group: Whole, n: int) -> Array:
    out = np.empty((n, rows.shape[1]))
    for g in range(n):
        out[g] = rows[group == g].mean(axis=0)
    return out


def _unseen(rows: Array, n: int) -> Array:
    """Mean square error of each cycle, predicted by group means of the blocks of the other parity."""
    size = rows.shape[0]
    k: Whole = np.arange(size)
    width = min(max(BLOCK, 2 * n), size // 3)
    parity = (k // width) % 2
    error = np.empty(size)
    for p in (0, 1):
        seen, other = parity != p, parity == p
        means = _means(rows[seen], k[seen] % n, n)
        error[other] = np.mean((rows[other] - means[k[other] % n]) ** 2, axis=1)
    return error


def _gain(worse: Array, better: Array) -> float:
    parts: Array = np.array([part.mean() for part in np.array_split(worse - better, BLOCKS)])
    spread = float(np.std(parts, ddof=1)) / np.sqrt(BLOCKS)
    if spread > 0.0:
        return float(parts.mean() / spread)
    return float("inf") if parts.mean() > 0.0 else 0.0


def _as_good(error: Array, best: Array) -> bool:
    excess = float(np.mean(error - best))
    return excess <= LEAST_SPLITTING**2 or _gain(error, best) < SIGNIFICANT
