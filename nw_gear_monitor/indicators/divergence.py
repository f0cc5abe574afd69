"""How fast neighbours part: the line through a divergence curve, and how much of a line it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array

LEAST_POINTS = 3
"""Points of a curve that a line is fitted through, at least."""
LEAST_REFERENCES = 50
"""Points followed, at least, for a curve that says something."""
SPAN = (0.2, 0.7)
"""Part of the rise from the first distance to the size of the attractor within which the curve counts as growing: a
compromise between Hénon's and Rössler's systems, which want it lower, and Lorenz' flow, which wants it higher."""


@dataclass(frozen=True, eq=False)
class Divergence:
    """Outcome of Rosenstein's and of Kantz' method.

    Attributes:
        exponent: slope of the fitted line, nats per unit time (per step where the rate is 1).
        standard_error: of the slope by the scatter about the line, same unit; points of a curve aren't independent, so
            the true error is larger.
        r_squared: share of the curve's variance over the fitted steps that the line explains.
        growth: rise of the line over the fitted steps, nats.
        first, last: first and last step of the fit.
        saturation: logarithm of the distance of points that have nothing to do with each other.
        curve: (horizon + 1,) mean logarithm of the distance after 0, 1, .. steps.
        references: number of points whose neighbours were followed.
    """

    exponent: float
    standard_error: float
    r_squared: float
    growth: float
    first: int
    last: int
    saturation: float
    curve: Array
    references: int

    @property
    def exponential(self) -> bool:
        """Whether neighbours were seen to part exponentially.

        The line explains 95 % of 5 steps or more and rises by a nat or more, with 50 points followed or more. Where
        this is False the exponent is the slope of something else: noise, whose neighbours part at once, or a regular
        motion, whose neighbours don't. True doesn't prove chaos: see the limits of the method.
        """
        enough = self.references >= LEAST_REFERENCES and self.last - self.first >= 4
        return enough and self.r_squared >= 0.95 and self.growth >= 1.0


def growing(curve: Array, saturation: float) -> tuple[int, int]:
    """First and last step between which a curve grows: from 20 to 70 % of the way from its beginning to saturation.

    Where it never gets there the range ends with the curve; it has LEAST_POINTS points at least.
    """
    rise = saturation - curve[0]
    low, high = (curve[0] + share * rise for share in SPAN)
    over = np.flatnonzero(curve > high)
    last = int(over[0]) - 1 if rise > 0.0 and over.size else curve.size - 1
    under = np.flatnonzero(curve[: last + 1] < low)
    first = int(under[-1]) + 1 if rise > 0.0 and under.size and over.size else 0
    last = min(max(last, first + LEAST_POINTS - 1), curve.size - 1)
    return max(min(first, last - LEAST_POINTS + 1), 0), last


def fitted(curve: Array, saturation: float, references: int, rate: float, fit: tuple[int, int] | None) -> Divergence:
    """Fit a line through a part of a divergence curve by least squares.

    Args:
        curve: (steps,) mean logarithm of the distance.
        saturation: logarithm of the distance of unrelated points.
        references: number of points followed.
        rate: steps per unit time.
        fit: first and last step; None finds them by `growing`.

    Raises:
        InputError: a range outside the curve or of fewer than 3 steps.
    """
    first, last = growing(curve, saturation) if fit is None else fit
    if first < 0 or not first + LEAST_POINTS - 1 <= last < curve.size:
        expected = f"first and last step within 0 to {curve.size - 1}, {LEAST_POINTS} steps or more"
        raise InputError("fit", expected, f"{first} to {last}")
    y = curve[first : last + 1]
    k = np.arange(y.size) - 0.5 * (y.size - 1)
    square = float(k @ k)
    slope = float(k @ y) / square
    about = y - y.mean()
    rest, total = float(np.sum((about - slope * k) ** 2)), float(about @ about)
    return Divergence(
        exponent=slope * rate,
        standard_error=float(np.sqrt(rest / (y.size - 2) / square)) * rate,
        r_squared=max(1.0 - rest / total, 0.0) if total > 0.0 else 0.0,
        growth=slope * (last - first),
        first=first,
        last=last,
        saturation=saturation,
        curve=curve,
        references=references,
    )
