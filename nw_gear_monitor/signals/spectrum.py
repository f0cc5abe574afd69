"""Amplitude spectra over time and over mesh order.

Both use a Hann window and divide by its sum, so that a line of amplitude A that falls on a bin reads A; between two
bins it reads up to 15 % less (scalloping). Lines at known orders: see `indicators.mesh_harmonics`.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.signals.hermite import crossings, values

ORDER_CYCLES = 256
"""Mesh cycles in one order spectrum; the step of the common grid is 1/256 of a mesh order."""
HIGHEST_ORDER = 8
LEAST_CYCLES = 16
"""With fewer cycles than this an order spectrum says nothing."""


@lru_cache(maxsize=32)
def hann(size: int) -> Array:
    """Periodic Hann window, shape (size,); kept for the next call, so it can't be written to."""
    window: Array = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(size) / size)
    window.flags.writeable = False
    return window


def amplitude_spectrum(x: Array, rate: float) -> tuple[Array, Array]:
    """One-sided amplitude spectrum.

    Args:
        x: (samples, channels), any unit; the mean is taken out.
        rate: samples per second, Hz.

    Returns:
        frequency (bins,) in Hz from 0 to rate/2, and amplitude (bins, channels) in the unit of x:
        |2 sum w x exp(-i 2 pi f t)| / sum w.
    """
    window = hann(len(x))
    amplitude = 2.0 * np.abs(np.fft.rfft((x - x.mean(axis=0)) * window[:, None], axis=0)) / window.sum()
    return np.arange(len(amplitude)) * rate / len(x), amplitude


def orders() -> Array:
    """The grid of mesh orders that all meshes share, shape (HIGHEST_ORDER * ORDER_CYCLES + 1,)."""
    return np.arange(HIGHEST_ORDER * ORDER_CYCLES + 1) / ORDER_CYCLES


def order_spectrum(phase: Array, x: Array, v: Array, step: float) -> Array:
    """Amplitude against mesh order: the signal is resampled to equal steps of phase, then transformed.

    Segments of ORDER_CYCLES whole mesh cycles, half overlapped and counted back from the newest sample, are averaged in
    power. Where there are fewer cycles, the ones there are padded with zeros: the grid stays, the lines get wider.

    Args:
        phase: (samples,) unwrapped mesh phase, rad, increasing.
        x, v: (samples, channels) displacement (m) and velocity (m/s).
        step: sample interval, s.

    Returns:
        (orders, channels) in m; NaN with fewer than LEAST_CYCLES cycles.
    """
    whole = int((phase[-1] - phase[0]) / (2.0 * np.pi))
    cycles = min(whole, ORDER_CYCLES)
    grid = HIGHEST_ORDER * ORDER_CYCLES + 1
    if cycles < LEAST_CYCLES:
        return np.full((grid, x.shape[1]), np.nan)
    per_cycle = _points_per_cycle(phase)
    hop = max(cycles // 2, 1)
    segments = 1 + (whole - cycles) // hop
    total = cycles + hop * (segments - 1)
    targets = phase[-1] - 2.0 * np.pi * np.arange(total * per_cycle, 0, -1) / per_cycle
    resampled = values(crossings(phase, targets), x, v, step)
    window = hann(cycles * per_cycle)[:, None]
    power = np.zeros((grid, x.shape[1]))
    for segment in range(segments):
        piece = resampled[segment * hop * per_cycle : (segment * hop + cycles) * per_cycle]
        spectrum = np.fft.rfft((piece - piece.mean(axis=0)) * window, n=ORDER_CYCLES * per_cycle, axis=0)[:grid]
        power += np.abs(2.0 * spectrum / window.sum()) ** 2
    return np.sqrt(power / segments)


def _points_per_cycle(phase: Array) -> int:
    """The power of two that keeps every sample's information and reaches HIGHEST_ORDER."""
    samples_per_cycle = 2.0 * np.pi * (phase.size - 1) / (phase[-1] - phase[0])
    return int(2 ** np.ceil(np.log2(max(samples_per_cycle, 2.0 * HIGHEST_ORDER))))
