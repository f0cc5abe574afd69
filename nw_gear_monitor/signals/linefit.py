"""Least squares of expected lines over a window, from the normal equations of its seconds."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.linalg import LinAlgError, cho_factor, cho_solve, solve_triangular

from nw_gear_common.tables import Array
from nw_gear_monitor.signals.comb import HIGHEST_FREQUENCY, Comb, Subharmonic, Twelfths, multiples, spaced
from nw_gear_monitor.signals.modulation import Modulation, modulation
from nw_gear_monitor.signals.normal import SHAPES, NormalSecond, summed

Flags = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.intp]

RIDGES = (1e-10, 1e-7, 1e-4, 1e-2)
"""Added to the diagonal of the scaled matrix, the first that makes it solvable: harmless next to any noise."""
NYQUIST_SHARE = 0.45
GONE = 1e-6
"""Mean square of a column below which it lies in the trend (a line below 5 Hz): what is left of it is mostly rounding.

At a third of rated speed, with 1e-9, rounding made the scaled matrix indefinite (an eigenvalue of -0.3).
"""


@dataclass(frozen=True, eq=False)
class LineFit:
    """Lines fitted to a window.

    Attributes:
        comb: the comb whose lines were offered.
        kept: (lines,) bool, the lines that this window can tell apart and that were fitted (candidates never are).
        coefficients: (seconds, columns, channels): local coefficients for the columns of `normal.design`.
        residual, energy: (channels,) sums of squares after the fit (corrected for degrees of freedom) and before, m^2.
        candidates: (stage, divisor) -> (channels,) share of `energy` that these further lines would explain.
        columns: number of fitted columns.
        modulation: how amplitudes were allowed to change.
        seconds: the normal equations it was made from.
        frequency: (lines,) mean frequencies (Hz).
    """

    comb: Comb
    kept: Flags
    coefficients: Array
    residual: Array
    energy: Array
    candidates: dict[Subharmonic, Array]
    columns: int
    modulation: Modulation
    frequency: Array
    seconds: list[NormalSecond]

    @property
    def lines(self) -> int:
        """Number of fitted lines, free ones included."""
        return int(np.count_nonzero(self.kept)) + len(self.seconds[-1].free)

    def predict(self, second: int, phase: Array, tau: Array, channel: int) -> Array:
        """Trend and fitted lines at given phases (points, phases) and times tau (points,) of one second: (points,)."""
        own = self.coefficients[second, :, channel]
        lines = summed(phase, tau, self.comb, own)
        return lines + self.seconds[second].settled(phase, tau, own, channel)


def fit(seconds: list[NormalSecond], comb: Comb, rate: float, loaded: Sequence[int] | None = None) -> LineFit:
    """Fit the lines of a comb to a window.

    Args:
        seconds: contiguous seconds formed with this comb, oldest first.
        comb: the lines.
        rate: samples per second of the fitted signal, Hz (for the highest line).
        loaded: channels whose mean follows the load; all where None.
    """
    speeds = np.stack([second.rate for second in seconds])
    levels = np.stack([second.level for second in seconds])
    followed = levels if loaded is None else levels[:, :, list(loaded)]
    load = followed.mean(axis=2) if followed.shape[2] else np.ones(levels.shape[:2])
    curves = modulation(speeds[:, :, speeds.shape[2] // 2], load)
    mean = speeds.mean(axis=(0, 1))
    frequency = multiples(comb.lines, mean.size) @ mean / (2.0 * np.pi)
    highest = min(HIGHEST_FREQUENCY, NYQUIST_SHARE * rate)
    free = multiples(seconds[-1].free, mean.size) @ mean / (2.0 * np.pi)
    kept = spaced(frequency, 1.0 / len(seconds), highest, free)
    gram, moment = _assemble(seconds, len(comb.modulated), curves)
    energy = np.sum([second.energy for second in seconds], axis=0)
    samples = sum(second.samples for second in seconds)
    wanted, groups = _columns(comb, kept, curves.functions)
    size = np.diag(gram)
    scale = np.where(size > GONE * samples, 1.0 / np.sqrt(np.maximum(size, GONE)), 0.0)
    gram *= scale[:, None]
    gram *= scale
    moment *= scale[:, None]
    factor = _factor(gram[np.ix_(wanted, wanted)])
    solution = cho_solve(factor, moment[wanted], check_finite=False)
    left = np.sum([second.rest for second in seconds], axis=0) - np.sum(moment[wanted] * solution, axis=0)
    freedom = max(samples - wanted.size - sum(second.triangle.shape[0] for second in seconds), 1)
    shares = _candidate_shares(gram, moment, wanted, groups, factor, solution, energy)
    full = np.zeros_like(moment)
    full[wanted] = solution * scale[wanted, None]
    kept[len(comb.modulated) + len(comb.steady) :] = False
    local = _local(full, len(comb.modulated), curves)
    residual = np.maximum(left, 0.0) * samples / freedom
    return LineFit(comb, kept, local, residual, energy, shares, wanted.size, curves, frequency, seconds)


def _factor(matrix: Array) -> tuple[Array, bool]:
    """Cholesky factor of a scaled matrix whose columns may be nearly dependent.

    Where no ridge helps, rounding has made an eigenvalue negative: then all below the largest ridge are raised to it.
    """
    for ridge in RIDGES:
        with contextlib.suppress(LinAlgError):
            raised = matrix.T.copy(order="F")
            raised[np.diag_indices(len(raised))] += ridge
            factor, lower = cho_factor(raised, overwrite_a=True, check_finite=False)
            return factor, bool(lower)
    values, vectors = np.linalg.eigh(matrix)
    repaired = np.asfortranarray((vectors * np.maximum(values, RIDGES[-1])) @ vectors.T)
    factor, lower = cho_factor(repaired, overwrite_a=True, check_finite=False)
    return factor, bool(lower)


def _assemble(seconds: list[NormalSecond], lines: int, curves: Modulation) -> tuple[Array, Array]:
    """Add the seconds up, with each modulated column's shapes turned into the window's functions."""
    local = 2 * lines * SHAPES
    wide = 2 * lines * curves.functions
    others = seconds[0].gram.shape[0] - local
    gram = np.zeros((wide + others, wide + others))
    moment = np.zeros((wide + others, seconds[0].moment.shape[1]))
    for second, shape_map in zip(seconds, curves.maps, strict=True):
        active = np.flatnonzero(shape_map.any(axis=0))
        shapes = shape_map[:, active]
        place = (curves.functions * np.arange(2 * lines)[:, None] + active).ravel()
        mixed = _compose(second.gram[:local], shapes)
        gram[np.ix_(place, place)] += _compose(np.ascontiguousarray(mixed[:, :local].T), shapes).T
        gram[place, wide:] += mixed[:, local:]
        gram[wide:, wide:] += second.gram[local:, local:]
        moment[place] += _compose(second.moment[:local], shapes)
        moment[wide:] += second.moment[local:]
    gram[wide:, :wide] = gram[:wide, wide:].T
    return gram, moment


def _compose(rows: Array, shapes: Array) -> Array:
    """Turn the rows of local shapes (lines * SHAPES, columns) into rows of functions (lines * functions, columns)."""
    split = rows.reshape(-1, SHAPES, rows.shape[1])
    composed: Array = np.matmul(shapes.T, split).reshape(-1, rows.shape[1])
    return composed


def _columns(comb: Comb, kept: Flags, functions: int) -> tuple[Indices, dict[Subharmonic, Indices]]:
    """Columns of the fitted lines, and of each group of candidates, in the window's matrix."""
    modulated, steady = len(comb.modulated), len(comb.steady)
    wide = 2 * functions * modulated
    first = np.flatnonzero(np.repeat(kept[:modulated], 2 * functions))
    second = wide + np.flatnonzero(np.repeat(kept[modulated : modulated + steady], 2))
    place: dict[Twelfths, int] = {line: i for i, line in enumerate(comb.candidate_lines)}
    groups = {}
    for name, lines in comb.candidates:
        chosen = np.array([place[line] for line in lines if kept[modulated + steady + place[line]]], dtype=np.intp)
        start = wide + 2 * steady + 2 * chosen
        groups[name] = np.sort(np.concatenate([start, start + 1]))
    return np.concatenate([first, second]), groups


