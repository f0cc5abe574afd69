"""Normal equations of the line fit, one second at a time.

One second gives A^T A, A^T x and x^T x, where A holds cosine and sine of the lines of a comb. Windows add seconds up
afresh at each hop; nothing runs on from hop to hop, so that no rounding piles up and a replay gives the same numbers.

Two things are settled inside the second and projected out of A and x alike:
- the slow trend, a polynomial of degree 15 in time (below about 5 Hz): changes of load are no vibration;
- the comb's free lines, in a second of changing speed each times polynomials of degree 4: these strongest lines may
  change their amplitude within a fraction of a second, as when a weakly damped mode is passed and rings down; each
  takes up 2 to 3 Hz of bandwidth then, 1 Hz at constant speed.

The comb's modulated lines get three columns each (times 1, tau, (3 tau^2 - 1)/2 with tau from -1 to 1 over the second),
from which a window composes amplitude curves that are smooth on the scale of a second.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numba
import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre
from scipy.linalg import LinAlgError, cholesky, solve_triangular
from scipy.linalg.blas import dsyrk

from nw_gear_common.tables import Array
from nw_gear_monitor.signals.comb import PARTS, Comb, Twelfths, multiples, spaced

SHAPES = 3
TREND_DEGREE = 15
FREE_DEGREE = 4
STEADY = 5e-4
"""Speed that changes by less than this within a second (relative) counts as constant there."""
FREE_APART = 3.0
"""Free lines closer than this are taken once (Hz)."""
RATE_DEGREE = 4
LEAST_DIAGONAL = 1e-6
"""Smallest over largest entry on R's diagonal that Cholesky's way is trusted with."""
PIECE = 1280
"""Samples whose columns are formed at a time: about 5 MB."""
NODES, WEIGHTS = legendre.leggauss(5)
"""Where speed and load are known inside a second (tau), and the weights to integrate over it."""


@dataclass(frozen=True, eq=False)
class NormalSecond:
    """One second's part of the normal equations.

    Attributes:
        gram: (columns, columns), A^T A after the projection.
        moment: (columns, channels), A^T x after it (m).
        energy: (channels,), x^T x without the trend, before the free lines are taken out (m^2).
        rest: (channels,), x^T x after the whole projection (m^2).
        samples: number of samples.
        rate: (nodes, phases) frequencies (rad/s) at NODES.
        level: (nodes, channels) slow trend of x (m) at NODES.
        free, degree: the free lines that this second can tell apart, and the degree of their amplitudes in time.
        triangle, overlap, projection: R and Q^T A, Q^T x of what was projected out, W = Q R.
    """

    gram: Array
    moment: Array
    energy: Array
    rest: Array
    samples: int
    rate: Array
    level: Array
    free: tuple[Twelfths, ...]
    degree: int
    triangle: Array
    overlap: Array
    projection: Array

    def settled(self, phase: Array, tau: Array, coefficients: Array, channel: int) -> Array:
        """Trend and free lines at given points, once the columns' coefficients (columns,) of a channel are known."""
        inside = self.projection[:, channel] - self.overlap @ coefficients
        weights = solve_triangular(self.triangle, inside)
        found: Array = settled_columns(phase, tau, self.free, self.degree) @ weights
        return found


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _turned(re: Array, im: Array, by_re: Array, by_im: Array, sign: float, out_re: Array, out_im: Array) -> None:
    """Multiply by unit numbers, or by their conjugates where the sign is -1; all (samples,)."""
    for i in range(re.size):
        a, b = re[i], im[i]
        c, d = by_re[i], sign * by_im[i]
        out_re[i] = a * c - b * d
        out_im[i] = a * d + b * c


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _powers(phase: Array, parts: float, count: int) -> Array:
    """Cosine (0) and sine (1) of k phase / parts for k = 0 .. count - 1, shape (2, count, samples)."""
    out = np.empty((2, count, phase.size))
    out[0, 0] = 1.0
    out[1, 0] = 0.0
    if count > 1:
        for i in range(phase.size):
            angle = phase[i] / parts
            out[0, 1, i] = np.cos(angle)
            out[1, 1, i] = np.sin(angle)
    for k in range(2, count):
        _turned(out[0, k - 1], out[1, k - 1], out[0, 1], out[1, 1], 1.0, out[0, k], out[1, k])
    return out


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _design(
    phase: Array, tau: Array, lines: npt.NDArray[np.int64], modulated: int, reach: int, fractions: bool, out: Array
) -> None:
    """Fill `out`, (columns, samples); `phase` is (stages, samples)."""
    size, stages = tau.size, phase.shape[0]
    whole = [_powers(phase[stage], 1.0, reach + 1) for stage in range(stages)]
    parts = [_powers(phase[stage], float(PARTS), PARTS if fractions else 1) for stage in range(stages)]
    square = 0.5 * (3.0 * tau * tau - 1.0)
    re, im = np.empty(size), np.empty(size)
    for line in range(lines.shape[0]):
        re[:] = 1.0
        im[:] = 0.0
        for stage in range(stages):
            number = abs(lines[line, stage])
            sign = 1.0 if lines[line, stage] > 0 else -1.0
            if number // PARTS > 0:
                table, at = whole[stage], number // PARTS
                _turned(re, im, table[0, at], table[1, at], sign, re, im)
            if number % PARTS > 0:
                table, at = parts[stage], number % PARTS
                _turned(re, im, table[0, at], table[1, at], sign, re, im)
        if line < modulated:
            at = 2 * SHAPES * line
            for i in range(size):
                out[at, i] = re[i]
                out[at + 1, i] = re[i] * tau[i]
                out[at + 2, i] = re[i] * square[i]
                out[at + 3, i] = im[i]
                out[at + 4, i] = im[i] * tau[i]
                out[at + 5, i] = im[i] * square[i]
        else:
            at = 2 * SHAPES * modulated + 2 * (line - modulated)
            out[at] = re
            out[at + 1] = im


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _summed(
    phase: Array,
    tau: Array,
    lines: npt.NDArray[np.int64],
    modulated: int,
    reach: int,
    fractions: bool,
    own: Array,
    out: Array,
) -> None:
    """Add the columns times their coefficients up, lines without any left out; `phase` is (stages, samples)."""
    size, stages = tau.size, phase.shape[0]
    whole = [_powers(phase[stage], 1.0, reach + 1) for stage in range(stages)]
    parts = [_powers(phase[stage], float(PARTS), PARTS if fractions else 1) for stage in range(stages)]
    square = 0.5 * (3.0 * tau * tau - 1.0)
    re, im = np.empty(size), np.empty(size)
    out[:] = 0.0
    for line in range(lines.shape[0]):
        shapes = SHAPES if line < modulated else 1
        at = 2 * SHAPES * line if line < modulated else 2 * SHAPES * modulated + 2 * (line - modulated)
        if not np.any(own[at : at + 2 * shapes]):
            continue
        re[:] = 1.0
        im[:] = 0.0
        for stage in range(stages):
            number = abs(lines[line, stage])
            sign = 1.0 if lines[line, stage] > 0 else -1.0
            if number // PARTS > 0:
                table, k = whole[stage], number // PARTS
                _turned(re, im, table[0, k], table[1, k], sign, re, im)
            if number % PARTS > 0:
                table, k = parts[stage], number % PARTS
                _turned(re, im, table[0, k], table[1, k], sign, re, im)
        if shapes == 1:
            for i in range(size):
                out[i] += own[at] * re[i] + own[at + 1] * im[i]
        else:
            for i in range(size):
                out[i] += re[i] * (own[at] + own[at + 1] * tau[i] + own[at + 2] * square[i])
                out[i] += im[i] * (own[at + 3] + own[at + 4] * tau[i] + own[at + 5] * square[i])


