"""Spectrum of a band's envelope over shaft orders, by transforms: what a monitor can afford every second.

The same quantity as `envelope.envelope_spectrum`, for low orders only. A band's bins, moved to zero and transformed
back, are its complex envelope; the magnitude is low-passed and thinned in the same way before it is resampled to phase.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.fft import irfft, next_fast_len, rfft

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked
from nw_gear_monitor.signals.envelope import LEAST_TURNS, OrderSpectrum
from nw_gear_monitor.signals.resample import whole_turns
from nw_gear_monitor.signals.spectrum import hann

SLOPE = 0.1
"""Share of the band's width over which either edge rises, as half a cosine."""
EDGE_PERIODS = 3.0
"""Periods of such an edge's width that are cut off at either end of the record, where the filter rings."""
POINTS_PER_CYCLE = 8.0
"""Of the highest order that is wanted, in the thinned envelope."""
LOW_PASS = (1.5, 3.0)
"""The envelope is kept up to so many times the highest order and gone at so many."""


def band_envelope(x: Array, rate: float, band: tuple[float, float]) -> tuple[Array, float]:
    """Magnitude of the complex envelope of a band, at twice the band's width or a little more.

    Args:
        x: (samples,) any unit.
        rate: samples per second, Hz.
        band: low and high limit, Hz, at which half of the amplitude is left.

    Returns:
        (points,) in the unit of x (A for a line of amplitude A), evenly over the record's length, first point at the
        first sample; and points per second. At either end `edge` seconds ring.

    Raises:
        InputError: a signal, rate or band that can't be used, nothing in the band.
    """
    rate = checked.positive("rate", rate)
    low, high = checked.band("band", band, rate)
    x = checked.signal("x", x, 64)
    spectrum = rfft(x - x.mean())
    step = rate / x.size
    slope = SLOPE * (high - low)
    frequency = step * np.arange(spectrum.size)
    gain = _ramp((frequency - low) / slope + 0.5) * _ramp((high - frequency) / slope + 0.5)
    bins = np.flatnonzero(gain)
    chosen = spectrum[bins] * gain[bins]
    if not np.sum(np.abs(chosen) ** 2) > checked.LEAST_SPREAD**2 * np.sum(np.abs(spectrum) ** 2):
        raise InputError("x", f"vibration between {low:.6g} and {high:.6g} Hz", "nothing but rounding")
    points = next_fast_len(2 * bins.size)
    outline = np.abs(np.fft.ifft(chosen, points)) * (2.0 * points / x.size)
    return np.asarray(outline, dtype=np.float64), rate * points / x.size


def edge(band: tuple[float, float]) -> float:
    """Seconds at either end of a band's envelope that aren't to be used."""
    return EDGE_PERIODS / (SLOPE * (band[1] - band[0]))


def low_order_spectrum(x: Array, rate: float, phase: Array, band: tuple[float, float], highest: float) -> OrderSpectrum:
    """Spectrum of a band's envelope over the orders of a shaft, up to some order.

    Args:
        x: (samples,) any unit, sampled at equal steps of time.
        rate: samples per second, Hz.
        phase: (samples,) unwrapped phase of the shaft, rad.
        band: low and high limit, Hz.
        highest: order up to which the spectrum is right.

    Raises:
        InputError: see `band_envelope` and `whole_turns`; fewer than LEAST_TURNS whole turns.
    """
    phase = checked.phase("phase", phase, len(x))
    outline, fast = band_envelope(x, rate, band)
    seconds = len(x) / rate
    fastest = highest * float(np.max(np.diff(phase))) * rate / (2.0 * np.pi)
    outline, slow = _thinned(outline, fast, LOW_PASS[0] * fastest, LOW_PASS[1] * fastest, POINTS_PER_CYCLE * fastest)
    time = np.arange(outline.size) / slow
    used = (time >= edge(band)) & (time <= min(seconds - edge(band), (len(x) - 1) / rate))
    at = np.interp(time[used] * rate, np.arange(len(x)), phase)
    turns = whole_turns(at, outline[used], least=LEAST_TURNS)
    deviation = turns.flat - turns.flat.mean()
    window = hann(deviation.size)
    amplitude = 2.0 * np.abs(rfft(window * deviation)) / float(window.sum())
    order = np.arange(amplitude.size) / turns.turns
    kept = order <= highest
    return OrderSpectrum(order[kept], amplitude[kept], turns.turns)


def _thinned(x: Array, rate: float, full: float, gone: float, wanted: float) -> tuple[Array, float]:
    """Low-pass by the transform and keep at least `wanted` points per second; frequencies in Hz."""
    if wanted >= rate:
        return x, rate
    spectrum = rfft(x)
    frequency = np.arange(spectrum.size) * rate / x.size
    points = next_fast_len(int(np.ceil(wanted * x.size / rate)), real=True)
    kept = spectrum[: points // 2 + 1] * _ramp((gone - frequency[: points // 2 + 1]) / (gone - full))
    return np.asarray(irfft(kept, points), dtype=np.float64) * (points / x.size), rate * points / x.size


def _ramp(u: npt.NDArray[np.float64]) -> Array:
    """0 below 0, 1 above 1, half a cosine between."""
    rise: Array = 0.5 - 0.5 * np.cos(np.pi * np.clip(u, 0.0, 1.0))
    return rise
