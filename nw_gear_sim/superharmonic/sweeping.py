"""Sweeps in time: the delay equation integrated while its frequency is stepped up and down, the motion carried on.

At each frequency the motion goes on from where it was, with its history, until the harmonics of one period after
another change no more; then alpha is read off, and the frequency takes its next value at a whole period, where the
phase is 0.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.harmonics import NoOrbit, Orbit
from nw_gear_sim.superharmonic.jumps import Jump
from nw_gear_sim.superharmonic.lanes import Stepper, advance, stepper
from nw_gear_sim.superharmonic.laws import balance_of, project
from nw_gear_sim.superharmonic.pair import GearPair

MOST_PERIODS = 2000
STEPS_PER_PERIOD = {"cubic": 200, "backlash": 400}
BLOCK = 10
"""Periods between two looks at the harmonics."""
SETTLED = 2e-5
"""Change that may still come, relative to the motion."""
WATCHED = 16
"""Periods looked at one by one where the motion doesn't settle: subharmonics up to half of it are told."""
REPEATED = 1e-3
"""Difference up to which two periods are the same, relative to the motion."""
ORDER = 9
SMALL_STEP = 0.02
"""Part of the largest alpha up to which a step of alpha isn't looked into."""
FOLLOWING, MOST_FOLLOWED = 0.05, 200
"""Step along a branch, and steps at most, where a step of alpha is looked into."""


@dataclass(frozen=True, eq=False)
class Step:
    """One frequency of a sweep.

    Attributes:
        omega: frequency; direction: `up` or `down`.
        alpha: amplitude of the third harmonic, over `repeats` periods; low, high: its range from period to period.
        repeats: after how many periods of the excitation the motion repeats itself; 0: after none up to WATCHED/2.
        periods: that it took.
        coefficients: (2 ORDER + 1,) harmonics of the last period.
    """

    omega: float
    direction: str
    alpha: float
    low: float
    high: float
    repeats: int
    periods: int
    coefficients: Array

    @property
    def settled(self) -> bool:
        """Whether the motion has the period of the excitation."""
        return self.repeats == 1


@dataclass(frozen=True)
class Sweep:
    """Steps in the order of time, up first, and the jumps among them."""

    steps: tuple[Step, ...]
    jumps: tuple[Jump, ...]

    def table(self) -> dict[str, list[Any]]:
        """Return columns with one row per step."""
        names = ("direction", "omega", "alpha", "low", "high", "repeats", "settled", "periods")
        return {name: [getattr(step, name) for step in self.steps] for name in names}

    def as_object(self) -> dict[str, Any]:
        """Return what JSON shows."""
        columns = self.table()
        return {
            "steps": [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)],
            "jumps": [jump.as_object() for jump in self.jumps],
        }


def sweep(
    pair: GearPair,
    frequencies: Array,
    *,
    slope: float | None = None,
    periods: int = MOST_PERIODS,
    say: Callable[[int, int], None] = lambda _done, _total: None,
) -> Sweep:
    """Sweep up through the frequencies and down again, from rest.

    Args:
        pair: the gear pair; frequencies: (n,) ascending, at least two.
        slope: of a true backlash in the place of the cubic; periods: at most at each frequency.
        say: told how many steps are done, of how many.

    Raises:
        InputError: too few frequencies or periods, or a delay too short to be integrated.
    """
    if len(frequencies) < 2:
        raise InputError("--omega", "a range of frequencies for --sweep", f"{len(frequencies)} frequency")
    if periods < 3 * BLOCK:
        raise InputError("--periods", f"at least {3 * BLOCK} for --sweep", str(periods))
    least = STEPS_PER_PERIOD["cubic" if slope is None else "backlash"]
    history: tuple[Array, Array, Array] | None = None
    h, made = 1.0, []
    path = [("up", w) for w in frequencies] + [("down", w) for w in frequencies[::-1]]
    for direction, omega in path:
        step = stepper(pair, float(omega), slope, least)
        history = _at_rest(step) if history is None else _resampled(history, h, step)
        history, found = _settle(step, history, periods, direction)
        h = step.h
        made.append(found)
        say(len(made), len(path))
    return Sweep(tuple(made), tuple(_jumps(pair, made, slope)))


def _at_rest(step: Stepper) -> tuple[Array, Array, Array]:
    rows = step.back + 1
    return np.zeros((rows, 1)), np.zeros((rows, 1)), np.zeros((rows, 1))


def _resampled(history: tuple[Array, Array, Array], h: float, step: Stepper) -> tuple[Array, Array, Array]:
    """Return the same motion at another step, back from the present.

    A history that is too short for a lower frequency's rounding is held at its first value.
    """
    times = h * np.arange(-len(history[0]) + 1, 1)
    wanted = np.maximum(step.h * np.arange(-step.back, 1), times[0])
    x, v, a = (CubicSpline(times, part[:, 0])(wanted)[:, None] for part in history)
    return x, v, a


