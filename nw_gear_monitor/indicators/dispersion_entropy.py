"""Dispersion entropy (Rostaghi and Azami, IEEE Signal Processing Letters 23 (2016) 610-614)."""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked

MOST = 10_000_000
"""Largest number of patterns that are counted."""


def dispersion_entropy(
    x: Array, classes: int = 6, dimension: int = 2, lag: int = 1, *, normalised: bool = False
) -> float:
    """Entropy of the sequence of classes that a signal passes through.

    Each value gets the class round(c Phi((x - mean x) / sd x) + 1/2), Phi the normal distribution; H = -sum p ln p over
    the c^m patterns of m classes, `lag` apart. m ln c for white normal noise. Unlike permutation entropy it sees
    amplitudes, so that noise far below the signal hardly counts. sd is that of the samples (divided by n).

    Args:
        x: (samples,) any unit; some times c^m of them are wanted.
        classes: c, 2 or more.
        dimension: m, 1 or more.
        lag: samples between the values of a pattern.
        normalised: divide by m ln c.

    Returns:
        Nats, or a share from 0 to 1 where normalised.

    Raises:
        InputError: a value that isn't finite, a constant, too few samples for a pattern, a setting that isn't possible.
    """
    classes, dimension = checked.whole("classes", classes, 2), checked.whole("dimension", dimension, 1)
    if dimension * np.log(classes) > np.log(MOST):
        raise InputError("classes", f"at most {MOST} patterns", f"{classes}^{dimension}")
    span = (dimension - 1) * checked.whole("lag", lag, 1)
    values = checked.signal("x", x, max(span + 1, 2))
    values = values / float(np.max(np.abs(values)))
    share = ndtr((values - values.mean()) / float(np.std(values)))
    number = np.clip(np.ceil(classes * share), 1, classes).astype(np.int64) - 1  # round(c p + 1/2), halves down
    size = number.size - span
    patterns = np.zeros(size, dtype=np.int64)
    for k in range(dimension):
        patterns = patterns * classes + number[k * lag : k * lag + size]
    counts = np.bincount(patterns)
    p = counts[counts > 0] / size
    entropy = max(-float(p @ np.log(p)), 0.0)
    return entropy / (dimension * float(np.log(classes))) if normalised else entropy
