"""Buffers of fixed size that several readers follow, each from where it left off."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array


class Ring:
    """The newest rows of a table; whoever reads keeps the count of rows that it has seen.

    Args:
        columns: numbers in a row.
        capacity: rows that are kept.
    """

    def __init__(self, columns: int, capacity: int) -> None:
        self._rows = np.empty((capacity, columns))
        self.capacity = capacity
        self.count = 0

    def __len__(self) -> int:
        return min(self.count, self.capacity)

    def add(self, rows: Array) -> None:
        """Append rows of shape (n, columns); the oldest ones make room."""
        newest = rows[-self.capacity :]
        at = (self.count + len(rows) - len(newest) + np.arange(len(newest))) % self.capacity
        self._rows[at] = newest
        self.count += len(rows)

    def since(self, seen: int) -> Array:
        """A copy of the rows after the first `seen` ones, oldest first: those of them that are still kept."""
        first = max(seen, self.count - self.capacity, 0)
        found: Array = self._rows[np.arange(first, self.count) % self.capacity]
        return found

    def everything(self) -> Array:
        """A copy of all rows that are kept, oldest first."""
        return self.since(0)

    @property
    def last(self) -> Array | None:
        """The newest row, None where there is none."""
        return self._rows[(self.count - 1) % self.capacity].copy() if self.count else None

    def clear(self) -> None:
        """Forget everything; readers have to begin anew."""
        self.count = 0


class Bins:
    """Exact minimum, maximum and mean of several signals in equal bins of time; a bin is given out once it is over.

    Args:
        channels: how many signals there are.
        width: of a bin (s); edges are whole multiples of it from `origin` on.
        origin: s.
    """

    def __init__(self, channels: int, width: float, origin: float) -> None:
        self._width, self._origin = width, origin
        self._index: int | None = None
        self._low, self._high = np.full(channels, np.inf), np.full(channels, -np.inf)
        self._sum, self._count = np.zeros(channels), 0

    def add(self, time: Array, values: Array) -> Array:
        """Take samples and return the bins that they completed.

        Args:
            time: (n,) in s, ascending, later than all before.
            values: (n, channels), finite.

        Returns:
            one row per bin with samples: centre (s), then the minima, the maxima and the means of all channels.
        """
        if not len(time):
            return np.empty((0, 1 + 3 * len(self._low)))
        index = np.floor((time - self._origin) / self._width).astype(np.int64)
        starts = np.flatnonzero(np.diff(index, prepend=index[0] - 1))
        low = np.minimum.reduceat(values, starts, axis=0)
        high = np.maximum.reduceat(values, starts, axis=0)
        total = np.add.reduceat(values, starts, axis=0)
        count = np.diff(np.append(starts, len(index)))
        at = index[starts]
        if self._index is not None and at[0] == self._index:
            low[0], high[0] = np.minimum(low[0], self._low), np.maximum(high[0], self._high)
            total[0] += self._sum
            count[0] += self._count
        elif self._index is not None:
            at, count = np.insert(at, 0, self._index), np.insert(count, 0, self._count)
            low, high = np.vstack([self._low, low]), np.vstack([self._high, high])
            total = np.vstack([self._sum, total])
        self._index, self._count = int(at[-1]), int(count[-1])
        self._low, self._high, self._sum = low[-1].copy(), high[-1].copy(), total[-1].copy()
        centre = self._origin + (at[:-1] + 0.5) * self._width
        return np.hstack([centre[:, None], low[:-1], high[:-1], total[:-1] / count[:-1, None]])


def zigzag(bins: Array, channels: int, width: float, longest_gap: float, before: float | None = None) -> Array:
    """Bins as lines that go through the minimum and the maximum of each: two points per bin.

    Args:
        bins: rows as `Bins` returns them.
        channels: how many signals there are.
        width: of a bin (s).
        longest_gap: between the centres of bins (s) above which the line is broken by a row of NaN.
        before: centre of the bin that came last before these (s), None where there is none.

    Returns:
        rows of time (s) and one value per channel.
    """
    if not len(bins):
        return np.empty((0, 1 + channels))
    points = np.empty((2 * len(bins), 1 + channels))
    points[0::2, 0], points[1::2, 0] = bins[:, 0] - 0.25 * width, bins[:, 0] + 0.25 * width
    points[0::2, 1:], points[1::2, 1:] = bins[:, 1 : 1 + channels], bins[:, 1 + channels : 1 + 2 * channels]
    previous = np.concatenate([[bins[0, 0] if before is None else before], bins[:-1, 0]])
    broken = np.flatnonzero(bins[:, 0] - previous > longest_gap)
    rows = np.insert(points, 2 * broken, np.nan, axis=0)
    rows[2 * broken + np.arange(len(broken)), 0] = 0.5 * (previous[broken] + bins[broken, 0])
    return rows
