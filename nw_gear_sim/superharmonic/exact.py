"""Branches of the delay equation itself over the frequency, with the stability of every point."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.floquet import is_stable
from nw_gear_sim.superharmonic.harmonics import NoOrbit, Orbit
from nw_gear_sim.superharmonic.jumps import Jump, of_path
from nw_gear_sim.superharmonic.laws import balance_of, first_orbit
from nw_gear_sim.superharmonic.pair import GearPair

ARC = {"cubic": 0.1, "backlash": 0.25}
"""Longest step along a branch, in amplitude or in frequency over eps."""
MOST_POINTS = 3000


@dataclass(frozen=True)
class ExactPoint:
    """A periodic orbit of the delay equation: frequency, amplitude of its third harmonic, whether it is stable."""

    omega: float
    alpha: float
    stable: bool


@dataclass(frozen=True)
class ExactBranch:
    """A branch in the order in which it was followed, and the jumps at its folds.

    Attributes:
        points: along it; jumps: at its folds.
        whole: whether it was followed to the end of the range.
    """

    points: tuple[ExactPoint, ...]
    jumps: tuple[Jump, ...]
    whole: bool

    def as_object(self) -> dict[str, Any]:
        """Return what JSON shows."""
        return {
            "exact": [{"omega": p.omega, "alpha": p.alpha, "stable": p.stable} for p in self.points],
            "exact_jumps": [jump.as_object() for jump in self.jumps],
            "exact_whole": self.whole,
        }


def orbits(pair: GearPair, low: float, high: float, slope: float | None) -> tuple[list[Orbit], bool]:
    """Follow the branch from one frequency to another, and say whether it got there.

    With a backlash a branch may end where orbits graze a flank, or run on in ever smaller folds: then what was found
    until there is returned.

    Raises:
        NoOrbit: there is none to begin with.
    """
    balance = balance_of(pair, slope)
    found: list[Orbit] = []
    try:
        for orbit in balance.follow(
            first_orbit(balance, low), high, ARC["cubic" if slope is None else "backlash"], most=MOST_POINTS
        ):
            found.append(orbit)
    except NoOrbit:
        if not found:
            raise
        return found, False
    return found, len(found) < MOST_POINTS


def exact_branch(pair: GearPair, axis: Array, slope: float | None = None) -> ExactBranch:
    """Return the delay equation's branch between the ends of an axis of frequencies.

    Args:
        pair: the gear pair; axis: (n,) frequencies; slope: of a true backlash in the place of the cubic.

    Raises:
        InputError: a single frequency.
        NoOrbit: there is no periodic orbit to begin with.
    """
    if len(axis) < 2:
        raise InputError("--omega", "a range for the delay equation's branch", "one frequency")
    balance = balance_of(pair, slope)
    found, whole = orbits(pair, float(axis[0]), float(axis[-1]), slope)
    points = tuple(ExactPoint(o.omega, o.amplitude(3), is_stable(balance, o)) for o in found)
    omega, alpha = np.array([p.omega for p in points]), np.array([p.alpha for p in points])
    return ExactBranch(points, of_path(omega, alpha, [p.stable for p in points]), whole)


def orbits_at(pair: GearPair, omega: float, low: float, high: float, slope: float | None) -> list[tuple[Orbit, bool]]:
    """Return all orbits of the branch at one frequency, each with whether it is stable, lowest amplitude first.

    Branches that don't hang together with the one that starts at `low` are missed.

    Raises:
        InputError: the frequency isn't inside the range.
        NoOrbit: there is no periodic orbit to begin with.
    """
    if not low < omega < high:
        raise InputError("omega", f"between {low:g} and {high:g}", f"{omega:g}")
    balance = balance_of(pair, slope)
    path, _ = orbits(pair, low, high, slope)
    passed: list[Orbit] = []
    for before, after in itertools.pairwise(path):
        if (before.omega - omega) * (after.omega - omega) > 0.0 or before.omega == after.omega:
            continue
        part = (omega - before.omega) / (after.omega - before.omega)
        guess = before.coefficients + part * (after.coefficients - before.coefficients)
        try:
            found = balance.solve(omega, guess)
        except NoOrbit:
            continue
        if all(np.max(np.abs(found.coefficients - other.coefficients)) > 1e-6 for other in passed):
            passed.append(found)
    ordered = sorted(passed, key=lambda orbit: orbit.amplitude(3))
    return [(orbit, is_stable(balance, orbit)) for orbit in ordered]
