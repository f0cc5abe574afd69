"""Restoring forces of a gear pair: the backlash itself, and the cubic that stands for it (paper Eq. 66)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array


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
    """

    interval: float
    delta_1: float
    delta_2: float
    error: float


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
    return Fit(interval, float(d1), float(d2), float(np.sqrt(max(left, 0.0) / square)))
