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

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre
from scipy.linalg import solve_triangular

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
        rate: (nodes, 3) mesh frequencies (rad/s) at NODES.
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
def _powers(angle: float, coarse: npt.NDArray[np.complex128], fine: npt.NDArray[np.complex128]) -> None:
    """exp(i k angle) into `coarse` and exp(i k angle / PARTS) into `fine`."""
    coarse[0] = 1.0
    fine[0] = 1.0
    unit = complex(np.cos(angle), np.sin(angle))
    part = complex(np.cos(angle / PARTS), np.sin(angle / PARTS))
    for k in range(1, coarse.size):
        coarse[k] = coarse[k - 1] * unit
    for k in range(1, fine.size):
        fine[k] = fine[k - 1] * part


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _design(
    phase: Array, tau: Array, lines: npt.NDArray[np.int64], modulated: int, reach: tuple[int, int], out: Array
) -> None:
    coarse = np.empty((3, reach[0] + 1), dtype=np.complex128)
    fine = np.empty((3, reach[1] + 1), dtype=np.complex128)
    steady = 2 * SHAPES * modulated
    for row in range(phase.shape[0]):
        t = tau[row]
        square = 0.5 * (3.0 * t * t - 1.0)
        for stage in range(3):
            _powers(phase[row, stage], coarse[stage], fine[stage])
        for line in range(lines.shape[0]):
            z = complex(1.0, 0.0)
            for stage in range(3):
                parts = lines[line, stage]
                if parts == 0:
                    continue
                size = abs(parts)
                factor = coarse[stage, size // PARTS] if size % PARTS == 0 else fine[stage, size]
                z *= factor if parts > 0 else factor.conjugate()
            if line < modulated:
                at = 2 * SHAPES * line
                out[row, at], out[row, at + 1], out[row, at + 2] = z.real, z.real * t, z.real * square
                out[row, at + 3], out[row, at + 4], out[row, at + 5] = z.imag, z.imag * t, z.imag * square
            else:
                at = steady + 2 * (line - modulated)
                out[row, at], out[row, at + 1] = z.real, z.imag


def design(phase: Array, tau: Array, comb: Comb) -> Array:
    """Cosine and sine columns of a comb.

    Args:
        phase: (samples, 3) unwrapped mesh phases of planet 1, rad.
        tau: (samples,) time within the second, -1 to 1.
        comb: its modulated lines take 6 columns each (cosine and sine times three shapes), the others 2.

    Returns:
        (samples, columns).
    """
    lines = np.array(comb.lines, dtype=np.int64).reshape(-1, 3)
    whole = lines % PARTS == 0
    reach = int(np.max(np.abs(lines)[whole], initial=0)) // PARTS, int(np.max(np.abs(lines)[~whole], initial=0))
    modulated = len(comb.modulated)
    out = np.empty((len(phase), 2 * SHAPES * modulated + 2 * (len(lines) - modulated)))
    _design(np.mod(phase, 2.0 * np.pi * PARTS), tau, lines, modulated, reach, out)
    return out


def relative_time(time: Array, start: float) -> Array:
    """Time within a second as tau, -1 to 1."""
    tau: Array = 2.0 * (time - start) - 1.0
    return tau


def settled_columns(phase: Array, tau: Array, free: tuple[Twelfths, ...], degree: int) -> Array:
    """What is projected out of a second: the trend's polynomials, then each free line times some of them."""
    shapes = legendre.legvander(tau, TREND_DEGREE)
    angle = np.mod(phase, 2.0 * np.pi * PARTS) @ multiples(free).T
    waves = np.stack([np.cos(angle), np.sin(angle)], axis=2)
    lines = waves[:, :, :, None] * shapes[:, None, None, : degree + 1]
    columns: Array = np.concatenate([shapes, lines.reshape(len(tau), -1)], axis=1)
    return columns


def normal_second(time: Array, phase: Array, x: Array, start: float, comb: Comb) -> NormalSecond:
    """Form one second's normal equations.

    Args:
        time: (samples,) s; phase: (samples, 3) rad; x: (samples, channels) m.
        start: beginning of the second, s.
        comb: the lines.
    """
    tau = relative_time(time, start)
    slope = legendre.legder(legendre.legfit(tau, phase - phase[0], RATE_DEGREE), axis=0)
    rate = np.asarray(2.0 * legendre.legval(NODES, slope).T, dtype=np.float64)
    free = _apart(comb.free, rate.mean(axis=0), len(time))
    degree = FREE_DEGREE if np.ptp(rate[:, 0]) > STEADY * abs(rate[:, 0].mean()) else 0
    q, r = np.linalg.qr(settled_columns(phase, tau, free, degree))
    columns = design(phase, tau, comb)
    projection, overlap = q.T @ x, q.T @ columns
    flat = x - q @ projection
    trend = TREND_DEGREE + 1
    rest = np.sum(flat * flat, axis=0)
    return NormalSecond(
        gram=columns.T @ columns - overlap.T @ overlap,
        moment=columns.T @ flat,
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


def _apart(lines: tuple[Twelfths, ...], rate: Array, samples: int) -> tuple[Twelfths, ...]:
    """The lines that are FREE_APART from each other and below 0.45 of the sample rate, about `samples` a second."""
    kept = spaced(multiples(lines) @ rate / (2.0 * np.pi), FREE_APART, 0.45 * samples)
    return tuple(line for line, keep in zip(lines, kept, strict=True) if keep)
