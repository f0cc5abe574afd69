"""Blocks that come twice or in the wrong order: told from a stream that begins anew a little earlier."""

from __future__ import annotations

from collections import deque

import numpy as np

from nw_gear_common.tables import Array

WITHIN = 1.0
"""A block that lies further in the past than this (s) is a stream that begins anew."""


class Late:
    """Looks at the time stamps of blocks.

    A block that lies in the past as a whole is put aside. If the next one continues it, the stream has begun anew and
    both count; if not, it had come twice (its stamps were seen before) or too late (they weren't).
    """

    def __init__(self) -> None:
        self._seen: deque[tuple[float, float]] = deque()
        self._aside: Array | None = None

    def forget(self) -> None:
        """Begin anew."""
        self._seen.clear()
        self._aside = None

    def accept(self, time: Array) -> None:
        """Remember the stamps of a block that counts."""
        self._seen.append((float(time[0]), float(time[-1])))
        while self._seen[0][1] < time[-1] - WITHIN:
            self._seen.popleft()

    def put_aside(self, data: Array) -> bool:
        """Look at a block (its first column are the stamps, s); True where it must wait for what comes next."""
        if not self._seen or self.begun_anew(data) is not None:
            return False
        newest = self._seen[-1][1]
        if data[-1, 0] > newest or data[0, 0] < newest - WITHIN:
            self._aside = None
            return False
        self._aside = data
        return True

    def repeated(self, time: Array) -> bool:
        """Whether exactly these stamps were seen before."""
        return (float(time[0]), float(time[-1])) in self._seen

    def begun_anew(self, data: Array) -> Array | None:
        """The block that was put aside, where this one continues it and lies in the past as well."""
        aside = self._aside
        if aside is None or data[-1, 0] > self._seen[-1][1]:
            return None
        step = float(np.median(np.diff(aside[:, 0])))
        return aside if abs(data[0, 0] - aside[-1, 0] - step) < 0.5 * step else None
