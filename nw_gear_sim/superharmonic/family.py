"""Families of superharmonic curves: over the frequency or a parameter, one for each value of another."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from typing import Any

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.firstorder import OMEGA, TRUSTED, Branches, branches, coefficients
from nw_gear_sim.superharmonic.floquet import is_stable
from nw_gear_sim.superharmonic.harmonics import Balance
from nw_gear_sim.superharmonic.pair import PARAMETERS, GearPair

POINTS = 801
ARC = 0.1
"""Longest step along an exact branch, in amplitude or in frequency over eps."""


@dataclass(frozen=True)
class ExactPoint:
    """A periodic orbit of the delay equation: frequency, amplitude of its third harmonic, whether it is stable."""

    omega: float
    alpha: float
    stable: bool


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve of a family.

    Attributes:
        name: what tells it from the others, in words; "" for a single curve.
        pair: its gear pair.
        over: what it runs over: `omega` or a parameter.
        omega: excitation frequency of a curve over a parameter.
        branches: the first-order solution; exact: the delay equation's branch over the frequency, where wanted.
    """

    name: str
    pair: GearPair
    over: str
    omega: float | None
    branches: Branches
    exact: tuple[ExactPoint, ...] | None

    def highest(self) -> tuple[float, float]:
        """Return the largest amplitude of the first order, and where."""
        k = int(np.nanargmax(np.nanmax(self.branches.alpha, axis=1)))
        return float(np.nanmax(self.branches.alpha[k])), float(self.branches.values[k])

    def as_object(self) -> dict[str, Any]:
        """Return what JSON shows; `trust` is the largest eps 3 q Lam^2/w0 over its limit."""
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
            "trust": float(np.max(b.trust)) / TRUSTED,
            "points": points,
            "folds": list(b.folds),
        }
        if self.exact is not None:
            shown["exact"] = [{"omega": p.omega, "alpha": p.alpha, "stable": p.stable} for p in self.exact]
        return shown


def usual_frequencies(pair: GearPair, mode: str) -> Array:
    """Return frequencies that show the whole resonance: twice its width to either side of backbone and peak."""
    c = coefficients(pair, pair.w0 / 3.0, mode)
    mu, bend = max(abs(float(c.mu)), 1e-3), float(c.bend)
    foot = pair.w0 / 3.0 - pair.eps * float(c.shift) / 3.0
    rise = min(bend * float(c.drive / mu) ** 2, 20.0)
    width = 6.0 * max(mu, 0.05)
    return np.linspace(foot - pair.eps * width / 3.0, foot + pair.eps * (rise + width) / 3.0, POINTS)


def curves(
    pair: GearPair,
    mode: str,
    frequencies: Array | None,
    *,
    over: tuple[str, Array] | None = None,
    family: tuple[str, Array] | None = None,
    exact: bool = False,
) -> list[Curve]:
    """Return a family of curves.

    Args:
        pair: the gear pair; mode: of `firstorder.MODES`.
        frequencies: excitation frequencies, ascending; those of the resonance if None.
        over: parameter and its values in the place of the frequency: one curve for each frequency.
        family: parameter and the values that have a curve each.
        exact: add the branch of the delay equation to curves over the frequency.

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
        return [
            Curve(f"omega = {w:g}", pair, over[0], float(w), branches(pair, *over, omega=float(w), mode=mode), None)
            for w in frequencies
        ]
    name, listed = family if family is not None else ("", np.array([np.nan]))
    made = []
    for value in listed:
        member = pair.having(**{name: float(value)}) if name else pair
        axis = usual_frequencies(member, mode) if frequencies is None else frequencies
        label = f"{name} = {value:g}" if name else f"stage {pair.stage}"
        branch = _exact(member, axis) if exact else None
        made.append(Curve(label, member, OMEGA, None, branches(member, OMEGA, axis, mode=mode), branch))
    return made


def _exact(pair: GearPair, axis: Array) -> tuple[ExactPoint, ...]:
    if len(axis) < 2:
        raise InputError("--omega", "a range for --exact", "one frequency")
    balance = Balance(pair)
    orbits = balance.follow(balance.solve(float(axis[0])), float(axis[-1]), ARC)
    return tuple(ExactPoint(o.omega, o.amplitude(3), is_stable(balance, o)) for o in orbits)


def as_csv(made: list[Curve]) -> str:
    """Return one line per amplitude: curve, method, what it runs over, amplitude, stability."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["curve", "method", "over", "value", "alpha", "stable"])
    for curve in made:
        for point in curve.as_object()["points"]:
            value = point[curve.over]
            writer.writerow([curve.name, "first order", curve.over, value, point["alpha"], point["stable"]])
        for orbit in curve.exact or ():
            writer.writerow([curve.name, "harmonic balance", OMEGA, orbit.omega, orbit.alpha, orbit.stable])
    return text.getvalue()
