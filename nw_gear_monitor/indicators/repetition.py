"""Whether a vibration repeats after a common period of all meshes: a check on rho that fits nothing.

r = mean [x(phi + Phi) - x(phi)]^2 / (2 mean x^2), slow changes taken out of both. Phi is the shortest common period of
the mesh lines (`common_period`); in the built-in gearbox five turns of the sun: 53.01, 200 and 655 mesh cycles.
0 for a motion that repeats, 1 for one that has forgotten itself; white noise adds its share of the variance. The shift
is one of phase, not of time, so that speed may change. Motion of period 2 or 4 repeats after 200 cycles as well: r
tells regular from irregular motion, not one period from another.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from nw_gear_common.tables import Array
from nw_gear_monitor.signals.hermite import crossings, values

TOLERANCE = 0.02
"""Cycles by which a mesh may miss a whole number after the common period: r of a single line is then 0.008."""
MOST_CYCLES = 1000
"""Of the second slowest mesh, within which a common period is looked for."""
LEAST_CYCLES = 12
"""Shortest period that counts, in cycles of the slowest mesh: one that repeats after a few says little."""
DEGREE = 15
"""Of the polynomial in time that is taken out of every second, as in the line fit: changes up to about 5 Hz."""
EVERY = 2
"""One of so many samples is compared with the earlier motion; variances need no more."""


def common_period(frequency: Array) -> float:
    """Cycles of the first mesh after which all have made nearly whole numbers of cycles; NaN where there's none.

    Args:
        frequency: (stages,) mesh frequencies that keep their ratios, any unit.
    """
    slowest = float(np.min(frequency))
    reference = float(np.sort(frequency)[min(1, frequency.size - 1)])
    cycles = np.outer(np.arange(1, MOST_CYCLES + 1) / reference, frequency)
    misses = np.max(np.abs(cycles - np.round(cycles)), axis=1)
    enough = cycles[:, int(np.argmin(frequency))] >= LEAST_CYCLES - 0.5
    found = np.flatnonzero((misses < TOLERANCE) & enough)
    return float((found[0] + 1) / reference * frequency[0]) if found.size and slowest > 0.0 else float("nan")


def detrended(x: Array) -> Array:
    """A second of channels, (samples, channels), without a polynomial of DEGREE in time."""
    trend = _trend(len(x))
    left: Array = x - trend @ (trend.T @ x)
    return left


@lru_cache(maxsize=8)
def _trend(size: int) -> Array:
    orthonormal: Array = np.linalg.qr(legendre.legvander(np.linspace(-1.0, 1.0, size), DEGREE))[0]
    orthonormal.flags.writeable = False
    return orthonormal


def change_after(phase: Array, x: Array, v: Array, newest: int, shift: float, rate: float) -> Array | None:
    """How far the newest samples are from what was there one common period before.

    Args:
        phase: (samples,) phase that drives everything, rad, increasing.
        x, v: (samples, channels) m, m/s.
        newest: how many of the samples at the end are compared.
        shift: common period, rad.
        rate: samples per second, Hz.

    Returns:
        mean (x(phi) - x(phi - shift))^2, (channels,), m^2, without slow changes; r is half of it over the variance.
        None where the samples don't reach back so far.
    """
    rows = np.arange(len(phase) - newest, len(phase), EVERY)
    targets = phase[rows] - shift
    if not targets[0] >= phase[1]:
        return None
    before = values(crossings(phase, targets), x, v, 1.0 / rate)
    change: Array = np.mean(detrended(x[rows] - before) ** 2, axis=0)
    return change
