"""Recurrence quantification (Webber and Zbilut 1994; Marwan and others, Physics Reports 438 (2007) 237-329)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numba
import numpy as np
import numpy.typing as npt

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.embedding import of_order_one
from nw_gear_monitor.indicators.embedding import points as checked_points
from nw_gear_monitor.indicators.neighbours import Whole
from nw_gear_monitor.signals import checked

Small = npt.NDArray[np.int32]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _near(columns: Array, start: int, own: Array, radius: float, euclidean: bool, near: Array, total: Array) -> None:
    """Set near[j] where point start + j of the sorted points lies within the radius of `own`."""
    size = near.size
    if euclidean:
        total[:size] = 0.0
        for c in range(own.size):
            others, at = columns[c, start : start + size], own[c]
            for j in range(size):
                total[j] += (others[j] - at) ** 2
        for j in range(size):
            near[j] = np.sqrt(total[j]) <= radius
    else:
        near[:] = 1
        for c in range(own.size):
            others, at = columns[c, start : start + size], own[c]
            for j in range(size):
                near[j] &= abs(others[j] - at) <= radius


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _extend(line: Small, moment: int, counts: Whole) -> None:
    """Add a point at a moment to a line (length, last moment); what was broken off before is counted."""
    if line[1] == moment - 1:
        line[0] += 1
    else:
        counts[line[0]] += 1
        line[0] = 1
    line[1] = moment


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _lines(columns: Array, order: Whole, radius: float, window: int, euclidean: bool) -> tuple[Whole, Whole]:
    """How many diagonal lines of each length lie above the main diagonal, and how many vertical ones anywhere.

    Rows of the recurrence matrix are gone through in time; of each diagonal and each column the last point and the
    length of the line that ends there are kept.

    Args:
        columns: (coordinates, points) in the order of the first coordinate.
        order: (points,) their numbers in time.
        radius: closed limit of the distance.
        window: points (i, j) with abs(i - j) <= window aren't recurrent; -1 keeps all.
        euclidean: or largest difference of a coordinate.
    """
    dimension, size = columns.shape
    first = columns[0]
    place = np.empty(size, dtype=np.int64)
    place[order] = np.arange(size)
    diagonal, vertical = np.zeros((size, 2), dtype=np.int32), np.zeros((size, 2), dtype=np.int32)
    diagonal[:, 1] = -2
    vertical[:, 1] = -2
    diagonals, verticals = np.zeros(size + 1, dtype=np.int64), np.zeros(size + 1, dtype=np.int64)
    mask, total, own = np.empty(size, dtype=np.uint8), np.empty(size), np.empty(dimension)
    for i in range(size):
        own[:] = columns[:, place[i]]
        start = np.searchsorted(first, own[0] - radius * (1.0 + 1e-9))
        stop = np.searchsorted(first, own[0] + radius * (1.0 + 1e-9), side="right")
        near = mask[: stop - start]
        _near(columns, start, own, radius, euclidean, near, total)
        for position in range(near.size):
            if near[position]:
                j = order[start + position]
                if abs(j - i) > window:
                    _extend(vertical[j], i, verticals)
                    if j > i:
                        _extend(diagonal[j - i], i, diagonals)
    for line in range(size):
        diagonals[diagonal[line, 0]] += 1
        verticals[vertical[line, 0]] += 1
    diagonals[0] = 0
    verticals[0] = 0
    return diagonals, verticals


@dataclass(frozen=True)
class Recurrence:
    """Outcome of the method.

    Attributes:
        rate: RR, share of the pairs that are recurrent.
        determinism: DET, share of the recurrent points on diagonal lines of the least length or longer.
        laminarity: LAM, the same on vertical lines.
        entropy: ENTR, of the lengths of those diagonal lines, nats.
        mean_diagonal: L, their mean length, steps; 0 where there's none.
        longest_diagonal: beside the main one, steps.
        trapping_time: TT, mean length of those vertical lines, steps; 0 where there's none.
    """

    rate: float
    determinism: float
    laminarity: float
    entropy: float
    mean_diagonal: float
    longest_diagonal: int
    trapping_time: float


def _long(counts: Whole, least: int) -> tuple[float, float, float]:
    """Share of the points on long lines, mean length of those, entropy of their lengths."""
    lengths = np.arange(counts.size)
    long = counts[least:]
    lines = int(long.sum())
    if lines == 0:
        return 0.0, 0.0, 0.0
    on_long = float(long @ lengths[least:])
    p = long[long > 0] / lines
    return on_long / float(counts @ lengths), on_long / lines, max(-float(p @ np.log(p)), 0.0)


def recurrence(
    points: Array,
    *,
    radius: float,
    theiler: int | None,
    least: int = 2,
    norm: Literal["maximum", "euclidean"] = "maximum",
) -> Recurrence:
    """How an orbit comes back: lines in the matrix of the pairs (i, j) whose distance is within a radius.

    RR = recurrent points / points; DET = sum over l >= least of l P(l) / sum of l P(l), P(l) the diagonal lines of
    length l; LAM the same for vertical lines; ENTR = -sum p(l) ln p(l) over lines of l >= least. White noise has DET =
    1 - (1 - RR)^2 at least = 2, a periodic orbit 1. With a sampled flow DET is near 1 for chaos as well: strobe first,
    or take a larger least length.

    Args:
        points: (points, coordinates), of `embed` or `strobed`.
        radius: unit of the points.
        theiler: points with |i - j| <= theiler don't count; None keeps even the main diagonal, as AccRQA does.
        least: shortest line that counts, 2 or more.
        norm: of the distance.

    Raises:
        InputError: a value that isn't finite, a constant, too few points for the window, no recurrent point, a setting
            that isn't possible.
    """
    window = -1 if theiler is None else checked.whole("theiler", theiler, 0)
    least, radius = checked.whole("least", least, 2), checked.positive("radius", radius)
    if norm not in ("maximum", "euclidean"):
        raise InputError("norm", "maximum or euclidean", repr(norm))
    values = checked_points("points", points, window + 3)
    size = len(values)
    scaled, doublings = of_order_one(values)
    order = np.argsort(scaled[:, 0], kind="stable")
    columns = np.ascontiguousarray(scaled[order].T)
    diagonals, verticals = _lines(columns, order, float(np.ldexp(radius, -doublings)), window, norm == "euclidean")
    longest = int(np.flatnonzero(diagonals)[-1]) if diagonals.any() else 0
    if longest == 0:
        raise InputError("radius", "one within which points come back", f"{radius:.6g}")
    diagonals = 2 * diagonals
    diagonals[size] += theiler is None
    determinism, mean_diagonal, entropy = _long(diagonals, least)
    laminarity, trapping_time, _ = _long(verticals, least)
    left = size - 1 - window
    possible = size * size if theiler is None else left * (left + 1)
    return Recurrence(
        rate=float(verticals @ np.arange(size + 1)) / possible,
        determinism=determinism,
        laminarity=laminarity,
        entropy=entropy,
        mean_diagonal=mean_diagonal,
        longest_diagonal=longest,
        trapping_time=trapping_time,
    )
