"""Keeps the last whole seconds of one epoch and hands out contiguous windows of them."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.signals.differences import derivative
from nw_gear_monitor.signals.stream import Second


class History:
    """The last `capacity` contiguous seconds.

    Args:
        capacity: how many.
        derived: column that isn't in the seconds -> column whose derivative it is.
    """

    def __init__(self, capacity: int, derived: Mapping[str, str] | None = None) -> None:
        self._seconds: deque[Second] = deque(maxlen=capacity)
        self._derived = derived or {}

    def __len__(self) -> int:
        return len(self._seconds)

    def append(self, second: Second) -> bool:
        """Add a second; returns True where it doesn't continue the last one, so that everything older was dropped."""
        last = self._seconds[-1] if self._seconds else None
        broken = last is not None and (second.epoch != last.epoch or second.start != last.start + 1)
        if broken:
            self._seconds.clear()
        # column by column in memory: windows are put together from columns
        self._seconds.append(replace(second, data=np.asfortranarray(second.data)))
        return broken

    def clear(self) -> None:
        """Drop everything."""
        self._seconds.clear()

    @property
    def newest(self) -> Second:
        """The latest second."""
        return self._seconds[-1]

    def last(self, seconds: int) -> list[Second]:
        """The latest seconds, oldest first, at most `seconds` of them."""
        return list(self._seconds)[-seconds:]

    def select(self, columns: Sequence[str], seconds: int) -> Array:
        """Named columns of the latest seconds, an array (samples, len(columns)) whose columns are contiguous."""
        where = [self.newest.columns.index(self._derived.get(name, name)) for name in columns]
        pieces = [second.data for second in self.last(seconds)]
        data = np.empty((sum(len(piece) for piece in pieces), len(where)), order="F")
        for column, source in enumerate(where):
            np.concatenate([piece[:, source] for piece in pieces], out=data[:, column])
        made = [i for i, name in enumerate(columns) if name in self._derived]
        if made:
            data[:, made] = derivative(data[:, made], self.newest.rate)
        return data
