"""Envelope of a band of a signal, and its spectrum over the orders of a shaft."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len
from scipy.signal import butter, hilbert, sosfiltfilt

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked
from nw_gear_monitor.signals.resample import whole_turns
from nw_gear_monitor.signals.spectrum import hann

FILTER_ORDER = 4
"""Of the Butterworth filter, which runs forth and back: twice this slope, no delay."""
EDGE_PERIODS = 3.0
"""Periods of the band's width that are cut off at either end, where the filter rings."""
LEAST_TURNS = 4


@dataclass(frozen=True, eq=False)
class OrderSpectrum:
    """Amplitudes over the orders of a shaft.

    Attributes:
        order: (bins,) multiples of the shaft's speed, from 0.
        amplitude: (bins,) in the unit of the signal; a line of amplitude A on a bin reads A.
        turns: turns in the record: lines closer than 2 / turns run together.
    """

    order: Array
    amplitude: Array
    turns: int


def envelope(x: Array, rate: float, band: tuple[float, float]) -> Array:
    """Magnitude of the analytic signal (Hilbert transform) of a band.

    Args:
        x: (samples,) any unit.
        rate: samples per second, Hz.
        band: low and high limit, Hz, at which half of the amplitude is left; low 0 gives a low-pass, high rate/2 a
            high-pass, and so does what is closer to them than one over the record's length.

    Returns:
        (samples,) in the unit of x; at either end, EDGE_PERIODS / (high - low) seconds long, the filter rings.

    Raises:
        InputError: a signal, rate or band that can't be used; a record shorter than four such ends; nothing in the
        band.
    """
    rate = checked.positive("rate", rate)
    low, high = checked.band("band", band, rate)
    x = checked.signal("x", x, max(64, 4 * edge(rate, (low, high))))
    filtered = _band_pass(x - x.mean(), rate, low, high)
    if float(np.std(filtered)) <= checked.LEAST_SPREAD * float(np.max(np.abs(x))):
        raise InputError("x", f"vibration between {low:.6g} and {high:.6g} Hz", "nothing but rounding")
    # Zeros behind the end: a fast length, and the transform doesn't wrap round.
    analytic = hilbert(filtered, N=next_fast_len(2 * x.size))[: x.size]
    return np.asarray(np.abs(analytic), dtype=np.float64)


def edge(rate: float, band: tuple[float, float]) -> int:
    """Samples at either end of an envelope that aren't to be used."""
    return int(np.ceil(EDGE_PERIODS * rate / (band[1] - band[0])))


def envelope_spectrum(x: Array, rate: float, phase: Array, band: tuple[float, float]) -> OrderSpectrum:
    """Spectrum of the envelope over the orders of a shaft.

    The band is chosen in Hz, since resonances don't follow the speed; the envelope is then resampled to equal steps of
    the shaft's phase and transformed with a Hann window, so that defect lines stay sharp while the speed changes. For
    A (1 + m cos q theta) times a carrier in the band it reads m A at order q. Source of the procedure: Randall and
    Antoni, "Rolling element bearing diagnostics - a tutorial", Mech. Syst. Signal Process. 25 (2011) 485-520, from
    memory.

    Args:
        x: (samples,) any unit, sampled at equal steps of time.
        rate: samples per second, Hz.
        phase: (samples,) unwrapped phase of the shaft, rad.
        band: low and high limit, Hz.

    Raises:
        InputError: see `envelope` and `whole_turns`; fewer than LEAST_TURNS whole turns.
    """
    outline = envelope(x, rate, band)
    phase = checked.phase("phase", phase, outline.size)
    cut = edge(rate, band)
    turns = whole_turns(phase[cut : outline.size - cut], outline[cut : outline.size - cut], least=LEAST_TURNS)
    deviation = turns.flat - turns.flat.mean()
    window = hann(deviation.size)
    amplitude = 2.0 * np.abs(np.fft.rfft(window * deviation)) / float(window.sum())
    return OrderSpectrum(np.arange(amplitude.size) / turns.turns, amplitude, turns.turns)


def _band_pass(x: Array, rate: float, low: float, high: float) -> Array:
    nyquist = 0.5 * rate
    bin_width = rate / x.size
    low = low if low >= bin_width else 0.0
    high = high if high <= nyquist - bin_width else nyquist
    if low == 0.0 and high == nyquist:
        return x
    if low == 0.0:
        sos = butter(FILTER_ORDER, high / nyquist, "lowpass", output="sos")
    elif high == nyquist:
        sos = butter(FILTER_ORDER, low / nyquist, "highpass", output="sos")
    else:
        sos = butter(FILTER_ORDER, (low / nyquist, high / nyquist), "bandpass", output="sos")
    return np.asarray(sosfiltfilt(sos, x), dtype=np.float64)
