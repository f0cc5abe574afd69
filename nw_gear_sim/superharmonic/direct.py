"""The delay equation integrated step by step, with its history: the judge of everything approximate.

Classical Runge-Kutta; delayed values come from cubic Hermite interpolation of the history (displacement and velocity
from what is known of both and of the acceleration), so that the whole is of order 4. A step is shorter than every
delay, hence nothing delayed lies within it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.interpolate import CubicSpline

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.pair import GearPair

STEPS_PER_PERIOD = 400
MOST_STEPS = 100_000
"""Steps per period at most: no delay but 0 may be shorter than one of them."""
Numbers = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Course:
    """A motion at equal steps: time, displacement and velocity, each (n,)."""

    time: Array
    x: Array
    v: Array


def integrate(
    pair: GearPair,
    omega: float,
    periods: int,
    *,
    start: tuple[Array, Array] | None = None,
    slope: float | None = None,
    steps_per_period: int = STEPS_PER_PERIOD,
) -> Course:
    """Integrate over periods of the excitation.

    Args:
        pair: the gear pair; omega: nu; periods: how many of 2 pi/omega.
        start: displacement and velocity over the time before 0 at the same steps, the last at time 0; at rest if none.
            It has to reach back by the longest delay.
        slope: of a true backlash in the place of the cubic, c k_m; None for the cubic.
        steps_per_period: at least; more are taken where a delay is shorter than a step.

    Raises:
        InputError: no periods, a start that is too short, or a delay too short for MOST_STEPS.
    """
    if periods < 1 or not omega > 0.0:
        raise InputError("periods and omega", "above 0", f"{periods} and {omega:g}")
    period = 2.0 * math.pi / omega
    delays = [tau for tau in (pair.tau_d, pair.tau_v) if tau > 0.0]
    steps = max(steps_per_period, *(math.ceil(period / tau) + 1 for tau in delays)) if delays else steps_per_period
    if steps > MOST_STEPS:
        raise InputError("tau_d, tau_v", f"0, or at least 1/{MOST_STEPS} of the period {period:g}", f"{min(delays):g}")
    h = period / steps
    back = math.ceil(max([0.0, *delays]) / h) + 2
    x, v = np.zeros(back + 1 + periods * steps), np.zeros(back + 1 + periods * steps)
    if start is not None:
        if len(start[0]) < back + 1 or len(start[1]) != len(start[0]):
            raise InputError("start", f"at least {back + 1} values of both", f"{len(start[0])} and {len(start[1])}")
        x[: back + 1], v[: back + 1] = start[0][-back - 1 :], start[1][-back - 1 :]
    a = CubicSpline(h * np.arange(back + 1), v[: back + 1])(h * np.arange(back + 1), 1)
    numbers = (
        pair.w0**2 if slope is None else 0.0,
        pair.eps * pair.q * pair.w0 if slope is None else 0.0,
        0.0 if slope is None else slope,
        2.0 * pair.eps * pair.c * pair.zeta,
        pair.eps * pair.g_d,
        pair.eps * pair.g_v,
        pair.tau_d / h,
        pair.tau_v / h,
        pair.mean_force,
        pair.force,
        h,
    )
    _run(numbers, omega, h, back, x, v, np.append(a, np.zeros(periods * steps)))
    return Course(h * np.arange(periods * steps + 1, dtype=np.float64), x[back:], v[back:])


@njit(cache=True)
def _run(numbers: Numbers, omega: float, h: float, back: int, x: Array, v: Array, a: Array) -> None:
    for n in range(back, len(x) - 1):
        t = (n - back) * h
        a1 = _acceleration(numbers, omega, t, n, 0.0, x[n], v[n], x, v, a)
        a[n] = a1
        x2, v2 = x[n] + 0.5 * h * v[n], v[n] + 0.5 * h * a1
        a2 = _acceleration(numbers, omega, t + 0.5 * h, n, 0.5, x2, v2, x, v, a)
        x3, v3 = x[n] + 0.5 * h * v2, v[n] + 0.5 * h * a2
        a3 = _acceleration(numbers, omega, t + 0.5 * h, n, 0.5, x3, v3, x, v, a)
        x4, v4 = x[n] + h * v3, v[n] + h * a3
        a4 = _acceleration(numbers, omega, t + h, n, 1.0, x4, v4, x, v, a)
        x[n + 1] = x[n] + h * (v[n] + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
        v[n + 1] = v[n] + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0


@njit(cache=True)
def _acceleration(
    numbers: Numbers, omega: float, t: float, n: int, part: float, x: float, v: float, xs: Array, vs: Array, acc: Array
) -> float:
    linear, cubic, slope, damping, g_d, g_v, back_d, back_v, mean, force, h = numbers
    gap = 0.0
    if slope != 0.0 and abs(x) > 1.0:
        gap = slope * (x - 1.0 if x > 0.0 else x + 1.0)
    late_x = x if back_d == 0.0 else _late(n + part - back_d, h, xs, vs)
    late_v = v if back_v == 0.0 else _late(n + part - back_v, h, vs, acc)
    restoring = linear * x + cubic * x * x * x + gap
    return mean + force * math.cos(omega * t) + g_d * late_x + g_v * late_v - damping * v - restoring


@njit(cache=True)
def _late(place: float, h: float, values: Array, rates: Array) -> float:
    """Return a value between steps of the history, by cubic Hermite interpolation."""
    k = math.floor(place)
    u = place - k
    if u == 0.0:
        return float(values[k])
    a, b = values[k], values[k + 1]
    da, db = h * rates[k], h * rates[k + 1]
    w = 1.0 - u
    return float((1.0 + 2.0 * u) * w * w * a + u * w * w * da + u * u * (3.0 - 2.0 * u) * b - u * u * w * db)