@lru_cache(maxsize=16)
def _plan(comb: Comb) -> tuple[npt.NDArray[np.int64], int, bool, int]:
    """A comb's lines (lines, stages), their highest whole multiple, whether there are fractions, number of columns."""
    lines = np.array(comb.lines, dtype=np.int64).reshape(len(comb.lines), -1)
    modulated = len(comb.modulated)
    columns = 2 * SHAPES * modulated + 2 * (len(lines) - modulated)
    return lines, int(np.max(np.abs(lines), initial=0)) // PARTS, bool(np.any(lines % PARTS)), columns


def _fill(phase: Array, tau: Array, comb: Comb, out: Array) -> None:
    lines, reach, fractions, _ = _plan(comb)
    turned = np.ascontiguousarray(np.mod(phase, 2.0 * np.pi * PARTS).T)
    _design(turned, tau, lines, len(comb.modulated), reach, fractions, out)


def design(phase: Array, tau: Array, comb: Comb) -> Array:
    """Cosine and sine columns of a comb.

    Args:
        phase: (samples, phases) unwrapped phases: meshes (planet 1), then shafts, rad.
        tau: (samples,) time within the second, -1 to 1.
        comb: its modulated lines take 6 columns each (cosine and sine times three shapes), the others 2.

    Returns:
        (samples, columns).
    """
    out = np.empty((_plan(comb)[3], len(phase)))
    _fill(phase, np.ascontiguousarray(tau), comb, out)
    return out.T


