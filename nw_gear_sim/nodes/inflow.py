"""What drives the gearbox: wind samples from a topic turned into speed and torque, or a fixed operating point.

Pure: samples and times come in as numbers. Two ways of keeping time with the wind exist. In *lock step* (simulated
time) the simulator waits until the wind is known for the whole interval that it is about to integrate, which makes a
run a function of its seed. In wall time nothing waits: the wind is taken a little late, so that there always are two
samples to interpolate between.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from dataclasses import dataclass, field

HISTORY = 64
LONGEST_DELAY = 2.0


@dataclass
class WindInflow:
    """The last samples of the wind and linear interpolation between them.

    Attributes:
        times: stamps (s), ascending.
        speeds: wind speed along the rotor axis (m/s).
    """

    times: deque[float] = field(default_factory=lambda: deque(maxlen=HISTORY))
    speeds: deque[float] = field(default_factory=lambda: deque(maxlen=HISTORY))

    def add(self, time: float, speed: float) -> None:
        """Take a new sample; one that isn't newer than the last starts the history again (a new epoch)."""
        if self.times and time <= self.times[-1]:
            self.clear()
        self.times.append(time)
        self.speeds.append(speed)

    def clear(self) -> None:
        """Forget all samples."""
        self.times.clear()
        self.speeds.clear()

    def covers(self, start: float, end: float) -> bool:
        """Whether the wind is known from start to end (s)."""
        return bool(self.times) and self.times[0] <= start and self.times[-1] >= end

    @property
    def delay(self) -> float:
        """Time (s) by which the wind is late in wall time: an interval of its samples and half of one for their way."""
        if len(self.times) < 2:
            return 0.0
        return min(1.5 * (self.times[-1] - self.times[-2]), LONGEST_DELAY)

    def at(self, time: float) -> float:
        """Wind speed (m/s) at a time (s), interpolated linearly, held beyond both ends of what is known."""
        if time <= self.times[0]:
            return self.speeds[0]
        if time >= self.times[-1]:
            return self.speeds[-1]
        i = bisect_right(self.times, time) - 1
        share = (time - self.times[i]) / (self.times[i + 1] - self.times[i])
        return self.speeds[i] + share * (self.speeds[i + 1] - self.speeds[i])
