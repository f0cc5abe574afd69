"""In which band a signal is most impulsive: spectral kurtosis and the kurtogram."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.special import expit

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked
from nw_gear_monitor.signals.spectrum import hann

LEAST_SEGMENTS = 8
LEAST_VALUES = 128
"""Independent values of an envelope that its kurtosis is taken from."""
TAPER = 0.125
"""Share of a record, at either end, that the kurtogram fades in and out and doesn't look at."""
LEAST_ENERGY = 1e-20
"""A band with a smaller share of the energy is rounding and left out."""


@dataclass(frozen=True)
class Band:
    """One cell of a kurtogram.

    Attributes:
        low, high: Hz.
        kurtosis: <|y|^4> / <|y|^2>^2 - 2 of the band's complex envelope y: 0 for stationary noise, -1 for a steady
        tone.
        values: independent values of y.
    """

    low: float
    high: float
    kurtosis: float
    values: int

    @property
    def score(self) -> float:
        """Kurtosis over its standard deviation 2 / sqrt(values) for noise; below about 5 it is chance."""
        return 0.5 * self.kurtosis * float(np.sqrt(self.values))


def spectral_kurtosis(x: Array, rate: float, segment: int) -> tuple[Array, Array]:
    """Kurtosis of the short-time spectrum, frequency by frequency.

    SK(f) = <|X(t, f)|^4> / <|X(t, f)|^2>^2 - 2 over segments half overlapped under a Hann window: 0 for stationary
    normal noise, -1 for a steady tone, above 0 where energy comes in bursts. Source: Antoni, "The spectral kurtosis: a
    useful tool for characterising non-stationary signals", Mech. Syst. Signal Process. 20 (2006) 282-307. The segment
    must be longer than a burst and shorter than the time between two.

    Args:
        x: (samples,) any unit; its mean is taken out.
        rate: samples per second, Hz.
        segment: samples in a segment.

    Returns:
        frequency (bins,) in Hz and SK (bins,); the two bins at either end, which hold real numbers or the mean, aren't
        among them, nor are bins without energy.

    Raises:
        InputError: a signal, rate or segment that can't be used, fewer than LEAST_SEGMENTS segments.
    """
    rate, segment = checked.positive("rate", rate), checked.whole("segment", segment, 8)
    hop = segment // 2
    x = _scaled(checked.signal("x", x, segment + (LEAST_SEGMENTS - 1) * hop))
    pieces = np.lib.stride_tricks.sliding_window_view(x, segment)[::hop]
    power = np.abs(np.fft.rfft(pieces * hann(segment), axis=1)[:, 2 : (segment + 1) // 2 - 1]) ** 2
    mean = power.mean(axis=0)
    there = mean > LEAST_ENERGY * float(mean.sum())
    frequency = (2.0 + np.flatnonzero(there)) * rate / segment
    value: Array = np.mean(power[:, there] ** 2, axis=0) / mean[there] ** 2 - 2.0
    return frequency, value


def kurtogram(x: Array, rate: float, levels: int | None = None) -> tuple[Band, ...]:
    """Kurtosis of the envelope in halves, thirds, quarters, sixths, .. of the frequency range.

    Level k cuts 0 to rate/2 into 2^k bands, and between two of these levels into 3 * 2^(k-1). A band's complex envelope
    is the inverse transform of its bins, so that bands have sharp edges; its middle three quarters are used. The grid
    is that of Antoni, "Fast computation of the kurtogram for the detection of transient faults", Mech. Syst. Signal
    Process. 21 (2007) 108-124; there short filters take the place of the transform. Take steady lines out first (a band
    with a mesh line reads low).

    Args:
        x: (samples,) any unit; its mean is taken out.
        rate: samples per second, Hz.
        levels: the finest level k, at least 1; None: as fine as LEAST_VALUES values per band allow, at most 8.

    Returns:
        all bands, coarse before fine; bands without energy are left out. `most_impulsive` chooses one.

    Raises:
        InputError: a signal or rate that can't be used, more levels than LEAST_VALUES values per band allow.
    """
    rate = checked.positive("rate", rate)
    x = _scaled(checked.signal("x", x, 8 * LEAST_VALUES))
    # Without it the jump from the end of the record to its beginning is an impulse in every band that is quiet.
    spectrum = np.fft.rfft(x * _taper(x.size))
    finest = int(np.log2((1.0 - 2.0 * TAPER) * (spectrum.size - 1) / LEAST_VALUES))
    depth = min(finest, 8) if levels is None else checked.whole("levels", levels, 1)
    if depth > finest:
        raise InputError("levels", f"at most {finest} for {x.size} samples", str(levels))
    parts = sorted({2**k for k in range(depth + 1)} | {3 * 2 ** (k - 1) for k in range(1, depth)})
    total = float(np.sum(np.abs(spectrum) ** 2))
    bands = [band for number in parts for band in _cells(spectrum, number, rate / x.size, total)]
    return tuple(bands)


def most_impulsive(bands: tuple[Band, ...]) -> Band:
    """The band with the largest kurtosis; among equals the widest.

    Its `score` tells whether it is more than chance.

    Raises:
        InputError: no bands.
    """
    if not bands:
        raise InputError("bands", "at least one", "none")
    return max(bands, key=lambda band: band.kurtosis)


def _scaled(x: Array) -> Array:
    """The signal without its mean, at most 1 in size, so that fourth powers stay in range."""
    unit = x / float(np.max(np.abs(x)))
    deviation: Array = unit - unit.mean()
    return deviation / float(np.max(np.abs(deviation)))


def _taper(size: int) -> Array:
    """1 in the middle, and towards both ends a fall to 0 that has all derivatives (Planck taper)."""
    u = np.clip((np.arange(size) + 0.5) / (TAPER * size), 0.0, 1.0)
    rise = np.ones(size)
    inside = u < 1.0
    rise[inside] = expit(1.0 / (1.0 - u[inside]) - 1.0 / u[inside])
    taper: Array = rise * rise[::-1]
    return taper


def _cells(spectrum: npt.NDArray[np.complex128], number: int, step: float, total: float) -> list[Band]:
    """The bands of one level; `step` is the distance of two bins, Hz."""
    edges = np.rint(np.linspace(0, spectrum.size - 1, number + 1)).astype(int)
    cells = []
    for low, high in pairwise(edges):
        bins = spectrum[low:high]
        if float(np.sum(np.abs(bins) ** 2)) <= LEAST_ENERGY * total:
            continue
        cut = int(np.ceil(TAPER * bins.size))
        power = np.abs(np.fft.ifft(bins)[cut : bins.size - cut]) ** 2
        power /= power.mean()
        cells.append(Band(float(low * step), float(high * step), float(np.mean(power**2)) - 2.0, power.size))
    return cells
