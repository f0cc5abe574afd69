"""Correlation dimension (Grassberger and Procaccia, Physica D 9 (1983) 189-208) with Theiler's window."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.embedding import of_order_one
from nw_gear_monitor.indicators.embedding import points as checked_points
from nw_gear_monitor.indicators.neighbours import Whole
from nw_gear_monitor.signals import checked

LEAST_RADII = 3
LEAST_PAIRS = 100
"""Pairs within the smallest radius of the default, at least."""
DEFAULT_RADII = 24


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _add(distances: Array, radii: Array, table: Whole, counts: Whole) -> None:
    """Count each distance at the first radius that isn't smaller; `table` says where to begin to look."""
    largest = radii[-1]
    scale = (table.size - 1) / largest
    for distance in distances:
        if distance <= largest:
            number = table[int(distance * scale)]
            while radii[number] < distance:
                number += 1
            counts[number] += 1


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _histogram(columns: Array, moments: Whole, radii: Array, table: Whole, window: int) -> Whole:
    """Pairs by the first radius that isn't smaller than their distance.

    Args:
        columns: (coordinates, points) in the order of the first coordinate.
        moments: (points,) their numbers in time.
        radii: increasing.
        table: (buckets,) where to begin to look in `radii`.
        window: pairs this close in time aren't counted.
    """
    dimension, size = columns.shape
    counts = np.zeros(radii.size, dtype=np.int64)
    square = np.empty(size)
    first = columns[0]
    largest = radii[-1]
    stop = 0
    for i in range(size):
        stop = max(stop, i + 1)
        while stop < size and first[stop] - first[i] <= largest:
            stop += 1
        length = stop - i - 1
        total = square[:length]
        total[:] = 0.0
        for c in range(dimension):
            others, own = columns[c, i + 1 : stop], columns[c, i]
            for j in range(length):
                gap = others[j] - own
                total[j] += gap * gap
        times, own_time = moments[i + 1 : stop], moments[i]
        for j in range(length):
            total[j] = np.sqrt(total[j]) if abs(times[j] - own_time) > window else np.inf
        _add(total, radii, table, counts)
    return counts


@dataclass(frozen=True, eq=False)
class CorrelationDimension:
    """Outcome of the method.

    Attributes:
        dimension: slope of ln C(r) over ln r.
        standard_error: of the slope by the scatter about the line; the true error is larger.
        r_squared: share of the variance of ln C(r) that the line explains.
        steepest, flattest: largest and smallest slope of a third of the radii: far apart where nothing scales.
        radii: (radii,) those with pairs, unit of the points.
        sums: (radii,) C(r), share of the pairs with a distance of r or less.
        pairs: number of pairs compared.
    """

    dimension: float
    standard_error: float
    r_squared: float
    steepest: float
    flattest: float
    radii: Array
    sums: Array
    pairs: int


def _slope(x: Array, y: Array) -> float:
    about = x - x.mean()
    return float(about @ y) / float(about @ about)


def _fitted(radii: Array, sums: Array, pairs: int) -> CorrelationDimension:
    x, y = np.log(radii), np.log(sums)
    slope = _slope(x, y)
    about_x, about_y = x - x.mean(), y - y.mean()
    rest, total = float(np.sum((about_y - slope * about_x) ** 2)), float(about_y @ about_y)
    third = max(x.size // 3, 2)
    slopes = [_slope(x[k : k + third], y[k : k + third]) for k in range(0, x.size - third + 1, third)]
    return CorrelationDimension(
        dimension=slope,
        standard_error=float(np.sqrt(rest / (x.size - 2) / float(about_x @ about_x))),
        r_squared=max(1.0 - rest / total, 0.0) if total > 0.0 else 0.0,
        steepest=max(slopes),
        flattest=min(slopes),
        radii=radii,
        sums=sums,
        pairs=pairs,
    )


def _checked_radii(given: Array) -> Array:
    radii = checked.finite("radii", given, LEAST_RADII)
    if radii[0] <= 0.0 or np.any(np.diff(radii) <= 0.0):
        raise InputError("radii", "increasing numbers above zero", f"{radii[0]:.6g} to {radii[-1]:.6g}")
    return radii


def correlation_dimension(points: Array, *, theiler: int, radii: Array | None = None) -> CorrelationDimension:
    """Dimension of the set that an orbit fills, by how the number of near pairs grows with the radius.

    C(r) is the share of the pairs with |i - j| > theiler whose Euclidean distance is r or less; the dimension is the
    slope of ln C(r) over ln r. Source: see above; window: Theiler, Physical Review A 34 (1986) 2427-2432. White noise
    gives the number of coordinates. A trend indicator only: it wants 10^(dimension / 2) points at the very least, reads
    low where there are fewer, high where noise is larger than the smallest radius, and any coloured noise has a finite
    one.

    Args:
        points: (points, coordinates), of `embed` or `strobed`.
        theiler: pairs closer in time than this are left out; one mean period at least.
        radii: increasing, unit of the points. None takes 24 of them, from the one with 100 pairs or 0.5 % of the
            points' spread up to 10 % of it, spread being the root of the sum of all coordinates' variances.

    Raises:
        InputError: a value that isn't finite, a constant, too few points for the window, fewer than 3 radii with pairs,
            a setting that isn't possible.
    """
    theiler = checked.whole("theiler", theiler, 0)
    values = checked_points("points", points, theiler + 3)
    size = len(values)
    pairs = (size - theiler - 1) * (size - theiler) // 2
    scaled, doublings = of_order_one(values)
    spread = float(np.sqrt(np.sum(np.var(scaled, axis=0))))
    if radii is None:
        wanted = spread * np.geomspace(0.005, 0.10, DEFAULT_RADII)
    else:
        wanted = np.ldexp(_checked_radii(radii), -doublings)
    order = np.argsort(scaled[:, 0], kind="stable")
    table = np.searchsorted(wanted, np.arange(4097) * (wanted[-1] / 4096.0) * (1.0 - 1e-12))
    counts = _histogram(np.ascontiguousarray(scaled[order].T), order, wanted, table, theiler)
    within = np.cumsum(counts)
    used = within >= (LEAST_PAIRS if radii is None else 1)
    if np.count_nonzero(used) < LEAST_RADII:
        least = f"{LEAST_RADII} radii with pairs, up to {np.ldexp(wanted[-1], doublings):.6g}"
        raise InputError("radii", least, f"{np.count_nonzero(used)} of {wanted.size}")
    return _fitted(np.ldexp(wanted[used], doublings), within[used] / pairs, pairs)
