"""Jumps along a curve with folds: where a slow sweep falls off a branch, and onto which it lands (A1-A4 of Figs 22-24).

With the points named as the paper does: A3 is the end of the upper branch and A1 the point of the lower one beside it,
A2 is the end of the lower branch and A4 the point of the upper one beside it. A sweep falls from A3 to A1, and on its
way back rises from A2 to A4.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.firstorder import Branches, Coefficients

NAMES = {True: ("A3", "A1"), False: ("A2", "A4")}
"""Names of both ends of a jump: from the upper branch, and from the lower one."""


@dataclass(frozen=True)
class Jump:
    """One jump.

    Attributes:
        value: where, on the axis of the curve: a fold.
        start, end: amplitudes before and after; no end where nothing steady is known to land on.
        sweep: `up` or `down`, the direction along the axis in which it is met.
        real: whether what it leaves and what it lands on are stable; otherwise nobody sees it.
    """

    value: float
    start: float
    end: float | None
    sweep: str
    real: bool

    @property
    def names(self) -> tuple[str, str]:
        """Names of the points it leads from and to."""
        return ("", "another motion") if self.end is None else NAMES[self.start > self.end]

    def as_object(self) -> dict[str, Any]:
        """Return what JSON shows."""
        first, last = self.names
        return {
            "at": self.value,
            "sweep": self.sweep,
            "from": {"point": first, "alpha": self.start},
            "to": {"point": last, "alpha": self.end},
            "stable": self.real,
        }

    def in_words(self, over: str) -> str:
        """Return the jump as a sentence's part."""
        first, last = self.names
        seen = "" if self.real else " (not seen: unstable on one side)"
        landing = last if self.end is None else f"{last} {self.end:.4g}"
        return f"{self.sweep} at {over} = {self.value:.6g}: {first} {self.start:.4g} to {landing}{seen}".replace(
            ":  ", ": "
        )


def of_branches(branches: Branches, at: dict[float, Coefficients]) -> tuple[Jump, ...]:
    """Return the jumps at the folds of a first-order solution.

    At a fold two roots a of the cubic in a = alpha^2 are the same: a = (2 s +- sqrt(s^2 - 3 m^2))/3, where the cubic
    is 0, and the third one is 2 s - 2 a, with s = S/Gam and m = mu/Gam.

    Args:
        branches: the solution; at: the coefficients at each of its folds.
    """
    several = branches.multivalued
    found = []
    for fold, c in at.items():
        merged, other = _amplitudes(c)
        after = int(np.clip(np.searchsorted(branches.values, fold), 1, len(several) - 1))
        up = bool(several[after - 1])
        inside = after - 1 if up else after
        alpha, stable = branches.alpha[inside], branches.stable[inside]
        left, landed = (2, 0) if merged > other else (0, 2)
        real = bool(stable[left] and stable[landed]) and bool(np.isfinite(alpha[2]))
        found.append(Jump(fold, merged, other, "up" if up else "down", real))
    return tuple(found)


def _amplitudes(c: Coefficients) -> tuple[float, float]:
    s, m, w = (float(np.ravel(value)[0]) for value in (c.shift / c.bend, c.mu / c.bend, c.drive / c.bend))
    root = np.sqrt(max(s**2 - 3.0 * m**2, 0.0))
    double = np.array([(2.0 * s + root) / 3.0, (2.0 * s - root) / 3.0])
    left = np.abs(double * (m**2 + (s - double) ** 2) - w**2)
    merged = float(double[np.argmin(left)])
    return float(np.sqrt(merged)), float(np.sqrt(max(2.0 * s - 2.0 * merged, 0.0)))


def of_path(omega: Array, alpha: Array, stable: list[bool]) -> tuple[Jump, ...]:
    """Return the jumps at the folds of a branch that was followed point by point.

    A fold is the vertex of the parabola through the three points about it; what a sweep lands on is read off the
    stretches between folds. Jumps onto other branches than the one followed aren't known here.

    Args:
        omega, alpha, stable: (n,) points along the branch.
    """
    forward = np.sign(np.diff(omega))
    turns = np.flatnonzero(forward[1:] != forward[:-1]) + 1
    edges = [0, *turns.tolist(), len(omega) - 1]
    found = []
    for number, k in enumerate(turns.tolist()):
        value, merged = _vertex(omega[k - 1 : k + 2], alpha[k - 1 : k + 2])
        up = bool(forward[k - 1] > 0.0)
        stretches = [j for j in range(len(edges) - 1) if j not in (number, number + 1)]
        met = [_on(omega[edges[j] : edges[j + 1] + 1], alpha[edges[j] : edges[j + 1] + 1], value) for j in stretches]
        steady = [stable[(edges[j] + edges[j + 1]) // 2] for j in stretches]
        landings = [end for end, safe in zip(met, steady, strict=True) if end is not None and safe]
        left = bool(stable[max(k - 2, edges[number])] if up else stable[min(k + 2, edges[number + 2])])
        end = min(landings, key=lambda a: abs(a - merged), default=None)
        found.append(Jump(value, merged, end, "up" if up else "down", left))
    return tuple(found)


def _vertex(omega: Array, alpha: Array) -> tuple[float, float]:
    """Return place and height of a fold: the extremum of the parabola omega(alpha) through three points."""
    a, b, _ = np.polyfit(alpha - alpha[1], omega - omega[1], 2)
    if a == 0.0:
        return float(omega[1]), float(alpha[1])
    top = float(np.clip(-0.5 * b / a, *np.sort([alpha[0] - alpha[1], alpha[2] - alpha[1]])))
    return float(omega[1] + a * top**2 + b * top), float(alpha[1] + top)


def _on(omega: Array, alpha: Array, value: float) -> float | None:
    """Return the amplitude where a stretch without folds passes a frequency; None where it doesn't."""
    if not omega.min() <= value <= omega.max():
        return None
    order = np.argsort(omega)
    return float(np.interp(value, omega[order], alpha[order]))
