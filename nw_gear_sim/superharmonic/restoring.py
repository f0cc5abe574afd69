"""Restoring forces of a gear pair: the backlash itself, and the cubic that stands for it (paper Eq. 66)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.optimize import brentq

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array

STEEPEST, WIDEST = 2.2434, 1000.0
"""Half widths of intervals between which the fitted cubic has a stiffness above 0 in the middle, and bends upwards."""


class Restoring(Protocol):
    """A force over displacement, per mass."""

    def force(self, x: Array) -> Array:
        """Return the force at displacements x."""

    def stiffness(self, x: Array) -> Array:
        """Return its derivative."""


@dataclass(frozen=True)
class Cubic:
    """linear x + cubic x^3."""

    linear: float
    cubic: float

    def force(self, x: Array) -> Array:
        """Return linear x + cubic x^3."""
        return self.linear * x + self.cubic * x**3

    def stiffness(self, x: Array) -> Array:
        """Return linear + 3 cubic x^2."""
        return self.linear + 3.0 * self.cubic * x**2


@dataclass(frozen=True)
class Backlash:
    """stiffness f(x) with f the unit backlash: x - 1 above 1, 0 between -1 and 1, x + 1 below -1."""

    slope: float

    def force(self, x: Array) -> Array:
        """Return the force of the tooth pair."""
        return self.slope * unit_backlash(x)

    def stiffness(self, x: Array) -> Array:
        """Return its derivative; 0 within the gap."""
        return self.slope * (np.abs(x) > 1.0).astype(float)


@dataclass(frozen=True)
class Fit:
    """A cubic fitted to the unit backlash.

    Attributes:
        interval: X, half the width of the interval of the fit.
        delta_1, delta_2: coefficients of x and x^3.
        error: root mean square error over that of the backlash function itself.
        rms: root mean square error; greatest: largest error on the interval; both in the unit of x, half the backlash.
    """

    interval: float
    delta_1: float
    delta_2: float
    error: float
    rms: float
    greatest: float


def unit_backlash(x: Array) -> Array:
    """Return f(x): x - 1 above 1, 0 between -1 and 1, x + 1 below -1."""
    return np.sign(x) * np.maximum(np.abs(x) - 1.0, 0.0)


def fit_cubic(interval: float) -> Fit:
    """Fit delta_1 x + delta_2 x^3 to the unit backlash on [-X, X] by least squares, in closed form.

    The moments of f with b = 1 are int_1^X (x - 1) x^m dx.

    Raises:
        InputError: the interval doesn't reach beyond the gap.
    """
    if not interval > 1.0 or not np.isfinite(interval):
        raise InputError("interval of the cubic fit", "more than half the backlash, 1", f"{interval:g}")

    def moment(m: int) -> float:
        return (interval ** (m + 2) - 1.0) / (m + 2) - (interval ** (m + 1) - 1.0) / (m + 1)

    powers = np.array([[interval**3 / 3.0, interval**5 / 5.0], [interval**5 / 5.0, interval**7 / 7.0]])
    d1, d2 = np.linalg.solve(powers, [moment(1), moment(3)])
    square = (interval - 1.0) ** 3 / 3.0
    left = square - d1 * moment(1) - d2 * moment(3)
    rms = float(np.sqrt(max(left, 0.0) / interval))
    return Fit(
        interval, float(d1), float(d2), float(np.sqrt(max(left, 0.0) / square)), rms, _greatest(interval, d1, d2)
    )


def interval_of(ratio: float) -> float:
    """Return the half width X of the interval on which the fitted cubic has delta_2/delta_1 = ratio.

    The ratio falls from infinity at X = 2.2433, where delta_1 = 0, as 1/X^3; so there is one X.

    Raises:
        InputError: no such cubic is the fit of a backlash on an interval up to X = 1000.
    """

    def excess(interval: float) -> float:
        fit = fit_cubic(interval)
        return fit.delta_2 - ratio * fit.delta_1

    if not excess(WIDEST) < 0.0:
        raise InputError(
            "delta_2/delta_1 of the cubic", f"that of a fit up to {WIDEST:g} half backlashes", f"{ratio:g}"
        )
    return float(brentq(excess, STEEPEST, WIDEST, xtol=1e-12))


def _greatest(interval: float, d1: float, d2: float) -> float:
    """Return the largest error: at an end of the interval or of the gap, or where the slopes are the same."""
    flat_inside, flat_outside = -d1 / (3.0 * d2), (1.0 - d1) / (3.0 * d2)
    places = [1.0, interval]
    places += [np.sqrt(flat_inside)] if 0.0 < flat_inside < 1.0 else []
    places += [np.sqrt(flat_outside)] if 1.0 < flat_outside < interval**2 else []
    x = np.array(places)
    return float(np.max(np.abs(d1 * x + d2 * x**3 - unit_backlash(x))))
