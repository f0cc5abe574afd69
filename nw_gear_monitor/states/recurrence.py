"""Recurrence period: lines of the strobed signal at multiples of 1/n, against the spectrum beside them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from nw_gear_common.tables import Array
from nw_gear_monitor.states.cycles import Record

LONGEST = 16
CHANCE = 1e-6
"""Probability that noise alone passes for a subharmonic, per period tried."""
LEAST_SPLITTING = 5e-3
"""Subharmonics below this share of the signal's standard deviation are no period."""
ENOUGH = 0.7
BESIDE = 14
ASIDE = 2
LEAST_REPEATS = 8
TAPERED = 2.0
"""A Hann window keeps two thirds of a line's power against the noise; the rest is leeway."""


@dataclass(frozen=True, eq=False)
class Recurrence:
    """Outcome of the search.

    Attributes:
        period: recurrence period in cycles.
        first: (cycles, points) less the waveform of one cycle.
        rest: (cycles, points) less the waveform of `period` cycles.
        strength: power of the weakest subharmonic accepted over what noise would pass with (infinite for period 1).
        refused: the same ratio of the strongest line that wasn't accepted.
    """

    period: int
    first: Array
    rest: Array
    strength: float
    refused: float


def recurrence(record: Record, resolution: float) -> Recurrence:
    """Find the recurrence period of a record.

    Starting from one cycle, the waveform of n cycles is taken out, and the rest is tested for lines at p/(n j), for
    every j: their power is compared with that of the spectrum beside them, which may be noise of any colour or chaos. n
    grows until no line is left, and is then replaced by the smallest divisor that leaves no line either.

    Args:
        record: the signal.
        resolution: a rest below this rms isn't looked into.
    """
    first = rest = record.without(1)
    period, refused = 1, 0.0
    while rms(rest) > resolution:
        longer, refused = _longer(rest, period)
        if not longer:
            break
        period = longer
        rest = record.without(period)
    strength = float("inf")
    for divisor in (d for d in range(1, period) if period % d == 0):
        left = first if divisor == 1 else record.without(divisor)
        ratio = _lines(left, _spectrum(left), _freedom(left), period, divisor)[1] if rms(left) > resolution else 0.0
        if ratio <= 1.0:
            return Recurrence(divisor, first, left, strength, max(ratio, refused))
        strength = min(strength, ratio)
    return Recurrence(period, first, rest, strength, refused)


def rms(rows: Array) -> float:
    """Root mean square of all points."""
    return float(np.sqrt(np.mean(rows**2)))


def _longer(rest: Array, period: int) -> tuple[int, float]:
    """The smallest multiple of a period that explains most of what any multiple does, 0 where none is significant.

    Beside it the largest ratio met.
    """
    spectrum, freedom = _spectrum(rest), _freedom(rest)
    found: list[tuple[int, float]] = []
    largest = 0.0
    for n in range(2 * period, min(LONGEST, len(rest) // LEAST_REPEATS) + 1, period):
        power, ratio = _lines(rest, spectrum, freedom, n, period)
        largest = max(largest, ratio)
        if ratio > 1.0:
            found.append((n, power))
    most = max((power for _, power in found), default=0.0)
    return next((n for n, power in found if power >= ENOUGH * most), 0), largest


def _lines(rest: Array, spectrum: Array, freedom: float, n: int, period: int) -> tuple[float, float]:
    """Sum of squares in the lines p/n that aren't lines of `period`, and its ratio to what chance allows.

    The ratio must hold in the window's taper as well: slow changes leak into every line of an untapered spectrum.
    """
    size, width = rest.shape
    power = _explained(rest, n) / width
    beside = _beside(spectrum, n, period, size)
    limit = float(chi2.isf(CHANCE, (n - period) * freedom)) / freedom * beside
    ratio = power / max(limit, size * LEAST_SPLITTING**2)
    if ratio > 1.0:
        ratio = min(ratio, TAPERED * _tapered(rest, n, period) / max(limit, 1e-300))
    return power, ratio


def _tapered(rest: Array, n: int, period: int) -> float:
    """Power of the same lines in the periodogram with Hann window."""
    size, width = rest.shape
    window = np.hanning(size)
    lines = np.array([p / n for p in range(1, n) if p * period % n])
    turns = np.exp(-2j * np.pi * np.outer(lines, np.arange(size))) * window
    return float(np.sum(np.abs(turns @ rest) ** 2) / np.sum(window**2) / width)


def _explained(rest: Array, n: int) -> float:
    """Sum of squares that the means of the groups k mod n explain."""
    return float(sum(len(rest[g::n]) * np.sum(rest[g::n].mean(axis=0) ** 2) for g in range(n)))


def _spectrum(rest: Array) -> Array:
    """Mean periodogram of the points of a cycle (Hann window); white noise reads as its variance."""
    window = np.hanning(len(rest))
    power = np.abs(np.fft.rfft(rest * window[:, None], axis=0)) ** 2
    return np.asarray(power.mean(axis=1) / np.sum(window**2))


def _beside(spectrum: Array, n: int, period: int, size: int) -> float:
    """Mean of the spectrum beside the lines p/n that aren't lines of `period`."""
    levels = []
    for p in range(1, n // 2 + 1):
        if p * period % n == 0:
            continue
        line = round(p * size / n)
        bins = np.arange(line - BESIDE, line + BESIDE + 1)
        bins = bins[(abs(bins - line) > ASIDE) & (bins > 0) & (bins < spectrum.size)]
        levels.append(float(spectrum[bins].mean()))
    return float(np.mean(levels))


def _freedom(rest: Array) -> float:
    """How many independent points a cycle has, (trace C)^2 / trace C^2 of the covariance of its points."""
    covariance = rest.T @ rest
    return max(float(np.trace(covariance) ** 2 / np.sum(covariance**2)), 1.0)
