"""Streaming reduction of long signals: min/max envelopes over time, the last seconds in full, max-pooled maps.

Every class here takes blocks as they come and needs memory that doesn't grow with the length of the recording.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.records.chunks import Whole
from nw_gear_monitor.review.kernels import fold

FIRST_WIDTH = 2.0**-10
"""Width of the first bins (s); a power of two, so that halving and doubling stay exact."""


@dataclass(frozen=True, eq=False)
class Band:
    """What is left of several signals on a common time base.

    Attributes:
        channels: names, in the order of the columns.
        time: centre of each bin (s), shape (bins,), ascending, empty bins left out.
        low, high: exact minimum and maximum in the bin, shape (bins, channels).
        mean: mean of the samples in the bin, shape (bins, channels).
        width: width of a bin (s).
    """

    channels: tuple[str, ...]
    time: Array
    low: Array
    high: Array
    mean: Array
    width: float

    def select(self, channels: tuple[str, ...]) -> Band:
        """The same band with some of its channels."""
        columns = [self.channels.index(c) for c in channels]
        return Band(channels, self.time, self.low[:, columns], self.high[:, columns], self.mean[:, columns], self.width)

    def coarser(self, bins: int) -> Band:
        """Neighbouring bins merged, until there are no more than `bins` in the span of time."""
        factor = 1
        while len(self.time) and (self.time[-1] - self.time[0]) / (self.width * factor) >= bins:
            factor *= 2
        if factor == 1:
            return self
        wide = self.width * factor
        first = self.time[0] - 0.5 * self.width
        index = np.floor((self.time - first) / wide + 1e-9).astype(np.int64)
        starts = np.flatnonzero(np.diff(index, prepend=-1))
        weights = np.diff(np.append(starts, len(index)))
        mean: Array = np.add.reduceat(self.mean, starts, axis=0) / weights[:, None]
        time: Array = first + (index[starts] + 0.5) * wide
        low = np.minimum.reduceat(self.low, starts, axis=0)
        return Band(self.channels, time, low, np.maximum.reduceat(self.high, starts, axis=0), mean, wide)

    def with_breaks(self, longest: float) -> Band:
        """Put a row of NaN between bins that are further apart than `longest` (s), so that no line bridges a gap."""
        after = np.flatnonzero(np.diff(self.time) > longest) + 1
        if not after.size:
            return self
        middle = 0.5 * (self.time[after - 1] + self.time[after])
        low, high, mean = (np.insert(part, after, np.nan, axis=0) for part in (self.low, self.high, self.mean))
        return Band(self.channels, np.insert(self.time, after, middle), low, high, mean, self.width)


class Envelope:
    """Minimum, maximum and mean in equal bins of time; the bins double in width when they become too many.

    Args:
        channels: names of the signals.
        bins: largest number of bins, even.
    """

    def __init__(self, channels: tuple[str, ...], bins: int = 2048) -> None:
        self.channels = channels
        self._bins = bins
        self._width = FIRST_WIDTH
        self._all = np.arange(len(channels))
        self._origin: float | None = None
        self._low = np.full((bins, len(channels)), np.inf)
        self._high = np.full((bins, len(channels)), -np.inf)
        self._sum = np.zeros((bins, len(channels)))
        self._count = np.zeros(bins)

    def add(self, time: Array, values: Array, columns: Whole | None = None) -> None:
        """Take samples; rows with a NaN are left out.

        Args:
            time: (n,) in s, ascending, none before the first of all.
            values: (n, channels).
            columns: where the channels stand in `values`, which may be wider (default: in order).
        """
        chosen = self._all if columns is None else columns
        if self._origin is None:
            good = np.isfinite(values[:, chosen]).all(axis=1)
            if not good.any():
                return
            self._origin = float(time[np.argmax(good)])
        if len(time) and time[0] < self._origin:
            time, values = time[time >= self._origin], values[time >= self._origin]
        time, values = np.ascontiguousarray(time), np.ascontiguousarray(values)
        while len(time) and (time[-1] - self._origin) / self._width >= self._bins:
            self._double()
        fold(time, values, chosen, self._origin, self._width, self._low, self._high, self._sum, self._count)

    def _double(self) -> None:
        half = self._bins // 2
        for array, merge, empty in (
            (self._low, np.minimum, np.inf),
            (self._high, np.maximum, -np.inf),
            (self._sum, np.add, 0.0),
            (self._count, np.add, 0.0),
        ):
            array[:half] = merge(array[0::2], array[1::2])
            array[half:] = empty
        self._width *= 2.0

    def result(self) -> Band | None:
        """What was collected up to now, None where nothing came."""
        if self._origin is None:
            return None
        used = np.flatnonzero(self._count)
        time: Array = self._origin + (used.astype(np.float64) + 0.5) * self._width
        mean: Array = self._sum[used] / self._count[used, None]
        return Band(self.channels, time, self._low[used], self._high[used], mean, self._width)


class Tail:
    """The last seconds of a table of samples, at full resolution.

    Args:
        seconds: how much to keep at least, where there is as much.
        time_column: index of the column of time.
    """

    def __init__(self, seconds: float, time_column: int = 0) -> None:
        self._seconds = seconds
        self._column = time_column
        self._blocks: deque[Array] = deque()

    def add(self, block: Array) -> None:
        """Take rows of shape (n, columns), later than all before."""
        if not len(block):
            return
        self._blocks.append(block)
        newest = block[-1, self._column]
        while newest - self._blocks[0][-1, self._column] > self._seconds:
            self._blocks.popleft()

    def clear(self) -> None:
        """Forget everything."""
        self._blocks.clear()

    def result(self) -> Array | None:
        """The rows of the last seconds, None where nothing came."""
        if not self._blocks:
            return None
        rows: Array = np.concatenate(self._blocks)
        kept: Array = rows[rows[:, self._column] >= rows[-1, self._column] - self._seconds]
        return kept


class Stretches:
    """Blocks of rows spread evenly over a run, and the last seconds: neighbours in a block are neighbours in the run.

    Args:
        rows: about how many rows are kept.
        seconds: how much is kept at the end in any case.
    """

    def __init__(self, rows: int, seconds: float) -> None:
        self._most = rows
        self._stride = 1
        self._seen = 0
        self._count = 0
        self._blocks: list[Array] = []
        self._tail = Tail(seconds)

    def add(self, block: Array) -> None:
        """Take rows of shape (n, columns), time first, later than all before."""
        self._tail.add(block)
        if self._seen % self._stride == 0 and len(block):
            self._blocks.append(block)
            self._count += len(block)
        self._seen += 1
        while self._count > self._most and len(self._blocks) > 1:
            self._blocks = self._blocks[::2]
            self._stride *= 2
            self._count = sum(map(len, self._blocks))

    def result(self) -> Array | None:
        """The rows that were kept, in order of time; None where nothing came."""
        tail = self._tail.result()
        if tail is None:
            return None
        before = [block[block[:, 0] < tail[0, 0]] for block in self._blocks]
        kept: Array = np.concatenate([*before, tail])
        return kept


class Waterfall:
    """A map of spectra over time, thinned by maxima: neighbouring rows are merged when they become too many.

    Args:
        rows: largest number of rows, even.
    """

    def __init__(self, rows: int = 600) -> None:
        self._limit = rows
        self._merge = 1
        self._pending: list[tuple[float, Array]] = []
        self._rows: list[tuple[float, Array]] = []

    def add(self, time: float, amplitude: Array) -> None:
        """Take one spectrum (any shape, the same every time) at a time (s)."""
        self._pending.append((time, amplitude))
        if len(self._pending) < self._merge:
            return
        self._rows.append(_merged(self._pending))
        self._pending = []
        if len(self._rows) >= self._limit:
            self._rows = [_merged(self._rows[i : i + 2]) for i in range(0, len(self._rows), 2)]
            self._merge *= 2

    def result(self) -> tuple[Array, Array] | None:
        """Times (rows,) and the map (rows, ...) of maxima, None where nothing came."""
        rows = self._rows + ([_merged(self._pending)] if self._pending else [])
        if not rows:
            return None
        return np.array([time for time, _ in rows]), np.stack([amplitude for _, amplitude in rows])


def _merged(rows: list[tuple[float, Array]]) -> tuple[float, Array]:
    return rows[0][0], np.maximum.reduce([amplitude for _, amplitude in rows])


def pool(values: Array, factor: int) -> Array:
    """Maximum over groups of neighbouring rows: (n, ...) becomes (ceil(n / factor), ...)."""
    if factor <= 1:
        return values
    return np.maximum.reduceat(values, np.arange(0, len(values), factor), axis=0)