def _settle(
    step: Stepper, history: tuple[Array, Array, Array], periods: int, direction: str
) -> tuple[tuple[Array, Array, Array], Step]:
    """Go on until the motion repeats itself, and read it off.

    With changes d_k of the harmonics from look to look, d_k r/(1 - r) is still to come, r = d_k/d_(k-1).
    """
    looks: list[Array] = []
    done, settled, before = 0, False, math.inf
    while done + BLOCK <= periods and not settled:
        history = advance(step, history, BLOCK)
        done += BLOCK
        looks.append(project(history[0][-step.steps - 1 : -1, 0], ORDER))
        if len(looks) < 3:
            continue
        size = float(np.linalg.norm(looks[-1]))
        change = float(np.linalg.norm(looks[-1] - looks[-2]))
        ratio = change / before if before > 0.0 else 0.0
        before = change
        rest = change * ratio / (1.0 - ratio) if ratio < 1.0 else math.inf
        settled = change <= 1e-13 * size or (max(rest, 0.1 * change) < SETTLED * size)
    if settled:
        alpha = _alpha(looks[-1])
        return history, Step(step.omega, direction, alpha, alpha, alpha, 1, done, looks[-1])
    history, looks, repeats = _watched(step, history)
    alphas = [_alpha(look) for look in looks]
    mean = _alpha(np.mean(looks[-repeats:] if repeats else looks, axis=0))
    return history, Step(step.omega, direction, mean, min(alphas), max(alphas), repeats, done + WATCHED, looks[-1])


def _watched(step: Stepper, history: tuple[Array, Array, Array]) -> tuple[tuple[Array, Array, Array], list[Array], int]:
    """Go on period by period: the harmonics of each, and after how many the motion repeats itself, 0 if it doesn't."""
    looks = []
    for _ in range(WATCHED):
        history = advance(step, history, 1)
        looks.append(project(history[0][-step.steps - 1 : -1, 0], ORDER))
    size = float(np.linalg.norm(looks[-1]))
    for k in range(1, WATCHED // 2 + 1):
        if max(float(np.linalg.norm(a - b)) for a, b in zip(looks[k:], looks[:-k], strict=True)) < REPEATED * size:
            return history, looks, k
    return history, looks, 0


def _alpha(look: Array) -> float:
    """Return the amplitude of the third harmonic."""
    return float(np.hypot(look[3], look[ORDER + 3]))


def _jumps(pair: GearPair, steps: Sequence[Step], slope: float | None) -> list[Jump]:
    """Return the steps at which the motion left its branch.

    Where alpha changes much, the branch is followed from the orbit before: if it turns back on its way, there is a fold
    between both frequencies, and the motion jumped there. If it arrives elsewhere, the jump is put in the middle.
    """
    most = max(step.alpha for step in steps)
    found = []
    for before, after in itertools.pairwise(steps):
        if before.omega == after.omega or abs(after.alpha - before.alpha) < SMALL_STEP * most:
            continue
        place = _left(pair, before, after, slope)
        if place is not None:
            found.append(Jump(*place, after.alpha if after.settled else None, before.direction, real=True))
    return found


def _left(pair: GearPair, before: Step, after: Step, slope: float | None) -> tuple[float, float] | None:
    """Return where the motion left its branch, and its alpha there; None where it didn't."""
    halfway = (0.5 * (before.omega + after.omega), before.alpha)
    if not before.settled:
        return None
    balance = balance_of(pair, slope)
    try:
        orbit = balance.solve(before.omega, _longer(before.coefficients, balance.order))
        alpha = orbit.amplitude(3)
        last: Orbit = orbit
        for here in balance.follow(orbit, after.omega, FOLLOWING, most=MOST_FOLLOWED):
            if (here.omega - last.omega) * (after.omega - before.omega) < 0.0:
                return last.omega, last.amplitude(3)
            last, alpha = here, here.amplitude(3)
        arrived = balance.solve(after.omega, last.coefficients).amplitude(3)
    except NoOrbit:
        return halfway
    near = abs(arrived - after.alpha) < 0.25 * abs(after.alpha - before.alpha) + 1e-3 * alpha
    return None if near else halfway


def _longer(coefficients: Array, order: int) -> Array:
    """Return coefficients of ORDER harmonics with zeros up to another order."""
    long = np.zeros(2 * order + 1)
    long[: ORDER + 1], long[order + 1 : order + 1 + ORDER] = coefficients[: ORDER + 1], coefficients[ORDER + 1 :]
    return long
