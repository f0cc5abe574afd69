"""The operating point of a window: whether it stood still enough to be compared, and the bin that it falls into."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from nw_gear_monitor.alarms.settings import LOAD_RATIO, SPEED_RATIO
from nw_gear_monitor.operating import Operating

NO_LOAD = -(2**31)
"""Load index of bins where neither torque nor wind is known."""


class Bin(NamedTuple):
    """Where speed and load lie: from ratio^index to ratio^(index + 1)."""

    speed: int
    load: int


def bin_of(speed: float, load: float) -> Bin | None:
    """The bin of a mean speed and load; None at standstill, or where the load is reversed. A load of nan is unknown."""
    if not speed > 0.0 or load <= 0.0 or math.isinf(load) or math.isinf(speed):
        return None
    index = NO_LOAD if math.isnan(load) else math.floor(math.log(load) / math.log(LOAD_RATIO))
    return Bin(math.floor(math.log(speed) / math.log(SPEED_RATIO)), index)


class Steadiness:
    """The operating points of the last seconds.

    Args:
        seconds: kept.
    """

    def __init__(self, seconds: int) -> None:
        self._points: deque[Operating] = deque(maxlen=seconds)

    def add(self, point: Operating) -> None:
        """Take in one second."""
        self._points.append(point)

    def clear(self) -> None:
        """Forget: the stream broke."""
        self._points.clear()

    def bin(self, seconds: int, speed: float, load: float) -> tuple[Bin | None, str]:
        """The bin of the last `seconds`, or None and the reason why this window isn't compared with anything.

        Args:
            seconds: length of the window.
            speed, load: largest spread (largest less smallest value, over the mean) of a window that is compared.
        """
        points = list(self._points)[-seconds:]
        if len(points) < seconds:
            return None, f"{len(points)} of {seconds} s seen"
        speeds, loads = [p.speed for p in points], [p.load for p in points]
        for name, values, limit in zip(("speed", "load"), (speeds, loads), (speed, load), strict=True):
            spread = _spread(values)
            if spread > limit:
                return None, f"{name} moved by {100 * spread:.0f} % within {seconds} s"
        found = bin_of(sum(speeds) / seconds, sum(loads) / seconds)
        return found, "" if found is not None else "at rest, or the load is reversed"


def _spread(values: Sequence[float]) -> float:
    """Largest less smallest over the mean's size; 0 where values are unknown."""
    mean = abs(sum(values)) / len(values)
    return (max(values) - min(values)) / mean if mean > 0.0 else 0.0
