"""Entropies and recurrence of a mesh's strobed section: one point (x, v) per mesh cycle, never an average over turns.

A time-synchronous average over a shaft with an odd number of teeth cancels f_m/2 and with it period doubling; these
numbers are made from the points themselves. Slow changes (load, wind) are taken out by a running mean.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.correlation_dimension import correlation_dimension
from nw_gear_monitor.indicators.dispersion_entropy import dispersion_entropy
from nw_gear_monitor.indicators.embedding import strobed
from nw_gear_monitor.indicators.permutation_entropy import permutation_entropy
from nw_gear_monitor.indicators.recurrence import recurrence
from nw_gear_monitor.indicators.sample_entropy import sample_entropy
from nw_gear_monitor.indicators.window import Column, Indicator, MeshWindow

TREND = 33
"""Cycles of the running mean that is taken out; twice the longest period that is looked for, and one."""
LEAST = 256
MOST = 1000
"""Cycles that are looked at, without those lost to the running mean."""
LEAST_SPREAD = 1e-3
"""A section narrower than this share of the motion is one point: what is left of it is interpolation and noise."""
RADIUS = 0.2
"""Of recurrence, in standard deviations of either coordinate."""
THEILER = 1


def detrended(points: Array) -> Array:
    """Points without their running mean over TREND of them.

    Args:
        points: (points, coordinates).

    Returns:
        (points - TREND + 1, coordinates).
    """
    sums = np.cumsum(np.concatenate([np.zeros((1, points.shape[1])), points - points[0]]), axis=0)
    half = TREND // 2
    mean = (sums[TREND:] - sums[:-TREND]) / TREND
    rest: Array = points[half : len(points) - half] - points[0] - mean
    return rest


def strobed_motion(strobes: Array, deviation: tuple[float, float]) -> tuple[float, ...]:
    """Entropies and recurrence of a section.

    Args:
        strobes: (points, 2) x and v once per mesh cycle, m and m/s; the newest MOST + TREND - 1 count.
        deviation: standard deviations of x and v over all phases, m and m/s.

    Returns:
        One number per column of INDICATOR, recurrence and dimension from x alone where v is a single value; NaN with
        fewer than LEAST points, for a section that is a single point (see LEAST_SPREAD), and for a quantity that isn't
        defined.
    """
    nothing = (math.nan,) * len(INDICATOR.columns)
    if len(strobes) < LEAST + TREND - 1:
        return nothing
    rest = detrended(strobes[-(MOST + TREND - 1) :])
    wide = [float(np.std(c)) > LEAST_SPREAD * whole for c, whole in zip(rest.T, deviation, strict=True)]
    x = rest[:, 0]
    if not wide[0]:
        return nothing
    points = strobed(x, rest[:, 1]) if wide[1] else x[:, None] / float(np.std(x))
    entropies = [_defined(lambda: permutation_entropy(x)), _defined(lambda: sample_entropy(x))]
    entropies.append(_defined(lambda: dispersion_entropy(x)))
    dimension = _defined(lambda: correlation_dimension(points, theiler=THEILER).dimension)
    try:
        found = recurrence(points, radius=RADIUS, theiler=THEILER)
    except InputError:
        return (*entropies, math.nan, math.nan, math.nan, math.nan, dimension)
    return (*entropies, found.rate, found.determinism, found.laminarity, found.entropy, dimension)


def _defined(compute: Callable[[], float]) -> float:
    try:
        return compute()
    except InputError:
        return math.nan


def _compute(window: MeshWindow) -> tuple[float, ...]:
    if window.strobes is None:
        return (math.nan,) * len(INDICATOR.columns)
    return strobed_motion(window.strobes, (float(np.std(window.x)), float(np.std(window.v))))


INDICATOR = Indicator(
    (
        Column("permutation_entropy", "bit", "of the strobed displacement, order 3; log2 6 for noise"),
        Column("sample_entropy", "", "of the strobed displacement, m = 2, r = 0.2 sd (nats); 2.19 for noise"),
        Column("dispersion_entropy", "", "of the strobed displacement, 6 classes of 2 (nats); 3.58 for noise"),
        Column("recurrence_rate", "", "share of the pairs of section points within 0.2 sd (RR)"),
        Column("determinism", "", "share of those in diagonal lines of two or more (DET); 1 - (1 - RR)^2 for noise"),
        Column("laminarity", "", "share of those in vertical lines of two or more (LAM)"),
        Column("diagonal_entropy", "", "entropy of the lengths of the diagonal lines (ENTR, nats)"),
        Column("correlation_dimension", "", "of the section points; a trend indicator only"),
    ),
    _compute,
)
