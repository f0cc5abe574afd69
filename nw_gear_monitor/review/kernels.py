"""The one loop over every sample of a recording, compiled."""

from __future__ import annotations

import numba
import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.records.chunks import Whole


@numba.njit(cache=True, nogil=True)
def fold(
    time: Array,
    data: Array,
    columns: Whole,
    origin: float,
    width: float,
    low: Array,
    high: Array,
    total: Array,
    count: Array,
) -> None:
    """Fold samples into bins of minimum, maximum, sum and count; rows with anything but finite numbers are left out.

    Args:
        time: (n,) in s, none before the origin or behind the last bin.
        data: (n, any).
        columns: which columns of `data` are meant, shape (channels,).
        origin, width: begin of the first bin and width of all (s).
        low, high, total: (bins, channels), changed.
        count: (bins,), changed.
    """
    channels = len(columns)
    for i in range(len(time)):
        good = True
        for j in range(channels):
            if not np.isfinite(data[i, columns[j]]):
                good = False
        if not good:
            continue
        k = int((time[i] - origin) / width)
        count[k] += 1.0
        for j in range(channels):
            value = data[i, columns[j]]
            total[k, j] += value
            low[k, j] = min(low[k, j], value)
            high[k, j] = max(high[k, j], value)


@numba.njit(cache=True, nogil=True)
def moments(data: Array, columns: Whole, shift: Array, first: Array, second: Array) -> None:
    """Add up (x - shift) and (x - shift)^2 of some columns into `first` and `second`, shape (channels,)."""
    for i in range(len(data)):
        for j in range(len(columns)):
            away = data[i, columns[j]] - shift[j]
            first[j] += away
            second[j] += away * away