def summed(phase: Array, tau: Array, comb: Comb, coefficients: Array) -> Array:
    """`design` times coefficients (columns,): (samples,)."""
    lines, reach, fractions, _ = _plan(comb)
    turned = np.ascontiguousarray(np.mod(phase, 2.0 * np.pi * PARTS).T)
    out = np.empty(len(phase))
    own = np.ascontiguousarray(coefficients)
    _summed(turned, np.ascontiguousarray(tau), lines, len(comb.modulated), reach, fractions, own, out)
    return out


def relative_time(time: Array, start: float) -> Array:
    """Time within a second as tau, -1 to 1."""
    tau: Array = 2.0 * (time - start) - 1.0
    return tau


def settled_columns(phase: Array, tau: Array, free: tuple[Twelfths, ...], degree: int) -> Array:
    """What is projected out of a second: the trend's polynomials, then each free line times some of them."""
    shapes = legendre.legvander(tau, TREND_DEGREE)
    angle = np.mod(phase, 2.0 * np.pi * PARTS) @ multiples(free, phase.shape[1]).T
    waves = np.stack([np.cos(angle), np.sin(angle)], axis=2)
    lines = waves[:, :, :, None] * shapes[:, None, None, : degree + 1]
    columns: Array = np.concatenate([shapes, lines.reshape(len(tau), -1)], axis=1)
    return columns


def normal_second(time: Array, phase: Array, x: Array, start: float, comb: Comb) -> NormalSecond:
    """Form one second's normal equations.

    Args:
        time: (samples,) s; phase: (samples, stages) rad; x: (samples, channels) m.
        start: beginning of the second, s.
        comb: the lines.
    """
    tau = relative_time(time, start)
    slope = legendre.legder(legendre.legfit(tau, phase - phase[0], RATE_DEGREE), axis=0)
    rate = np.asarray(2.0 * legendre.legval(NODES, slope).T, dtype=np.float64)
    free = _apart(comb.free, rate.mean(axis=0), len(time))
    degree = FREE_DEGREE if np.ptp(rate[:, 0]) > STEADY * abs(rate[:, 0].mean()) else 0
    settled = settled_columns(phase, tau, free, degree)
    r = _triangle(settled)
    projection, flat = _projected(settled, r, x)
    gram, across, moment = _products(phase, tau, comb, settled, flat)
    overlap = solve_triangular(r, across, trans="T", check_finite=False)
    trend = TREND_DEGREE + 1
    rest = np.sum(flat * flat, axis=0)
    return NormalSecond(
        gram=gram - overlap.T @ overlap,
        moment=moment,
        energy=rest + np.sum(projection[trend:] ** 2, axis=0),
        rest=rest,
        samples=len(time),
        rate=rate,
        level=legendre.legvander(NODES, TREND_DEGREE) @ solve_triangular(r[:trend, :trend], projection[:trend]),
        free=free,
        degree=degree,
        triangle=r,
        overlap=overlap,
        projection=projection,
    )


