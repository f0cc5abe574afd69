"""Permutation entropy (Bandt and Pompe, Physical Review Letters 88 (2002) 174102)."""

from __future__ import annotations

from math import factorial, log2

import numba
import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked

MOST = 8
"""Largest order: there are order! patterns."""


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _counts(x: Array, order: int, lag: int, patterns: int) -> Array:
    """How often each pattern occurs; patterns are numbered by how many later values are smaller, in factorial base."""
    size = x.size - (order - 1) * lag
    ranks = np.zeros(size, dtype=np.int32)
    for first in range(order - 1):
        a = x[first * lag : first * lag + size]
        for later in range(first + 1, order):
            b = x[later * lag : later * lag + size]
            for i in range(size):
                ranks[i] += b[i] < a[i]
        if first < order - 2:
            for i in range(size):
                ranks[i] *= order - 1 - first
    counts = np.zeros(patterns)
    for rank in ranks:
        counts[rank] += 1.0
    return counts


def permutation_entropy(x: Array, order: int = 3, lag: int = 1, *, normalised: bool = False) -> float:
    """Entropy of the order in which neighbouring values stand.

    H = -sum p log2 p over the order! patterns of (x(i), .., x(i + (order - 1) lag)); of equal values the earlier counts
    as the smaller one. log2(order!) for white noise, 0 for a signal that always rises; 2.149 bits at order 3 for the
    logistic map at r = 4, which never falls twice. It sees noise of any size in a flat part of the signal.

    Args:
        x: (samples,) any unit; some hundred times order! of them are wanted.
        order: values of a pattern, 2 to 8.
        lag: samples between them.
        normalised: divide by log2(order!).

    Returns:
        Bits, or a share from 0 to 1 where normalised.

    Raises:
        InputError: a value that isn't finite, a constant, too few samples for a pattern, a setting that isn't possible.
    """
    order, lag = checked.whole("order", order, 2), checked.whole("lag", lag, 1)
    if order > MOST:
        raise InputError("order", f"a whole number, 2 to {MOST}", str(order))
    values = checked.signal("x", x, (order - 1) * lag + 1)
    patterns = factorial(order)
    counts = _counts(values, order, lag, patterns)
    share = counts[counts > 0.0] / counts.sum()
    entropy = max(-float(share @ np.log2(share)), 0.0)
    return entropy / log2(patterns) if normalised else entropy
