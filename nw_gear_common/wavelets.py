"""Amplitude over time and frequency by the continuous wavelet transform with complex Morlet wavelets (PyWavelets)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pywt

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array

BANDWIDTH = 8.0
"""B of the wavelet exp(-t^2/B) exp(2 pi i t) / sqrt(pi B) at scale 1: about four cycles on either side."""


@dataclass(frozen=True, eq=False)
class WaveletMap:
    """Amplitude of a signal over time and frequency.

    Attributes:
        time: centre of each column, s after the first sample, shape (columns,).
        frequency: of each line, Hz, ascending in equal ratios, shape (lines,).
        amplitude: largest in the column's time, shape (lines, columns), in the unit of the signal: a sine has its own.
        edge: s from either end within which a line misses a part of its wavelet, shape (lines,).
    """

    time: Array
    frequency: Array
    amplitude: Array
    edge: Array


def wavelet_map(x: Array, rate: float, *, low: float, high: float, lines: int = 96, columns: int = 600) -> WaveletMap:
    """Transform a signal.

    The amplitude is 2 |W(a, t)| / sqrt(a) with a = rate / f, W the transform as PyWavelets normalises it: a sine of
    amplitude A gives A at its frequency, and half of it on lines that are 100 sqrt(ln 2 / B) / pi = 9 % away. The
    wavelet is down to half at sqrt(B ln 2) = 2.4 cycles from its middle: nearer to an end amplitudes are too small.
    Source: Mallat, A Wavelet Tour of Signal Processing, 3rd ed., sec. 4.3.

    Args:
        x: the signal, shape (n,), without its mean where that is large.
        rate: samples per second, Hz.
        low, high: lowest and highest frequency, Hz.
        lines: how many frequencies.
        columns: how many times at most.

    Raises:
        InputError: the band isn't within (0, rate / 2), or there are fewer than 16 samples or NaN among them.
    """
    if not 0.0 < low < high <= 0.5 * rate:
        raise InputError("band of the wavelet map", f"0 < low < high <= {0.5 * rate:g} Hz", f"{low:g} to {high:g} Hz")
    if x.ndim != 1 or len(x) < 16 or not np.isfinite(x).all():
        raise InputError("signal of the wavelet map", "at least 16 finite samples", f"shape {x.shape}")
    frequency = np.geomspace(low, high, lines)
    scales = rate / frequency
    starts = np.linspace(0, len(x), min(columns, len(x)), endpoint=False).astype(np.int64)
    amplitude = np.empty((lines, len(starts)))
    for i, scale in enumerate(scales):  # line by line: all at once would hold lines x n complex numbers
        found, _ = pywt.cwt(x, [scale], f"cmor{BANDWIDTH}-1.0", method="fft", precision=12)
        amplitude[i] = np.maximum.reduceat(np.abs(found[0]), starts) * (2.0 / np.sqrt(scale))
    ends = np.append(starts[1:], len(x))
    edge = np.sqrt(BANDWIDTH * np.log(2.0)) / frequency
    return WaveletMap(0.5 * (starts + ends - 1) / rate, frequency, amplitude, edge)
