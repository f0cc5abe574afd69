"""Charts over two parameters, first of all the gains and delays of the feedback: damping, folds, peak (first order).

Every number is that of a whole resonance curve over the frequency. With m = mu/Gam, w = W3/Gam, s = S/Gam, a = alpha^2
and the forced motion Lam held fixed, both conditions of a fold, a [m^2 + (s - a)^2] = w^2 and its derivative by a, give

    folds     y^3 (1 - y) = m^6/(4 w^4),  a = (w/m)^2 y,  s = a + w^2/(2 a^2)
    peak      a = (w/m)^2,  s = a

so there are two folds where m^6/(4 w^4) < 27/256, which is |mu| < mu_c, and none elsewhere. That Lam depends on nu is
worked in by fixed-point iteration on nu, to rounding.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.firstorder import Coefficients, amplitudes, coefficients, critical_damping
from nw_gear_sim.superharmonic.pair import PARAMETERS, GearPair

AXES = (*PARAMETERS, "tau")
"""Parameters that can be axes; `tau` is both delays."""
MOST_POINTS = 1_000_000
ITERATIONS = 60
NEWTON = 12
FURTHEST = 0.5
"""What lies further from w0/3 than this part of it is taken as absent: the theory holds near the resonance alone."""
OUTSIDE = 1.02 * FURTHEST
MOST = 27.0 / 256.0
"""Largest value of y^3 (1 - y)."""

Whole = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Chart:
    """A chart; arrays have the shape (n1, n2) of the axes.

    Attributes:
        names, axes: of both axes.
        mu: effective damping; below 0 no steady motion is stable.
        limit: mu_c at nu = w0/3, under which there are folds.
        low, high: frequencies of the folds; NaN where there is none, or where it lies too far away.
        peak, at: largest amplitude and its frequency; NaN where mu <= 0, or where it lies too far away.
        omega: frequency at which stable amplitudes were counted; None if not.
        count, largest: their number, and the largest of them, NaN where there is none.
    """

    names: tuple[str, str]
    axes: tuple[Array, Array]
    mu: Array
    limit: Array
    low: Array
    high: Array
    peak: Array
    at: Array
    omega: float | None
    count: Whole
    largest: Array

    @property
    def folds(self) -> Whole:
        """Number of folds of the resonance curve; 1 where the other lies too far away."""
        found: Whole = np.isfinite(self.low).astype(np.int64) + np.isfinite(self.high)
        return found

    @property
    def width(self) -> Array:
        """Width of the range of frequencies with three amplitudes; 0 without folds, NaN where one lies too far away."""
        width: Array = np.where(self.folds == 0, 0.0, self.high - self.low)
        return width

    def table(self) -> dict[str, Array]:
        """Return columns with one row per point."""
        first, second = np.meshgrid(*self.axes, indexing="ij")
        columns = {
            self.names[0]: first, self.names[1]: second, "mu": self.mu, "mu_c": self.limit, "folds": self.folds,
            "fold_low": self.low, "fold_high": self.high, "width": self.width, "peak_alpha": self.peak,
            "peak_omega": self.at,
        }  # fmt: skip
        if self.omega is not None:
            columns |= {"stable_amplitudes": self.count, "largest_stable_alpha": self.largest}
        return {name: np.ravel(values) for name, values in columns.items()}


def chart(
    pair: GearPair, axes: Sequence[tuple[str, Array]], *, omega: float | None = None, mode: str = "corrected"
) -> Chart:
    """Return a chart over two parameters.

    Args:
        pair: the gear pair; axes: two of AXES with their values.
        omega: excitation frequency at which to count stable amplitudes besides; mode: of `firstorder.MODES`.

    Raises:
        InputError: not two different axes, values that can't be, or too many points.
    """
    _check(axes)
    changed = changes(axes)
    shape = (axes[0][1].size, axes[1][1].size)
    start = coefficients(pair, np.full(shape, pair.w0 / 3.0), mode, **changed)
    (first, folded), (second, folded_too) = (_fold(pair, mode, changed, shape, upper=upper) for upper in (False, True))
    low, high = np.sort(np.where(folded & folded_too, [_near(pair, first), _near(pair, second)], np.nan), axis=0)
    at, peak = _peak(pair, mode, changed, shape)
    seen = (start.mu > 0.0) & np.isfinite(_near(pair, at))
    count, largest = _counted(pair, omega, mode, changed, shape)
    return Chart(
        names=(axes[0][0], axes[1][0]),
        axes=(axes[0][1], axes[1][1]),
        mu=start.mu,
        limit=critical_damping(start),
        low=low,
        high=high,
        peak=np.where(seen, peak, np.nan),
        at=np.where(seen, at, np.nan),
        omega=omega,
        count=count,
        largest=largest,
    )


def changes(axes: Sequence[tuple[str, Array]]) -> dict[str, Array]:
    """Return the parameters of both axes as arrays that broadcast to the chart."""
    found: dict[str, Array] = {}
    for k, (name, values) in enumerate(axes):
        placed = values[:, None] if k == 0 else values[None, :]
        found |= dict.fromkeys(("tau_d", "tau_v") if name == "tau" else (name,), placed)
    return found


def _check(axes: Sequence[tuple[str, Array]]) -> None:
    for name, values in axes:
        if name not in AXES:
            raise InputError(f"--map {name}", "one of " + ", ".join(AXES), name)
        if name.startswith("tau") and np.min(values) < 0.0:
            raise InputError(f"--map {name}", "delays of at least 0", f"{np.min(values):g}")
        if np.any(np.diff(values) <= 0.0):
            raise InputError(f"--map {name}", "values in ascending order", f"{values[0]:g}, {values[1]:g}, ...")
    names = [name for name, _ in axes]
    both = {*names} == {"tau", "tau_d"} or {*names} == {"tau", "tau_v"}
    if len({*names}) != 2 or len(names) != 2 or both:
        raise InputError("--map", "two different axes", " and ".join(names))
    points = axes[0][1].size * axes[1][1].size
    if points > MOST_POINTS:
        raise InputError("--map", f"at most {MOST_POINTS} points", str(points))


def _near(pair: GearPair, omega: Array) -> Array:
    """Return frequencies, NaN where they lie too far from the resonance."""
    near: Array = np.where(np.abs(3.0 * omega / pair.w0 - 1.0) < FURTHEST, omega, np.nan)
    return near


def _moved(pair: GearPair, omega: Array, c: Coefficients, s: Array) -> Array:
    """Return the frequency at which S would be Gam s if Lam didn't change, kept within the range."""
    moved: Array = omega + pair.eps * (c.bend * s - c.shift) / 3.0
    return np.clip(moved, (1.0 - OUTSIDE) * pair.w0 / 3.0, (1.0 + OUTSIDE) * pair.w0 / 3.0)


