"""Families of superharmonic curves: over the frequency or a parameter, one for each value of another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.exact import ExactBranch, exact_branch
from nw_gear_sim.superharmonic.firstorder import OMEGA, TRUSTED, Branches, branches, coefficients
from nw_gear_sim.superharmonic.jumps import Jump, of_branches
from nw_gear_sim.superharmonic.pair import PARAMETERS, GearPair

POINTS = 801
BACKLASH_RANGE = (0.94, 1.12)
"""Frequencies over w0/3 between which the resonance with a true backlash is shown."""


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve of a family.

    Attributes:
        name: what tells it from the others, in words; "" for a single curve.
        pair: its gear pair.
        over: what it runs over: `omega` or a parameter.
        omega: excitation frequency of a curve over a parameter.
        branches: the first-order solution; exact: the delay equation's branch over the frequency, where wanted.
        jumps: of the first order, at its folds.
    """

    name: str
    pair: GearPair
    over: str
    omega: float | None
    branches: Branches
    exact: ExactBranch | None
    jumps: tuple[Jump, ...]

    @property
    def trust(self) -> float:
        """The largest eps 3 q Lam^2/w0 over its limit: above 1 the first order is off by more than about 5 %."""
        return float(np.max(self.branches.trust)) / TRUSTED

    def highest(self) -> tuple[float, float]:
        """Return the largest amplitude of the first order, and where."""
        k = int(np.nanargmax(np.nanmax(self.branches.alpha, axis=1)))
        return float(np.nanmax(self.branches.alpha[k])), float(self.branches.values[k])

    def as_object(self) -> dict[str, Any]:
        """Return what JSON shows."""
        b = self.branches
        points = [
            {
                "omega": float(value) if self.over == OMEGA else self.omega,
                **({} if self.over == OMEGA else {self.over: float(value)}),
                "alpha": float(b.alpha[k, j]),
                "stable": bool(b.stable[k, j]),
            }
            for k, value in enumerate(b.values)
            for j in range(3)
            if np.isfinite(b.alpha[k, j])
        ]
        shown: dict[str, Any] = {
            "name": self.name,
            "over": self.over,
            "trust": self.trust,
            "points": points,
            "folds": list(b.folds),
            "jumps": [jump.as_object() for jump in self.jumps],
        }
        if self.exact is not None:
            shown.update(self.exact.as_object())
        return shown


def usual_frequencies(pair: GearPair, mode: str) -> Array:
    """Return frequencies that show the resonance, twice its width to either side of backbone and peak, about w0/3."""
    c = coefficients(pair, pair.w0 / 3.0, mode)
    mu, bend = max(abs(float(c.mu)), 1e-3), float(c.bend)
    foot = pair.w0 / 3.0 - pair.eps * float(c.shift) / 3.0
    rise = min(bend * float(c.drive / mu) ** 2, 20.0)
    width = 6.0 * max(mu, 0.05)
    low, high = foot - pair.eps * width / 3.0, foot + pair.eps * (rise + width) / 3.0
    return np.linspace(max(low, pair.w0 / 6.0), min(high, pair.w0 / 2.0), POINTS)


def curves(
    pair: GearPair,
    mode: str,
    frequencies: Array | None,
    *,
    over: tuple[str, Array] | None = None,
    family: tuple[str, Array] | None = None,
    exact: bool = False,
    slope: float | None = None,
) -> list[Curve]:
    """Return a family of curves.

    Args:
        pair: the gear pair; mode: of `firstorder.MODES`.
        frequencies: excitation frequencies, ascending; those of the resonance if None.
        over: parameter and its values in the place of the frequency: one curve for each frequency.
        family: parameter and the values that have a curve each.
        exact: add the branch of the delay equation to curves over the frequency.
        slope: of a true backlash, c k_m, that the exact branch has in the place of the cubic.

    Raises:
        InputError: unknown parameter or mode, or combinations that make no curve.
        NoOrbit: an exact branch can't be followed.
    """
    for place, asked in (("--over", over), ("--family", family)):
        if asked is not None and asked[0] not in PARAMETERS:
            raise InputError(f"{place} {asked[0]}", "one of " + ", ".join(PARAMETERS), asked[0])
    if over is not None:
        if frequencies is None or exact or family is not None:
            raise InputError("--over", "with --omega, and without --exact and --family", over[0])
        return [_curve(f"omega = {w:g}", pair, over, float(w), mode) for w in frequencies]
    name, listed = family if family is not None else ("", np.array([np.nan]))
    made = []
    for value in listed:
        member = pair.having(**{name: float(value)}) if name else pair
        axis = usual(member, mode, slope) if frequencies is None else frequencies
        label = f"{name} = {value:g}" if name else f"stage {pair.stage}"
        branch = exact_branch(member, axis, slope) if exact else None
        made.append(_curve(label, member, (OMEGA, axis), None, mode, branch))
    return made


def usual(pair: GearPair, mode: str, slope: float | None) -> Array:
    """Return the frequencies that show the resonance; with a backlash it is wider and lies elsewhere."""
    near = usual_frequencies(pair, mode)
    if slope is None:
        return near
    low, high = (factor * pair.w0 / 3.0 for factor in BACKLASH_RANGE)
    return np.linspace(min(low, near[0]), max(high, near[-1]), POINTS)


def _curve(
    name: str, pair: GearPair, over: tuple[str, Array], omega: float | None, mode: str, exact: ExactBranch | None = None
) -> Curve:
    found = branches(pair, *over, omega=omega, mode=mode)
    at = {
        fold: coefficients(pair, fold, mode) if omega is None else coefficients(pair, omega, mode, **{over[0]: fold})
        for fold in found.folds
    }
    return Curve(name, pair, over[0], omega, found, exact, of_branches(found, at))


def table(made: list[Curve]) -> dict[str, list[Any]]:
    """Return columns with one row per amplitude: curve, method, what it runs over, amplitude, stability."""
    rows: list[tuple[Any, ...]] = []
    for curve in made:
        for point in curve.as_object()["points"]:
            rows.append((curve.name, "first order", curve.over, point[curve.over], point["alpha"], point["stable"]))
        for orbit in () if curve.exact is None else curve.exact.points:
            rows.append((curve.name, "harmonic balance", OMEGA, orbit.omega, orbit.alpha, orbit.stable))
    names = ("curve", "method", "over", "value", "alpha", "stable")
    return {name: [row[k] for row in rows] for k, name in enumerate(names)}
