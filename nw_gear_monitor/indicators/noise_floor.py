"""Variance of white noise in a signal, from the top of its spectrum, where gears leave little between their lines."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.signals.spectrum import hann

BAND = (0.8, 0.98)
"""Of the Nyquist frequency."""


def noise_floor(x: Array) -> Array:
    """Variance that white noise of the level found between the highest lines would have over all frequencies.

    Periodogram under a Hann window; its bins are exponentially distributed, so that noise of power density p has the
    median p ln 2. Lines, which are few bins, don't move the median. Zero for constants. Noise that isn't white, or was
    low-passed below BAND, isn't seen; motion that reaches up to there counts as noise.

    Args:
        x: (samples, channels), equally spaced.

    Returns:
        (channels,), squared unit of x.
    """
    window = hann(len(x))[:, None]
    power = np.abs(np.fft.rfft((x - x.mean(axis=0)) * window, axis=0)) ** 2
    low, high = (round(share * (len(power) - 1)) for share in BAND)
    floor: Array = np.median(power[low:high], axis=0) / (np.log(2.0) * np.sum(window**2))
    return floor
