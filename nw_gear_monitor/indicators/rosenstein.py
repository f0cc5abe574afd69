"""Largest Lyapunov exponent after Rosenstein, Collins and De Luca (Physica D 65 (1993) 117-134)."""

from __future__ import annotations

import numba
import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.divergence import Divergence, fitted
from nw_gear_monitor.indicators.embedding import of_order_one
from nw_gear_monitor.indicators.embedding import points as checked_points
from nw_gear_monitor.indicators.neighbours import Whole, nearest
from nw_gear_monitor.signals import checked

GOLDEN = 0.6180339887498949
_GROUP = 8
_LEAST_SQUARE = 1e-36  # eight of them are a normal number


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _small(square: Array, sums: Array, counts: Whole) -> None:
    """Take distances that a product can't hold out of it: zeros aren't counted, others get a logarithm of their own."""
    for k in range(square.size):
        if square[k] == 0.0:
            counts[k] -= 1
            square[k] = 1.0
        elif square[k] < _LEAST_SQUARE:
            sums[k] += np.log(square[k])
            square[k] = 1.0


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _logarithms(columns: Array, pairs: Whole, steps: int) -> tuple[Array, Whole]:
    """Sum of the logarithms of squared distances of pairs after 0, 1, .. steps, and how many weren't zero.

    Eight distances are multiplied before a logarithm is taken. Coordinates are of the order of 1.
    """
    sums = np.zeros(steps)
    counts = np.zeros(steps, dtype=np.int64)
    product = np.ones(steps)
    square = np.empty(steps)
    held = 0
    for number in range(pairs.shape[0]):
        i, j = pairs[number]
        square[:] = 0.0
        for c in range(columns.shape[0]):
            a, b = columns[c, i : i + steps], columns[c, j : j + steps]
            for k in range(steps):
                gap = a[k] - b[k]
                square[k] += gap * gap
        small = 0
        for k in range(steps):
            small += square[k] < _LEAST_SQUARE
        if small:
            _small(square, sums, counts)
        for k in range(steps):
            product[k] *= square[k]
        held += 1
        if held == _GROUP or number == pairs.shape[0] - 1:
            for k in range(steps):
                sums[k] += np.log(product[k])
                product[k] = 1.0
            held = 0
    return sums, counts + pairs.shape[0]


def _mean_logarithm(columns: Array, pairs: Whole, steps: int) -> Array:
    sums, counts = _logarithms(columns, pairs, steps)
    if not counts.all():
        raise InputError("points", "neighbours at a distance", "an orbit that repeats itself exactly")
    curve: Array = 0.5 * sums / counts
    return curve


def rosenstein(
    points: Array,
    *,
    theiler: int,
    horizon: int,
    rate: float = 1.0,
    fit: tuple[int, int] | None = None,
    references: int | None = None,
) -> Divergence:
    """Largest exponent by the mean logarithmic distance of nearest neighbours.

    curve(k) = mean over i of ln |P(i + k) - P(j(i) + k)|, where j(i) is the nearest neighbour of i with
    |i - j| > theiler; the exponent is its slope before it saturates. Distances of zero are left out.

    It holds where the data are deterministic and noise is 40 dB or more below them; noise alone gives a slope as well,
    so look at `Divergence.exponential`, and don't ask before it is known that the motion isn't periodic. With 4096
    samples expect errors of 5 % for maps and 30 % for flows; for a flow it is better to look at the curve and give
    `fit`.

    Args:
        points: (points, coordinates), of `embed` or `strobed`.
        theiler: neighbours closer in time than this are left out; one mean period at least (`mean_period`).
        horizon: steps for which pairs are followed.
        rate: steps per unit time, for the unit of the result.
        fit: first and last step of the line; None finds the range before saturation.
        references: number of points, spread evenly, whose neighbours are followed; None takes all.

    Returns:
        The exponent in nats per unit time, its curve and the quality of its line.

    Raises:
        InputError: a value that isn't finite, a constant, an orbit that repeats itself exactly, too few points for the
            window and the horizon, a setting that isn't possible.
    """
    theiler, horizon = checked.whole("theiler", theiler, 0), checked.whole("horizon", horizon, 2)
    rate = checked.positive("rate", rate)
    values = checked_points("points", points, horizon + 2 * theiler + 2)
    size = len(values) - horizon
    wanted = size if references is None else min(checked.whole("references", references, 1), size)
    chosen = np.arange(wanted, dtype=np.int64) * size // wanted
    values, doublings = of_order_one(values)
    columns = np.ascontiguousarray(values.T)
    pairs = np.column_stack([chosen, nearest(values[:size], chosen, theiler)])
    anywhere = (np.mod(GOLDEN * np.arange(1, wanted + 1), 1.0) * size).astype(np.int64)
    offset = doublings * np.log(2.0)
    curve = _mean_logarithm(columns, pairs, horizon + 1) + offset
    saturation = float(_mean_logarithm(columns, np.column_stack([chosen, anywhere]), 1)[0]) + offset
    return fitted(curve, saturation, wanted, rate, fit)
