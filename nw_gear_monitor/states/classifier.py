"""The state of a signal of unknown origin: recurrence first, then what the rest is made of."""

from __future__ import annotations

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked
from nw_gear_monitor.states.cycles import TURN, Record, record
from nw_gear_monitor.states.judgement import LEAST_STROBES, Verdict, judge, unknown
from nw_gear_monitor.states.strobing import dominant_phase, maxima

LEAST_SAMPLES = 64

__all__ = ["Verdict", "classify"]


def classify(x: Array, *, rate: float | None = None, strobe: Array | None = None, v: Array | None = None) -> Verdict:
    """State of a signal of unknown origin; nothing about its noise has to be known.

    Args:
        x: (samples,) one channel, any unit; without rate and strobe one point a period (a map, a strobed signal).
        rate: samples per second, Hz. Without `strobe` the strongest line gives the period, or, where there is no sharp
            line, the signal's maxima are taken.
        strobe: (samples,) unwrapped phase, rad; one strobe every 2 pi.
        v: (samples,) a second channel of the same system, such as the derivative of x.

    Raises:
        InputError: values that aren't finite, other lengths, a phase that doesn't grow, a rate that isn't positive,
            fewer than 4 samples to a cycle.
    """
    x = checked.finite("x", x, 2)
    if v is not None:
        v = checked.finite("v", v, 1)
        if v.size != x.size:
            raise InputError("v", f"one value for each of {x.size} x", str(v.size))
    if rate is not None:
        checked.positive("rate", rate)
    if strobe is not None:
        strobe = checked.phase("strobe", strobe, x.size)
    scale = float(np.max(np.abs(x)))
    if not (scale > 0.0 and float(np.std(x / scale)) > checked.LEAST_SPREAD):
        return unknown("no vibration: the signal is constant")
    if strobe is not None:
        return _cut(x, strobe, v)
    return judge(record(x, None, v)) if rate is None else _without_strobe(x, v)


def _without_strobe(x: Array, v: Array | None) -> Verdict:
    if x.size < LEAST_SAMPLES:
        return unknown(f"{x.size} of at least {LEAST_SAMPLES} samples seen")
    phase = dominant_phase(x)
    if phase is not None:
        return _cut(x, phase, v)
    points: Record | None = maxima(x)
    return unknown("no line and no maxima to strobe by") if points is None else judge(points)


def _cut(x: Array, phase: Array, v: Array | None) -> Verdict:
    strobes = max(int((phase[-1] - phase[0]) / TURN) - 1, 0)
    if strobes < LEAST_STROBES:
        return unknown(f"{strobes} of at least {LEAST_STROBES} strobes seen")
    return judge(record(x, phase, v))
