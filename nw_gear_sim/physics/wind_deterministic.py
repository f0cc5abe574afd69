"""Wind speeds without chance: constant and step."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ConstantWind:
    """The same wind speed at all times.

    Attributes:
        speed: m/s.
    """

    speed: float

    def at(self, _time: float) -> float:
        """Wind speed (m/s) at any time."""
        return self.speed


@dataclass(frozen=True)
class StepWind:
    """One wind speed before a moment, another from then on.

    Attributes:
        before, after: m/s.
        time: moment of the step, s.
    """

    before: float
    after: float
    time: float

    def at(self, time: float) -> float:
        """Wind speed (m/s) at a time (s)."""
        return self.before if time < self.time else self.after
