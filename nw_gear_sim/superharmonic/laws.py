"""Which restoring force a gear pair has: its cubic, the backlash that this cubic stands for, or the cubic of a fit."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.harmonics import Balance, NoOrbit, Orbit, basis
from nw_gear_sim.superharmonic.lanes import advance, stepper
from nw_gear_sim.superharmonic.pair import GearPair
from nw_gear_sim.superharmonic.restoring import Backlash, Fit, fit_cubic, interval_of

LAWS = ("cubic", "backlash")
KINKED_ORDER, KINKED_SAMPLES = 25, 4096
"""Harmonics and points of time with the true backlash: its third derivative jumps, so harmonics fall as 1/k^3 only."""
STEPS_PER_PERIOD = 256
STARTING = 400
"""Periods of the excitation that a motion gets to settle where nothing else starts an iteration."""


def equivalent(pair: GearPair) -> tuple[Fit, float]:
    """Return the fit of a backlash that the pair's cubic is, and the stiffness c k_m beside that gap.

    The cubic w0^2 x + eps q w0 x^3 is c k_m (delta_1 x + delta_2 x^3) for one interval of the fit alone.

    Raises:
        InputError: the cubic is the fit of no backlash (q = 0, or softening).
    """
    fit = fit_cubic(interval_of(pair.eps * pair.q / pair.w0))
    return fit, pair.w0**2 / fit.delta_1


def fitted(pair: GearPair, interval: float, slope: float) -> tuple[GearPair, Fit]:
    """Return the pair with the cubic fitted to a backlash in the place of its own: w0^2 = slope delta_1, and q.

    Args:
        pair: the gear pair; its delays stay as they are.
        interval: X; slope: c k_m.

    Raises:
        InputError: the interval is too short for a positive stiffness in the middle, or the slope isn't above 0.
    """
    if not slope > 0.0 or not math.isfinite(slope):
        raise InputError("slope of the backlash", "above 0", f"{slope:g}")
    fit = fit_cubic(interval)
    if fit.delta_1 <= 0.0:
        raise InputError("interval of the cubic fit", "above 2.2433, where delta_1 becomes positive", f"{interval:g}")
    w0 = math.sqrt(slope * fit.delta_1)
    return replace(pair, w0=w0, q=slope * fit.delta_2 / (pair.eps * w0)), fit


def balance_of(pair: GearPair, slope: float | None) -> Balance:
    """Return the harmonic balance with a backlash of this slope, or with the pair's cubic for None."""
    if slope is None:
        return Balance(pair)
    return Balance(pair, Backlash(slope), order=KINKED_ORDER, samples=KINKED_SAMPLES)


def first_orbit(balance: Balance, omega: float) -> Orbit:
    """Return a periodic orbit at a frequency, from the linear motion, or with a backlash from the motion that settles.

    Raises:
        NoOrbit: none found.
        InputError: a delay too short to be integrated.
    """
    if not isinstance(balance.restoring, Backlash):
        return balance.solve(omega)
    step = stepper(balance.pair, omega, balance.restoring.slope, STEPS_PER_PERIOD)
    rest = np.zeros((step.back + 1, 1))
    displacement, _, _ = advance(step, (rest, rest, rest), STARTING)
    try:
        return balance.solve(omega, project(displacement[-step.steps - 1 : -1, 0], balance.order))
    except NoOrbit:
        cubic = Balance(balance.pair, order=balance.order).solve(omega)
        return balance.solve(omega, cubic.coefficients)


def project(x: Array, order: int) -> Array:
    """Return the coefficients of one period of equal steps that begins at phase 0, as `Orbit` has them."""
    turned = basis(order, 2.0 * np.pi * np.arange(len(x)) / len(x))
    weights = np.full(2 * order + 1, 2.0 / len(x))
    weights[0] = 1.0 / len(x)
    found: Array = weights * (turned.T @ x)
    return found
