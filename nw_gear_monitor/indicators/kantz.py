"""Largest Lyapunov exponent after Kantz (Physics Letters A 185 (1994) 77-87)."""

from __future__ import annotations

import numba
import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.divergence import Divergence, fitted
from nw_gear_monitor.indicators.embedding import of_order_one
from nw_gear_monitor.indicators.embedding import points as checked_points
from nw_gear_monitor.indicators.neighbours import Whole
from nw_gear_monitor.signals import checked

LEAST_NEIGHBOURS = 5
"""A point with fewer neighbours doesn't count: a mean over them would be one over chance."""
GOLDEN = 0.6180339887498949


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _add_distances(columns: Array, i: int, j: int, square: Array, sums: Array) -> None:
    """Add the distances of i and j after 0, 1, .. steps to `sums`; `square` is a place to work in."""
    steps = sums.size
    square[:] = 0.0
    for c in range(columns.shape[0]):
        a, b = columns[c, i : i + steps], columns[c, j : j + steps]
        for k in range(steps):
            gap = a[k] - b[k]
            square[k] += gap * gap
    for k in range(steps):
        sums[k] += np.sqrt(square[k])


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _within(columns: Array, i: int, j: int, radius: float) -> bool:
    total = 0.0
    for c in range(columns.shape[0]):
        gap = columns[c, i] - columns[c, j]
        total += gap * gap
    return total <= radius * radius


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _curve(
    columns: Array, order: Whole, references: Whole, radius: float, window: int, most: int, steps: int
) -> tuple[Array, int]:
    """Sum over points of the logarithm of the mean distance of their neighbours, and how many points had enough.

    Args:
        columns: (coordinates, points).
        order: numbers of points that may be neighbours, by their first coordinate.
        references: positions in `order` of the points to follow.
        radius: of a neighbourhood.
        window: Theiler window.
        most: neighbours of one point, at most.
        steps: steps to follow, 0 included.
    """
    key = columns[0][order]
    total, sums, square = np.zeros(steps), np.empty(steps), np.empty(steps)
    used = 0
    for place in references:
        i = order[place]
        count = 0
        sums[:] = 0.0
        for way in (-1, 1):
            position = place + way
            limit = most if way > 0 else most // 2
            while 0 <= position < order.size and abs(key[position] - key[place]) <= radius and count < limit:
                j = order[position]
                if abs(j - i) > window and _within(columns, i, j, radius):
                    _add_distances(columns, i, j, square, sums)
                    count += 1
                position += way
        if count >= LEAST_NEIGHBOURS and sums.min() > 0.0:
            used += 1
            for k in range(steps):
                total[k] += np.log(sums[k] / count)
    return total, used


def kantz(
    points: Array,
    *,
    radius: float,
    theiler: int,
    horizon: int,
    rate: float = 1.0,
    fit: tuple[int, int] | None = None,
    references: int = 2000,
    most: int = 1000,
) -> Divergence:
    """Largest exponent by the logarithm of the mean distance of all neighbours within a radius.

    curve(k) = mean over i of ln (mean over j of |P(i + k) - P(j + k)|), j the points with |P(i) - P(j)| <= radius and
    |i - j| > theiler; the exponent is its slope before it saturates. Distances are Euclidean, of all coordinates (Kantz
    takes the newest one alone: the same slope). The mean over many neighbours before the logarithm is what makes it
    steadier against noise than Rosenstein's method, as long as the radius is larger than the noise. The first steps
    show how neighbours turn into the unstable direction and read too steep: for a flow let `fit` begin one mean period
    on and end before the curve bends; with the range found by itself Lorenz' flow reads too high.

    Args:
        points: (points, coordinates), of `embed` or `strobed`.
        radius: of a neighbourhood, unit of the points; a few per cent of the orbit's size.
        theiler: neighbours closer in time than this are left out; one mean period at least.
        horizon: steps for which neighbours are followed.
        rate: steps per unit time, for the unit of the result.
        fit: first and last step of the line; None finds the range before saturation.
        references: number of points whose neighbours are followed, spread evenly over the first coordinate.
        most: neighbours of one point, at most.

    Returns:
        The exponent in nats per unit time, its curve and the quality of its line; see `Divergence.exponential`.

    Raises:
        InputError: a value that isn't finite, a constant, too few points for the window and the horizon, no point with
            5 neighbours within the radius, a setting that isn't possible.
    """
    theiler, horizon = checked.whole("theiler", theiler, 0), checked.whole("horizon", horizon, 2)
    radius, rate = checked.positive("radius", radius), checked.positive("rate", rate)
    most = checked.whole("most", most, 2 * LEAST_NEIGHBOURS)
    values = checked_points("points", points, horizon + 2 * theiler + 2)
    size = len(values) - horizon
    wanted = min(checked.whole("references", references, 1), size)
    scaled, doublings = of_order_one(values)
    columns = np.ascontiguousarray(scaled.T)
    order = np.argsort(columns[0, :size], kind="stable")
    places = np.arange(wanted, dtype=np.int64) * size // wanted
    total, used = _curve(columns, order, places, float(np.ldexp(radius, -doublings)), theiler, most, horizon + 1)
    if used == 0:
        expected = f"one within which some point has {LEAST_NEIGHBOURS} neighbours at a distance"
        raise InputError("radius", expected, f"{radius:.6g}")
    anywhere = (np.mod(GOLDEN * np.arange(1, size + 1), 1.0) * size).astype(np.int64)
    apart = float(np.mean(np.linalg.norm(scaled[:size] - scaled[anywhere], axis=1)))
    offset = doublings * np.log(2.0)
    return fitted(total / used + offset, float(np.log(apart)) + offset, used, rate, fit)
