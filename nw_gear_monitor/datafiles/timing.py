"""The sample rate: from the command line, from the file, from a column of times; and whether they agree."""

from __future__ import annotations

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_monitor.datafiles.source import Source
from nw_gear_monitor.signals import checked

STEP_TOLERANCE = 0.01
"""Share of the step by which steps may differ."""
RATE_TOLERANCE = 1e-3
"""Share by which two statements of a rate may differ."""
ROUNDED = 0.999
"""Steps of rounded times differ by up to what they are rounded to."""
MOSTLY = 0.98
"""Where so many rounded steps are the same, another one is a sample that is missing, not a rounding that added up."""
DRIFT = 2.5e-4
"""Share of the record by which times may leave a straight line: half as much as a rate changed by 0.2 % halfway."""


def sample_rate(source: Source, given: float | None) -> float:
    """Return the sample rate, Hz.

    Args:
        source: the file. Its times, where it has any, have to lie at equal steps.
        given: on the command line, or None.

    Raises:
        InputError: no rate anywhere, two that differ, times that don't grow or aren't at equal steps.
    """
    stated = {"--rate": given, f"the header of {source.place}": source.rate}
    measured, slack = (None, 0.0) if source.time is None else _of_times(source, source.time)
    stated[f"column {source.time}"] = measured
    known = [(place, rate) for place, rate in stated.items() if rate is not None]
    if not known:
        raise InputError("--rate", f"the sample rate of {source.place} in Hz", "nothing")
    place, rate = known[0]
    checked.positive(place, rate)
    for other, value in known[1:]:
        if not abs(value / rate - 1.0) <= RATE_TOLERANCE + slack:
            raise InputError(place, f"{value:.6g} Hz, as {other} says", f"{rate:.6g} Hz")
    return rate


def _of_times(source: Source, name: str) -> tuple[float, float]:
    """Rate by the times, Hz, and the share of it that their rounding leaves open."""
    place = f"{source.place}: column {name}"
    times = checked.finite(place, source.columns[name], 3)
    times = times - times[0]
    steps = np.diff(times)
    step = float(times[-1]) / steps.size
    rounding = source.time_resolution + 4.0 * float(np.spacing(np.max(np.abs(source.columns[name]))))
    least = 0.0 if ROUNDED * rounding < step else -np.spacing(0.0)  # times that are written too coarsely repeat
    if step <= 0.0 or np.any(steps <= least):
        k = int(np.argmin(steps))
        raise InputError(place, "times that grow", f"{times[k]:.9g} s, then {times[k + 1]:.9g} s at sample {k + 1}")
    usual, allowed = float(np.median(steps)), STEP_TOLERANCE * step
    if rounding > allowed and np.mean(np.abs(steps - usual) < allowed) < MOSTLY:  # steps of several roundings
        usual, allowed = step, ROUNDED * rounding
    off = np.abs(steps - usual)
    k = int(np.argmax(off))
    if off[k] > allowed:
        raise InputError(place, f"steps of {usual:.6g} s", f"{steps[k]:.6g} s at sample {k + 1}")
    line = np.abs(times - step * np.arange(times.size))
    k = int(np.argmax(line))
    if line[k] > (1.0 + DRIFT * times.size) * step + 2.0 * rounding:
        raise InputError(place, f"one sample rate ({1.0 / step:.6g} Hz)", f"another one before or after sample {k}")
    return 1.0 / step, 2.0 * rounding / float(times[-1])
