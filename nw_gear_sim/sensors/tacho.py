"""Pulses of a tacho: the times at which a shaft passes whole parts of a turn."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array

ITERATIONS = 6
"""Steps of Newton's method: from a straight line between two samples of a turning shaft it needs two."""


class Tacho:
    """Finds pulses in samples of a shaft's angle.

    The shaft passes the angles 2 pi k / pulses, k whole, at the pulses. Between samples the angle is the cubic with the
    angles and speeds of both (Hermite), off by h^4 theta''''/384 for samples h apart: below 1e-12 s for every torsional
    vibration of this gearbox. Each mark gives one pulse, when it is passed for the first time: a shaft that swings
    about a mark, or turns back, gives none again.

    Args:
        pulses: in a turn, at least 1.
    """

    def __init__(self, pulses: int) -> None:
        self._pulses, self._pitch = pulses, 2.0 * math.pi / pulses
        self._last = np.empty(0)
        self._next = 0

    def forget(self) -> None:
        """Be as at the beginning."""
        self._last, self._next = np.empty(0), 0

    def state(self) -> dict[str, Any]:
        """Return all that the future depends on."""
        return {"last": self._last.copy(), "next": self._next, "pulses": self._pulses}

    def restore(self, state: Mapping[str, Any]) -> None:
        """Take over what `state` returned.

        Raises:
            InputError: it isn't that, or of another number of pulses.
        """
        if state.get("pulses") != self._pulses:
            raise InputError("checkpoint: sensors.tacho", f"{self._pulses} pulses", str(state.get("pulses", "nothing")))
        last = np.asarray(state.get("last"))
        if last.shape not in ((0,), (3,)) or "next" not in state:
            raise InputError("checkpoint: sensors.tacho", "time, angle and speed of a shaft", f"shape {last.shape}")
        self._last, self._next = last.astype(np.float64), int(state["next"])

    def advance(self, time: Array, angle: Array, speed: Array) -> Array:
        """Return the times (s) of the pulses up to the last of the samples, ascending.

        Args:
            time: (samples,) s, later than those before.
            angle: (samples,) unwrapped, rad, growing where the shaft turns forwards.
            speed: (samples,) its derivative, rad/s.
        """
        samples = np.stack([time, angle, speed], axis=1)
        if self._last.size:
            samples = np.concatenate([self._last[None, :], samples])
        else:
            self._next = math.floor(angle[0] / self._pitch) + 1
        self._last = samples[-1].copy()
        reached = np.maximum.accumulate(samples[:, 1])
        marks = np.arange(self._next, math.floor(reached[-1] / self._pitch) + 1)
        if not marks.size:
            return np.empty(0)
        self._next = int(marks[-1]) + 1
        target = marks * self._pitch
        after = np.clip(np.searchsorted(reached, target), 1, len(samples) - 1)
        return _passing(samples[after - 1], samples[after], target)


def _passing(before: Array, after: Array, target: Array) -> Array:
    """Times at which Hermite cubics between samples (n, 3) of time, angle and speed take the target angles (n,)."""
    step = after[:, 0] - before[:, 0]
    rise = after[:, 1] - before[:, 1]
    first, last = step * before[:, 2], step * after[:, 2]
    square, cube = 3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise
    wanted = target - before[:, 1]
    steady = np.where(rise > 0.0, rise, np.inf)
    share = np.clip(wanted / steady, 0.0, 1.0)
    for _ in range(ITERATIONS):
        slope = first + share * (2.0 * square + 3.0 * cube * share)
        missing = wanted - share * (first + share * (square + cube * share))
        share = np.clip(share + missing / np.where(slope > 0.0, slope, steady), 0.0, 1.0)
    return np.asarray(before[:, 0] + share * step)
