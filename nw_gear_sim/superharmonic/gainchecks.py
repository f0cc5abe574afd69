"""A few points of a chart held against the delay equation: damping, folds and peak by harmonic balance."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from nw_gear_sim.superharmonic.exact import orbits
from nw_gear_sim.superharmonic.family import usual_frequencies
from nw_gear_sim.superharmonic.floquet import exponents
from nw_gear_sim.superharmonic.gainmap import Chart
from nw_gear_sim.superharmonic.harmonics import NoOrbit
from nw_gear_sim.superharmonic.jumps import of_path
from nw_gear_sim.superharmonic.laws import balance_of
from nw_gear_sim.superharmonic.pair import GearPair

PER_AXIS = 3


@dataclass(frozen=True)
class Check:
    """One point of a chart, first order beside delay equation; None where something isn't there.

    Attributes:
        first, second: values of both axes.
        mu, exact_mu: effective damping; of the delay equation it is -(lambda_1 + lambda_2)/(2 eps) below the resonance.
        folds, exact_folds: number of folds.
        width, exact_width: of the range between them.
        peak, exact_peak: largest amplitude.
    """

    first: float
    second: float
    mu: float
    exact_mu: float | None
    folds: int
    exact_folds: int | None
    width: float | None
    exact_width: float | None
    peak: float | None
    exact_peak: float | None

    def as_object(self) -> dict[str, Any]:
        """Return what JSON shows."""
        return asdict(self)


def checks(pair: GearPair, chart: Chart, mode: str, per_axis: int = PER_AXIS) -> Iterator[Check]:
    """Yield checks on a grid within the chart, a few seconds each.

    Args:
        pair: the gear pair; chart: made of it; mode: of the first order; per_axis: points along each axis.
    """
    places = [
        np.unique(np.round((np.arange(per_axis) + 0.5) / per_axis * (axis.size - 1)).astype(int)) for axis in chart.axes
    ]
    for i, j in itertools.product(*places):
        values = (float(chart.axes[0][i]), float(chart.axes[1][j]))
        given = _given(chart.names, values)
        member = pair.having(**given)
        exact_mu, folds, width, peak = _exactly(member, mode)
        yield Check(
            *values,
            mu=float(chart.mu[i, j]),
            exact_mu=exact_mu,
            folds=int(chart.folds[i, j]),
            exact_folds=folds,
            width=_number(chart.width[i, j]),
            exact_width=width,
            peak=_number(chart.peak[i, j]),
            exact_peak=peak if float(chart.mu[i, j]) > 0.0 else None,
        )


def _given(names: tuple[str, str], values: tuple[float, float]) -> dict[str, float]:
    given: dict[str, float] = {}
    for name, value in zip(names, values, strict=True):
        given |= dict.fromkeys(("tau_d", "tau_v") if name == "tau" else (name,), value)
    return given


def _exactly(pair: GearPair, mode: str) -> tuple[float | None, int | None, float | None, float | None]:
    """Return damping, number of folds, their distance and the peak of the delay equation."""
    axis = usual_frequencies(pair, mode)
    balance = balance_of(pair, None)
    try:
        first = balance.solve(float(axis[0]))
    except NoOrbit:
        return None, None, None, None
    damping = -float(np.mean(exponents(balance, first).real)) / pair.eps
    try:
        found, whole = orbits(pair, float(axis[0]), float(axis[-1]), None)
    except NoOrbit:
        return damping, None, None, None
    if not whole:
        return damping, None, None, None
    alpha = np.array([orbit.amplitude(3) for orbit in found])
    jumps = of_path(np.array([orbit.omega for orbit in found]), alpha, [True] * len(found))
    places = [jump.value for jump in jumps]
    return damping, len(places), max(places) - min(places) if places else 0.0, float(alpha.max())


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
