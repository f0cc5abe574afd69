"""Fewer samples for the line fit where the waveform comes faster than it needs."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array

WANTED_RATE = 5120.0
"""Samples per second that carry every line below 2.5 kHz (Hz)."""
TAPS_PER_STEP = 20
"""Half length of the filter, in output samples."""


def factor(rate: float) -> int:
    """How many samples become one: the largest whole number that keeps at least WANTED_RATE; 1 below twice of it."""
    return max(int(rate / WANTED_RATE + 1e-9), 1)


def half_length(every: int) -> int:
    """Input samples that the filter needs on either side of an output sample."""
    return TAPS_PER_STEP * every if every > 1 else 0


def low_pass(every: int) -> Array:
    """Windowed sinc (Kaiser, beta 8, 80 dB) with unit gain at 0 and half gain at 0.42 of the output rate."""
    n = np.arange(-half_length(every), half_length(every) + 1)
    kernel = np.sinc(2.0 * 0.42 * n / every) * np.kaiser(n.size, 8.0)
    result: Array = kernel / kernel.sum()
    return result


def decimate(x: Array, every: int) -> Array:
    """Low-pass and keep every `every`-th sample.

    Args:
        x: (samples, channels).
        every: factor, 1 = unchanged.

    Returns:
        (outputs, channels); output k belongs to input sample half_length + k * every, so that no output looks beyond
        the ends of `x`.
    """
    if every == 1:
        return x
    kernel = low_pass(every)
    outputs = (len(x) - kernel.size) // every + 1
    if outputs < 1:
        return np.empty((0, x.shape[1]))
    windows = np.lib.stride_tricks.sliding_window_view(x, kernel.size, axis=0)[::every][:outputs]
    result: Array = np.ascontiguousarray(windows @ kernel)
    return result