def _fold(
    pair: GearPair, mode: str, changed: Mapping[str, Array], shape: tuple[int, int], *, upper: bool
) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Return the frequency of a fold, of the upper or the lower branch, and whether there is one."""
    omega = np.full(shape, pair.w0 / 3.0)
    for _ in range(ITERATIONS):
        c = coefficients(pair, omega, mode, **changed)
        m, w = np.maximum(np.abs(c.mu / c.bend), 1e-12), np.abs(c.drive / c.bend)
        size = m**6 / (4.0 * w**4)
        reached = np.minimum(size, MOST)
        y = np.ones(shape) if upper else np.minimum(np.cbrt(reached), 0.7)
        for _ in range(NEWTON):
            slope = y**2 * (3.0 - 4.0 * y)
            y = y - np.where(slope == 0.0, 0.0, (y**3 * (1.0 - y) - reached) / np.where(slope == 0.0, 1.0, slope))
            y = np.clip(y, 0.75, 1.0) if upper else np.clip(y, 0.0, 0.75)
        a = np.maximum((w / m) ** 2 * y, 1e-100)
        moved = _moved(pair, omega, c, a + w**2 / (2.0 * a**2))
        done = float(np.max(np.abs(moved - omega))) < 1e-14 * pair.w0
        omega = moved
        if done:
            break
    return omega, size < MOST


def _peak(pair: GearPair, mode: str, changed: Mapping[str, Array], shape: tuple[int, int]) -> tuple[Array, Array]:
    """Return frequency and height of the peak."""
    omega = np.full(shape, pair.w0 / 3.0)
    for _ in range(ITERATIONS):
        c = coefficients(pair, omega, mode, **changed)
        height = np.abs(c.drive) / np.maximum(np.abs(c.mu), 1e-12)
        moved = _moved(pair, omega, c, height**2)
        done = float(np.max(np.abs(moved - omega))) < 1e-14 * pair.w0
        omega = moved
        if done:
            break
    return omega, height


def _counted(
    pair: GearPair, omega: float | None, mode: str, changed: Mapping[str, Array], shape: tuple[int, int]
) -> tuple[Whole, Array]:
    """Return number and size of the stable amplitudes at one frequency."""
    if omega is None:
        return np.zeros(shape, dtype=np.int64), np.full(shape, np.nan)
    c = coefficients(pair, np.full(shape, omega), mode, **changed)
    flat = Coefficients(*(np.ravel(value) for value in (c.mu, c.shift, c.bend, c.drive, c.forced)))
    alpha, stable = amplitudes(flat, mode)
    largest = np.max(np.where(stable, alpha, -np.inf), axis=1)
    count: Whole = stable.sum(axis=1)
    return count.reshape(shape), np.where(count > 0, largest, np.nan).reshape(shape)
