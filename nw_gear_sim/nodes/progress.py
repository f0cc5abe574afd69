"""Says how a run goes, from one report to the next. Pure: times come in as numbers."""

from __future__ import annotations

import math

from nw_gear_sim.nodes.pacing import Pace

QUIET = 5.0
"""Seconds without input that may always pass."""
INTERVALS = 3.0
"""Intervals between inputs that may pass without one."""


class Silence:
    """How long there has been no input, where that is longer than it should be."""

    def __init__(self) -> None:
        self._last = math.nan
        self._interval = 0.0

    def heard(self, wall: float) -> None:
        """Note that input came at a wall time (s, monotonic)."""
        self._interval = 0.0 if math.isnan(self._last) else wall - self._last
        self._last = wall

    def length(self, wall: float) -> float:
        """Return the seconds since the last input; 0 where that is usual, or where none has come yet."""
        silence = wall - self._last
        return silence if silence > max(QUIET, INTERVALS * self._interval) else 0.0


class Progress:
    """What a run is doing.

    Args:
        topic: where its input comes from; "" for none.
        waits: whether it waits for its input (simulated time) or goes on with what it has.
    """

    def __init__(self, topic: str, *, waits: bool) -> None:
        self._topic, self._waits = topic, waits
        self._silence = Silence()
        self._before = math.nan

    def heard(self, wall: float) -> None:
        """Note that input came at a wall time (s, monotonic)."""
        self._silence.heard(wall)

    def report(self, pace: Pace, wall: float, simulated: float, *, paused: bool, starved: bool) -> tuple[bool, str]:
        """Return whether something is wrong, and what is going on.

        Args:
            pace: of the run.
            wall: s, monotonic; simulated: s.
            paused: by somebody.
            starved: for want of input.
        """
        stuck, self._before = simulated == self._before, simulated
        if paused:
            return False, "paused"
        if starved and stuck:
            return True, f"waiting for {self._topic} beyond {simulated:.3f} s"
        if pace.too_slow(wall, simulated):
            wanted = f"{pace.factor:g} wanted"
            return True, f"can't keep pace: {pace.reached():.2f} times real time reached, {wanted}"
        silence = 0.0 if self._waits or not self._topic else self._silence.length(wall)
        if silence:
            return True, f"nothing on {self._topic} for {silence:.0f} s: its last value holds"
        return False, "integrating"
