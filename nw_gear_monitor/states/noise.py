"""How noisy a signal is, from itself: the floor of its spectrum, the scatter about its folded waveform."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.states.cycles import TURN

BANDS = 32
LEAST_BIN = 200
LOWEST = 0.3
"""Lowest band looked at, as a share of half the sample rate."""
STEPS = 64
"""A signal of fewer different values than this share of its samples is quantised."""


def floor(values: Array) -> float:
    """Standard deviation of the white noise in samples: the quietest band of the upper spectrum.

    In each of up to BANDS bands the median of the periodogram (Hann window) over ln 2 is the level of the noise,
    however many lines stand in it; the least of them is taken. A signal that fills every band (a map, fast chaos
    sampled coarsely) reads too high: this is an upper limit.

    Args:
        values: (samples,) at equal steps, any unit.
    """
    window = np.hanning(values.size)
    power = np.abs(np.fft.rfft((values - values.mean()) * window)) ** 2 / np.sum(window**2)
    upper = power[int(LOWEST * power.size) : -2]
    bands = max(min(BANDS, upper.size // LEAST_BIN), 1)
    return float(np.sqrt(min(np.median(band) for band in np.array_split(upper, bands)) / np.log(2.0)))


def scatter(values: Array, phase: Array, period: int) -> float:
    """Standard deviation of samples about a waveform of `period` cycles, however steep it is.

    Half the mean square step between neighbours in folded phase; what isn't periodic counts as noise.

    Args:
        values: (samples,) any unit.
        phase: (samples,) rad, 2 pi a cycle.
        period: cycles to the waveform.
    """
    order = np.argsort(np.mod(phase, TURN * period), kind="stable")
    return float(np.sqrt(0.5 * np.mean(np.diff(values[order]) ** 2)))


def step(values: Array) -> float:
    """Step of a quantised signal, 0 for one that isn't: the least distance of its few different values."""
    different = np.unique(values)
    if different.size < 2 or different.size * STEPS > values.size * 4:
        return 0.0
    return float(np.min(np.diff(different)))


def decibels(noise: float) -> float:
    """20 log10(1 / noise): a level below a signal of standard deviation 1, infinite without noise."""
    return float(-20.0 * np.log10(noise)) if noise > 0.0 else float("inf")
