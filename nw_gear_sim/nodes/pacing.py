"""Keeps simulated time in step with the wall: how long to wait, how far behind, at which factor.

Pure: the wall time comes in as a number. Simulated time is never skipped; where the machine can't keep pace the lag
grows, is reported, and shrinks again when there is room.
"""

from __future__ import annotations

import math
from collections import deque

SPAN = 5.0
"""Seconds of wall time over which the factor reached is measured."""
TOLERATED_LAG = 0.5


class Pace:
    """Pace of one run.

    Args:
        factor: simulated seconds per second of wall time; 0 = as fast as possible.
        wall: wall time at the start (s, monotonic).
        simulated: simulated time at the start (s).
    """

    def __init__(self, factor: float, wall: float, simulated: float) -> None:
        self.factor = factor
        self._start = (wall, simulated)
        self._history: deque[tuple[float, float]] = deque([(wall, simulated)])

    def wait(self, wall: float, simulated: float) -> float:
        """Seconds to wait before simulated time may pass `simulated`; 0 where it is due or the run isn't paced."""
        return max(0.0, -self.lag(wall, simulated))

    def lag(self, wall: float, simulated: float) -> float:
        """Seconds of wall time by which the run is behind (negative: ahead); 0 where it isn't paced."""
        if self.factor == 0.0:
            return 0.0
        return (wall - self._start[0]) - (simulated - self._start[1]) / self.factor

    def note(self, wall: float, simulated: float) -> None:
        """Record progress, for `reached`."""
        self._history.append((wall, simulated))
        while len(self._history) > 2 and wall - self._history[1][0] > SPAN:
            self._history.popleft()

    def reached(self) -> float:
        """Simulated seconds per second of wall time over the last seconds (NaN before there are any)."""
        (wall, simulated), (now, reached) = self._history[0], self._history[-1]
        return (reached - simulated) / (now - wall) if now > wall else math.nan

    def too_slow(self, wall: float, simulated: float) -> bool:
        """Whether the lag is more than a recorder or a person would overlook."""
        return self.lag(wall, simulated) > TOLERATED_LAG


class Busy:
    """How much of a core a task uses, between two looks at it.

    Args:
        wall: wall time now (s, monotonic).
    """

    def __init__(self, wall: float) -> None:
        self._since = wall
        self._spent = 0.0

    def note(self, cpu: float) -> None:
        """Add CPU time that the task has used (s)."""
        self._spent += cpu

    def share(self, wall: float) -> float:
        """CPU time over wall time since the last look (NaN where none has passed); counting begins anew."""
        share = self._spent / (wall - self._since) if wall > self._since else math.nan
        self._since, self._spent = wall, 0.0
        return share
