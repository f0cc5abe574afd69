"""Severities over time: linear ramps between the values that were asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from nw_gear_common.quantities import quantities
from nw_gear_sim.params.faults import PLACES, SEVERITIES, FaultSettings


@dataclass
class Ramp:
    """One severity: from `start` at time `began` to `target`, `length` seconds later.

    Attributes:
        since: when it left 0, s; nan while it is 0.
    """

    start: float = 0.0
    target: float = 0.0
    began: float = 0.0
    length: float = 0.0
    since: float = float("nan")

    def at(self, time: float) -> float:
        """Severity at a time (s), linear on the ramp."""
        if time >= self.began + self.length:
            return self.target
        return self.start + (self.target - self.start) * max(0.0, time - self.began) / self.length

    def go(self, target: float, time: float, length: float, *, anew: bool) -> None:
        """Change towards a new value from now on, from 0 where the place is a new one (`anew`)."""
        now = 0.0 if anew else self.at(time)
        if now == 0.0:
            self.since = time if target != 0.0 else float("nan")
        self.start, self.target, self.began, self.length = now, target, time, length


class Ramps:
    """All severities of the faults of one gearbox."""

    def __init__(self) -> None:
        self.settings = FaultSettings()
        self._ramps = {name: Ramp() for names in SEVERITIES.values() for name in names}

    def change(self, settings: FaultSettings, time: float) -> None:
        """Take over what is asked for from a time (s) on; severities that stay the same stay on their ramps."""
        for kind, severities in SEVERITIES.items():
            moved = any(getattr(settings, name) != getattr(self.settings, name) for name in PLACES[kind])
            for name in severities:
                target = getattr(settings, name)
                if moved or target != self._ramps[name].target:
                    self._ramps[name].go(target, time, settings.fault_ramp, anew=moved)
        self.settings = settings

    def at(self, time: float) -> dict[str, float]:
        """Return all severities at a time, s."""
        return {name: ramp.at(time) for name, ramp in self._ramps.items()}

    def since(self, kind: str) -> float:
        """Return when a fault of a kind began, s; nan where there is none."""
        return float(np.fmin.reduce([self._ramps[name].since for name in SEVERITIES[kind]]))

    def state(self) -> dict[str, Any]:
        """Return all that the future depends on, as plain numbers and texts."""
        asked = {name: getattr(self.settings, name) for name in self.settings.__dataclass_fields__}
        on = {
            f"{name}.{part}": getattr(ramp, part)
            for name, ramp in self._ramps.items()
            for part in ("start", "target", "began", "length", "since")
        }
        return {**asked, **on}

    def restore(self, state: Mapping[str, Any]) -> None:
        """Take over what `state` returned; KeyError where something is missing."""
        kinds = {name: kind for name, kind, _, _ in quantities(FaultSettings)}
        self.settings = FaultSettings(**{name: kind(state[name]) for name, kind in kinds.items()})
        for name, ramp in self._ramps.items():
            for part in ("start", "target", "began", "length", "since"):
                setattr(ramp, part, float(state[f"{name}.{part}"]))
