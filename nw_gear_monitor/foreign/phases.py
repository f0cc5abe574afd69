"""The phase of a shaft from what people record: an angle, wrapped or not, or the signal of a tacho."""

from __future__ import annotations

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked
from nw_gear_monitor.signals.tacho import Pulses, read_pulses

ANGLES = {"rad": 2.0 * np.pi, "deg": 360.0, "turn": 1.0}
"""One turn, by unit."""
HYSTERESIS = 0.25
"""A pulse has to pass the middle of the signal's range by this share of half of it on either side."""


def unwrapped(place: str, angle: Array, unit: str) -> Array:
    """Return an angle as a phase that grows, rad.

    Args:
        place: of the column, for errors.
        angle: (samples,) that starts again at 0 after each turn, or doesn't.
        unit: key of ANGLES.

    Raises:
        InputError: values that aren't finite, a phase that doesn't grow from sample to sample.
    """
    turn = ANGLES[unit]
    values = checked.finite(place, angle, 2)
    if np.any(np.abs(np.diff(values)) > 0.5 * turn):
        values = np.unwrap(values, period=turn)
    return checked.phase(place, values * (2.0 * np.pi / turn), values.size)


def pulses(place: str, time: Array, level: Array, per_turn: int) -> Pulses:
    """Find the pulses in a tacho's signal: where it rises through the middle of its range.

    Args:
        place: of the column, for errors.
        time: (samples,) s.
        level: (samples,) any unit.
        per_turn: marks on the shaft.

    Raises:
        InputError: a signal that doesn't vary, or pulses that can't be used (see `read_pulses`).
    """
    values = checked.signal(place, level, 3)
    low, high = float(values.min()), float(values.max())
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    side = np.where(values > middle + HYSTERESIS * half, 1, np.where(values < middle - HYSTERESIS * half, -1, 0))
    sure = np.flatnonzero(side)
    changes = np.flatnonzero((side[sure[1:]] == 1) & (side[sure[:-1]] == -1))
    times = np.array([_rise(time, values, middle, sure[k], sure[k + 1]) for k in changes])
    try:
        return read_pulses(times, per_turn)
    except InputError as error:
        raise InputError(f"{place}: {error.place}", error.expected, error.got) from error


def _rise(time: Array, values: Array, middle: float, below: int, above: int) -> float:
    """Moment at which the signal passes the middle between two samples on either side of it, for the last time."""
    i = below + int(np.flatnonzero(values[below:above] <= middle)[-1])
    share = (middle - values[i]) / (values[i + 1] - values[i])
    return float(time[i] + share * (time[i + 1] - time[i]))
