"""Strobes where none are given: the phase of the strongest line, or a signal's maxima."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.states.cycles import Record, record

LEAST_SHARE = 0.2
"""Of the variance, in the line that is strobed by."""
BINS = 24
"""A line that a drifting speed widens to this many bins is still a line."""
PARTS = 96
DEGREE = 5
MOST_SLIP = 0.35
"""Rms distance of the line's phase from a polynomial of time, rad."""
SMOOTHED = 8


def dominant_phase(x: Array) -> Array | None:
    """Phase (rad) of the strongest line of a sampled signal; None where no line stands out or its phase wanders.

    The line is shifted to zero frequency and averaged over PARTS parts of the record; through its unwrapped phase goes
    a polynomial of degree DEGREE in time, so that a slow change of speed is followed and noise is not.

    Args:
        x: (samples,) any unit, at equal steps.
    """
    values = x - x.mean()
    size = values.size
    power = np.abs(np.fft.rfft(values * np.hanning(size))) ** 2
    power[:3] = 0.0
    peak = int(np.argmax(power))
    wide = min(BINS, max(peak // 8, 2))
    if power[max(peak - wide, 0) : peak + wide + 1].sum() < LEAST_SHARE * power.sum():
        return None
    angle = 2.0 * np.pi * peak / size
    number: Array = np.arange(size, dtype=np.float64)
    parts = max(min(PARTS, peak // 4), 8)
    length = size // parts
    shifted = (values * np.exp(-1j * angle * number))[: parts * length].reshape(parts, length)
    level = shifted @ np.hanning(length)
    phase = np.unwrap(np.angle(level))
    middle = (np.arange(parts) + 0.5) * length / size
    fit = np.polynomial.Polynomial.fit(middle, phase, min(DEGREE, parts // 3))
    if float(np.std(phase - fit(middle))) > MOST_SLIP:
        return None
    strobe: Array = angle * number + fit(number / size)
    return strobe if bool(np.all(np.diff(strobe) > 0.0)) else None


def maxima(x: Array) -> Record | None:
    """The maxima of a signal and the times between them, as a record of one point a cycle; None where there are few.

    The signal is averaged over an eighth of its mean period first, so that noise makes no maxima of its own.

    Args:
        x: (samples,) any unit, at equal steps.
    """
    values = x - x.mean()
    power = np.abs(np.fft.rfft(values)) ** 2
    frequency = float(np.arange(power.size) @ power / power.sum()) / x.size
    width = max(int(1.0 / max(frequency, 1.0 / x.size) / SMOOTHED), 1)
    smooth = np.convolve(values, np.hanning(width + 2)[1:-1] / np.hanning(width + 2).sum(), mode="valid")
    inner = smooth[1:-1]
    at = np.flatnonzero((inner > smooth[:-2]) & (inner >= smooth[2:])) + 1
    if at.size < 3:
        return None
    low, top, high = smooth[at - 1], smooth[at], smooth[at + 1]
    bend = low - 2.0 * top + high
    shift = np.where(bend < 0.0, 0.5 * (low - high) / np.where(bend < 0.0, bend, -1.0), 0.0)
    height = top - 0.25 * (low - high) * shift
    gaps = np.diff(at + shift)
    return record(height[1:], None, gaps) if np.ptp(height[1:]) > 0.0 else None