def extended_second(
    time: Array, phase: Array, x: Array, start: float, comb: Comb, base: NormalSecond, stays: int
) -> NormalSecond:
    """Normal equations for a comb whose first columns were formed already: a third of the work.

    Args:
        time, phase, x, start, comb: see `normal_second`.
        base: of the same second, with the same free lines.
        stays: its first columns that are the first columns of this comb.
    """
    tau = relative_time(time, start)
    settled = settled_columns(phase, tau, base.free, base.degree)
    _, flat = _projected(settled, base.triangle, x)
    size, outside = _plan(comb)[3], settled.shape[1]
    rows = _new_rows(phase, tau, comb, stays, np.concatenate([settled, flat], axis=1))
    added = solve_triangular(base.triangle, rows[:, size : size + outside].T, trans="T", check_finite=False)
    overlap = np.concatenate([base.overlap[:, :stays], added], axis=1)
    gram = np.empty((size, size))
    gram[:stays, :stays] = base.gram[:stays, :stays]
    gram[stays:] = rows[:, :size] - added.T @ overlap
    gram[:stays, stays:] = gram[stays:, :stays].T
    moment = np.concatenate([base.moment[:stays], rows[:, size + outside :]])
    return replace(base, gram=gram, moment=moment, overlap=overlap)


def _new_rows(phase: Array, tau: Array, comb: Comb, stays: int, others: Array) -> Array:
    """Products of the comb's columns from `stays` on with all its columns and with others, (new, all + others)."""
    size = _plan(comb)[3]
    total = np.zeros((size - stays, size + others.shape[1]))
    for first in range(0, len(tau), PIECE):
        rows = slice(first, first + PIECE)
        piece = np.empty((total.shape[1], len(tau[rows])))
        _fill(phase[rows], np.ascontiguousarray(tau[rows]), comb, piece[:size])
        piece[size:] = others[rows].T
        total += piece[stays:size] @ piece.T
    return total


def _triangle(columns: Array) -> Array:
    """R of the decomposition W = Q R: by Cholesky of W^T W, which these nearly orthogonal columns allow, else by QR."""
    try:
        r: Array = cholesky(columns.T @ columns, check_finite=False)
    except LinAlgError:
        return np.asarray(np.linalg.qr(columns).R)
    diagonal = np.diag(r)
    return r if diagonal.min() > LEAST_DIAGONAL * diagonal.max() else np.asarray(np.linalg.qr(columns).R)


def _projected(columns: Array, r: Array, x: Array) -> tuple[Array, Array]:
    """Q^T x, and x without its part in W = Q R; in two rounds, so that a large mean leaves no rounding behind."""
    projection, rest = np.zeros((columns.shape[1], x.shape[1])), x
    for _ in range(2):
        part = solve_triangular(r, columns.T @ rest, trans="T", check_finite=False)
        rest = rest - columns @ solve_triangular(r, part, check_finite=False)
        projection += part
    return projection, rest


def _products(phase: Array, tau: Array, comb: Comb, settled: Array, flat: Array) -> tuple[Array, Array, Array]:
    """A^T A, W^T A and A^T x in one product of a matrix with itself, a piece of the second at a time."""
    own, outside = _plan(comb)[3], settled.shape[1]
    size = own + outside + flat.shape[1]
    total = np.zeros((size, size), order="F")
    for first in range(0, len(tau), PIECE):
        rows = slice(first, first + PIECE)
        piece = np.empty((size, len(tau[rows])))
        _fill(phase[rows], np.ascontiguousarray(tau[rows]), comb, piece[:own])
        piece[own : own + outside] = settled[rows].T
        piece[own + outside :] = flat[rows].T
        total = dsyrk(1.0, piece.T, 1.0, total, trans=1, lower=1, overwrite_c=1)
    gram = np.tril(total[:own, :own])
    return gram + np.tril(gram, -1).T, total[own : own + outside, :own], total[own + outside :, :own].T


def _apart(lines: tuple[Twelfths, ...], rate: Array, samples: int) -> tuple[Twelfths, ...]:
    """The lines that are FREE_APART from each other and below 0.45 of the sample rate, about `samples` a second."""
    kept = spaced(multiples(lines, rate.size) @ rate / (2.0 * np.pi), FREE_APART, 0.45 * samples)
    return tuple(line for line, keep in zip(lines, kept, strict=True) if keep)
