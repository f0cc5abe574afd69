"""NA4: kurtosis of the residual against the variance that this machine has had so far."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked


def na4(residual: Array, earlier: Sequence[float] = (), floor: float = 0.0) -> float:
    """Fourth moment of the residual over the square of the mean variance of all records until now.

    NA4 = mean((r - mean r)^4) / [ (1/M) sum_{j=1..M} var(r_j) ]^2, the M-th record being this one: 3 for a normally
    distributed residual that doesn't change, and, unlike FM4, it goes on rising while damage spreads. Source:
    Zakrajsek, Townsend and Decker, "An analysis of gear fault detection methods as applied to pitting fatigue failure
    data", NASA TM 105950 (1993), from memory. It grows with load as well: compare records of the same operating bin.

    Args:
        residual: (per_turn,) `separate(...).residual`, any unit.
        earlier: variances (np.var) of the residuals of earlier records, unit squared.
        floor: smallest mean variance that is divided by (unit squared), for machines whose healthy residual is next to
            nothing; 0: none.

    Raises:
        InputError: a residual that can't be used (fewer than 8 points, not finite, constant), an earlier variance or a
            floor that is negative or not finite.
    """
    before = np.asarray(earlier, dtype=np.float64)
    if before.size and not (np.isfinite(before).all() and (before >= 0.0).all()):
        raise InputError(
            "earlier", "finite variances, none negative", str(before[~(before >= 0.0) | ~np.isfinite(before)][0])
        )
    return na4_after(residual, float(np.sum(before)), before.size, floor)


def na4_after(residual: Array, earlier: float, records: int, floor: float = 0.0) -> float:
    """`na4` from the sum of the variances of so many earlier records.

    Raises:
        InputError: a residual or a floor that can't be used.
    """
    r = checked.signal("residual", residual, 8)
    if not (np.isfinite(floor) and floor >= 0.0):
        raise InputError("floor", "a finite variance, not negative", repr(floor))
    scale = float(np.max(np.abs(r)))
    deviation = (r - r.mean()) / scale
    square = deviation * deviation
    mean_variance = (earlier / scale**2 + float(np.mean(square))) / (records + 1)
    return float(np.mean(square * square)) / max(mean_variance, floor / scale**2) ** 2
