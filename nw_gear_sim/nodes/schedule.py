"""Which samples of a regular series are due at a time, over starts, jumps and stalls of the clock. Pure."""

from __future__ import annotations


class Schedule:
    """Counts the samples of a series that begins at an origin and has a constant rate; whole nanoseconds throughout.

    Args:
        rate: samples per second.
        lead: how far ahead of the clock samples are due, s.
        backlog: how many overdue samples are made up for; older ones are left out after a stall.
    """

    def __init__(self, rate: float, lead: float, backlog: int) -> None:
        self._rate = rate
        self._lead_ns = round(lead * 1e9)
        self._backlog = backlog
        self._origin_ns = 0
        self._now_ns = 0
        self._next = 0
        self.left_out = 0

    def begin(self, origin_ns: int, now_ns: int) -> None:
        """Begin with sample 0 at the origin; samples that are already past, beyond the backlog, aren't due any more."""
        self._origin_ns = origin_ns
        self._now_ns = now_ns
        self._next = max(0, self._index(now_ns) - self._backlog)

    def went_back(self, now_ns: int) -> bool:
        """Whether the clock stands before the time last seen."""
        return now_ns < self._now_ns

    @property
    def last(self) -> int:
        """Number of the last sample that was due, -1 before the first."""
        return self._next - 1

    def due(self, now_ns: int) -> range:
        """Return the numbers of the samples that are due now and weren't returned before."""
        self._now_ns = now_ns
        end = self._index(now_ns + self._lead_ns) + 1
        first = max(self._next, self._index(now_ns) - self._backlog)
        self.left_out += max(0, min(first, end) - self._next)
        self._next = max(first, end)
        return range(first, end)

    def stamp_ns(self, index: int) -> int:
        """Time of a sample, ns."""
        return self._origin_ns + round(index * 1e9 / self._rate)

    def _index(self, time_ns: int) -> int:
        """Number of the last sample whose stamp isn't after a time."""
        guess = int((time_ns - self._origin_ns) * self._rate / 1e9)
        while self.stamp_ns(guess + 1) <= time_ns:
            guess += 1
        while self.stamp_ns(guess) > time_ns:
            guess -= 1
        return guess
