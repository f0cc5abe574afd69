"""Samples from topics that drive the gearbox: the wind, or speed and torque.

Pure: samples and times come in as numbers. Two ways of keeping time with them exist. In *lock step* (simulated time)
the simulator waits until they are known for the whole interval that it is about to integrate, which makes a run a
function of its seed. In wall time nothing waits: they are taken a little late, so that there always are two samples to
interpolate between.
"""

from __future__ import annotations

import threading
from bisect import bisect_right
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field

HISTORY = 64
LONGEST_DELAY = 2.0


@dataclass
class Inflow:
    """The last samples of a quantity and linear interpolation between them.

    Attributes:
        times: stamps (s), ascending.
        values: of the quantity.
    """

    times: deque[float] = field(default_factory=lambda: deque(maxlen=HISTORY))
    values: deque[float] = field(default_factory=lambda: deque(maxlen=HISTORY))

    def add(self, time: float, value: float) -> None:
        """Take a new sample; one that isn't newer than the last starts the history again (a new epoch)."""
        if self.times and time <= self.times[-1]:
            self.clear()
        self.times.append(time)
        self.values.append(value)

    def clear(self) -> None:
        """Forget all samples."""
        self.times.clear()
        self.values.clear()

    def covers(self, start: float, end: float) -> bool:
        """Whether the quantity is known from start to end (s)."""
        return bool(self.times) and self.times[0] <= start and self.times[-1] >= end

    @property
    def delay(self) -> float:
        """Time (s) by which it is late in wall time: an interval of its samples and half of one for their way."""
        if len(self.times) < 2:
            return 0.0
        return min(1.5 * (self.times[-1] - self.times[-2]), LONGEST_DELAY)

    def at(self, time: float) -> float:
        """Value at a time (s), interpolated linearly, held beyond both ends of what is known."""
        if time <= self.times[0]:
            return self.values[0]
        if time >= self.times[-1]:
            return self.values[-1]
        i = bisect_right(self.times, time) - 1
        share = (time - self.times[i]) / (self.times[i + 1] - self.times[i])
        return self.values[i] + share * (self.values[i + 1] - self.values[i])


class Inflows:
    """All quantities that a source needs; filled by one thread, read by another.

    Args:
        names: of the quantities.
        in_step: whether the run waits for them (simulated time).
    """

    def __init__(self, names: Iterable[str], *, in_step: bool) -> None:
        self._inflows = {name: Inflow() for name in names}
        self._in_step = in_step
        self._lock = threading.Lock()

    def add(self, time: float, **values: float) -> None:
        """Take samples stamped `time` (s) of those quantities that are needed."""
        with self._lock:
            for name, value in values.items():
                if name in self._inflows:
                    self._inflows[name].add(time, value)

    def ready(self, moment: float) -> bool:
        """Whether a run may begin at this moment (s)."""
        if self._in_step:
            return self.cover(moment, moment)
        with self._lock:
            return all(inflow.times for inflow in self._inflows.values())

    def cover(self, start: float, end: float) -> bool:
        """Whether nothing more has to be waited for to know everything from start to end (s)."""
        with self._lock:
            return not self._in_step or all(inflow.covers(start, end) for inflow in self._inflows.values())

    def at(self, moment: float) -> dict[str, float]:
        """Return all quantities at a moment (s), late by their own delays where the run doesn't wait for them."""
        with self._lock:
            return {
                name: inflow.at(moment if self._in_step else moment - inflow.delay)
                for name, inflow in self._inflows.items()
            }