def _candidate_shares(
    gram: Array,
    moment: Array,
    wanted: Indices,
    groups: dict[Subharmonic, Indices],
    factor: tuple[Array, bool],
    solution: Array,
    energy: Array,
) -> dict[Subharmonic, Array]:
    """Share of the energy that each group would explain on top of the fit (block elimination).

    With the fit's matrix U^T U the groups' own matrix is G - Y^T Y, Y = U^-T C, C the products of both.
    """
    everything = np.unique(np.concatenate([np.empty(0, dtype=np.intp), *groups.values()]))
    cross = np.asfortranarray(gram[np.ix_(wanted, everything)])
    through = solve_triangular(factor[0], cross, trans="T", check_finite=False)
    rest = gram[np.ix_(everything, everything)] - through.T @ through
    load = moment[everything] - cross.T @ solution
    shares = {}
    for name, group in groups.items():
        if group.size == 0:
            shares[name] = np.zeros_like(energy)
            continue
        at = np.searchsorted(everything, group)
        own = rest[np.ix_(at, at)] + RIDGES[1] * np.eye(group.size)
        gain = np.sum(load[at] * np.linalg.solve(own, load[at]), axis=0)
        shares[name] = gain / np.maximum(energy, 1e-300)
    return shares


def _local(full: Array, lines: int, curves: Modulation) -> Array:
    """Turn the window's coefficients into those of each second's columns."""
    wide = 2 * lines * curves.functions
    amplitude = full[:wide].reshape(2 * lines, curves.functions, -1)
    shaped = np.einsum("bpa,iac->bipc", curves.maps, amplitude).reshape(len(curves.maps), 2 * lines * SHAPES, -1)
    steady = np.broadcast_to(full[wide:], (len(curves.maps), *full[wide:].shape))
    return np.concatenate([shaped, steady], axis=1)
