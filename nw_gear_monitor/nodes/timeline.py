"""Recorded time as a function of wall time: a rate that may change, a pause, and starts anew."""

from __future__ import annotations

import threading
import time


class Timeline:
    """Where a replay is; may be set from another thread.

    Args:
        rate: recorded seconds per second.
    """

    def __init__(self, rate: float) -> None:
        self._changed = threading.Condition()
        self._rate = rate
        self._paused = False
        self._moment = 0
        self._at = time.monotonic()

    def begin(self, moment: int) -> None:
        """Be at a moment (ns) now."""
        with self._changed:
            self._moment, self._at = moment, time.monotonic()

    def now(self) -> int:
        """The moment (ns) it is."""
        with self._changed:
            return self._now()

    def _now(self) -> int:
        elapsed = 0.0 if self._paused else time.monotonic() - self._at
        return self._moment + round(1e9 * self._rate * elapsed)

    def until(self, moment: int) -> float:
        """Wall seconds until a moment (ns); infinite while paused."""
        with self._changed:
            return float("inf") if self._paused else 1e-9 * (moment - self._now()) / self._rate

    def set_rate(self, rate: float) -> None:
        """Go on from here at another rate."""
        with self._changed:
            self._moment, self._at = self._now(), time.monotonic()
            self._rate = rate
            self._changed.notify_all()

    def pause(self, paused: bool) -> None:
        """Stand still, or go on."""
        with self._changed:
            self._moment, self._at = self._now(), time.monotonic()
            self._paused = paused
            self._changed.notify_all()

    def sleep(self, seconds: float) -> None:
        """Wait, shorter where something is set meanwhile."""
        with self._changed:
            self._changed.wait(seconds)

    def wake(self) -> None:
        """End a sleep."""
        with self._changed:
            self._changed.notify_all()
