"""Lines in the envelope of a band, and at multiples of a shaft's speed, at constant speed (for others: orders)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter
from scipy.signal import argrelmax

from nw_gear_common.tables import Array
from nw_gear_monitor.signals.envelope import edge, envelope
from nw_gear_monitor.signals.spectrum import hann

AROUND = 64
"""Bins on either side whose median is the floor."""
PROMINENT = 5.0
"""A line this many times above the floor is more than chance: see docs/indicators.md."""
LEAST_SHARE = 0.01
"""Of the strongest line, which a line has to have; side lobes of the window are smaller."""
MOST = 20
LOWEST = 3
"""First bin that may be a line; those before hold what is left of the mean."""
HARMONICS = 3
SLIP = 0.02
"""A line of a bearing lies within this share of its order on either side."""


@dataclass(frozen=True)
class Line:
    """A line.

    Attributes:
        hz: where it is; amplitude: in the unit of the signal; prominence: over the median of the bins around.
        order: of the shaft that it was looked for at, its harmonic included; None where it was just found.
    """

    hz: float
    amplitude: float
    prominence: float
    order: float | None = None


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Amplitudes over frequency (Hz), bins `step` apart from 0, with the floor around each bin."""

    amplitude: Array
    floor: Array
    step: float


def envelope_spectrum(x: Array, rate: float, band: tuple[float, float]) -> Spectrum:
    """Spectrum of the magnitude of the analytic signal of a band, its ringing ends cut off.

    A (1 + m cos 2 pi f t) times a carrier in the band reads m A at f.

    Raises:
        InputError: see `signals.envelope.envelope`.
    """
    cut = edge(rate, band)
    outline = envelope(x, rate, band)[cut:-cut]
    window = hann(outline.size)
    amplitude = 2.0 * np.abs(np.fft.rfft(window * (outline - outline.mean()))) / float(window.sum())
    floor = median_filter(amplitude, 2 * AROUND + 1, mode="nearest")
    return Spectrum(amplitude, np.maximum(floor, 1e-12 * float(np.max(amplitude))), rate / outline.size)


def peaks(spectrum: Spectrum) -> tuple[Line, ...]:
    """The lines that stand out, strongest first, MOST at most; placed between bins by the shape of the window."""
    amplitude = spectrum.amplitude
    (found,) = argrelmax(amplitude, order=4)
    found = found[(found >= LOWEST) & (amplitude[found] >= PROMINENT * spectrum.floor[found])]
    if not found.size:
        return ()
    found = found[amplitude[found] >= LEAST_SHARE * float(np.max(amplitude[found]))]
    lines = [_between(spectrum, int(k)) for k in found]
    return tuple(sorted(lines, key=lambda line: -line.amplitude)[:MOST])


def _between(spectrum: Spectrum, k: int) -> Line:
    """Peak of a Hann window by the larger neighbour: offset (2 a - 1) / (a + 1), a their ratio."""
    before, top, after = spectrum.amplitude[k - 1 : k + 2]
    ratio = max(before, after) / top
    offset = min(max((2.0 * ratio - 1.0) / (ratio + 1.0), 0.0), 0.5)
    gain = float(np.sinc(offset)) / (1.0 - offset * offset)
    place = k + (offset if after > before else -offset)
    return Line(place * spectrum.step, float(top) / gain, float(top / spectrum.floor[k]))


def bearing_lines(spectrum: Spectrum, shaft_rate: float, orders: Sequence[float]) -> tuple[Line, ...]:
    """The largest amplitude within the slip of each order and of two multiples, as far as the spectrum goes."""
    lines = []
    for order in (k * order for order in orders for k in range(1, HARMONICS + 1)):
        wanted = order * shaft_rate / spectrum.step
        low, high = int(min(wanted * (1.0 - SLIP), wanted - 1.0)), int(max(wanted * (1.0 + SLIP), wanted + 1.0)) + 2
        if low < LOWEST - 1 or high > spectrum.amplitude.size:
            continue
        k = low + int(np.argmax(spectrum.amplitude[low:high]))
        amplitude = float(spectrum.amplitude[k])
        lines.append(Line(k * spectrum.step, amplitude, amplitude / float(spectrum.floor[k]), order))
    return tuple(lines)


def shaft_lines(x: Array, rate: float, shaft_rate: float) -> tuple[Line, ...]:
    """Amplitudes of the signal itself at the first multiples of a shaft's speed (Hann window; no floor is taken)."""
    window = hann(x.size)
    weighted = window * (x - x.mean()) / float(window.sum())
    moments = np.arange(x.size) / rate
    lines = []
    for k in range(1, HARMONICS + 1):
        if k * shaft_rate < 0.5 * rate:
            turn = np.exp(-2j * np.pi * k * shaft_rate * moments)
            lines.append(Line(k * shaft_rate, float(2.0 * np.abs(weighted @ turn)), float("nan"), float(k)))
    return tuple(lines)
