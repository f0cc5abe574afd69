"""The delay equation for many motions of one gear pair at the same time, each in its own SIMD lane.

The method is that of `direct`: classical Runge-Kutta, delayed values by cubic Hermite interpolation of the history.
Step and delays are the same in all lanes, so the weights of the interpolation are worked out once. Compiled, and
without Python's lock, so that threads run beside each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.pair import GearPair

Whole = npt.NDArray[np.int64]
STEPS_PER_PERIOD = 128
MOST_STEPS = 20_000
"""Steps per period at most: no delay but 0 may be shorter than one of them."""


@dataclass(frozen=True, eq=False)
class Stepper:
    """What the steps of one excitation frequency need.

    Attributes:
        omega: excitation frequency; h: step; steps: per period of the excitation.
        back: steps of history that the delays need.
        law: (4,) linear, cubic, slope of the backlash, damping; feedback without delay is part of the first and last.
        feedback: (2,) eps g_d, eps g_v; load: (2,) mean and amplitude of the force.
        offsets: (2, 3) row of the history for each delay and part of a step 0, 1/2, 1, from the present one.
        weights: (2, 3, 4) of value, next value, h rate, h next rate; all 0 where the delay is 0.
    """

    omega: float
    h: float
    steps: int
    back: int
    law: Array
    feedback: Array
    load: Array
    offsets: Whole
    weights: Array


def stepper(pair: GearPair, omega: float, slope: float | None = None, least: int = STEPS_PER_PERIOD) -> Stepper:
    """Prepare the steps at a frequency.

    Args:
        pair: the gear pair; omega: nu; slope: of a true backlash in the place of the cubic.
        least: steps per period at least; more are taken where a delay is shorter than a step.

    Raises:
        InputError: the frequency isn't above 0, or a delay is too short for MOST_STEPS.
    """
    if not omega > 0.0 or not math.isfinite(omega):
        raise InputError("omega", "above 0", f"{omega:g}")
    period = 2.0 * math.pi / omega
    delays = (pair.tau_d, pair.tau_v)
    steps = max([least, *(math.ceil(period / tau) + 1 for tau in delays if tau > 0.0)])
    if steps > MOST_STEPS:
        raise InputError("tau_d, tau_v", f"0, or at least 1/{MOST_STEPS} of the period {period:g}", f"{min(delays):g}")
    h = period / steps
    offsets, weights = np.zeros((2, 3), dtype=np.int64), np.zeros((2, 3, 4))
    for k, tau in enumerate(delays):
        for part in range(3):
            if tau > 0.0:
                place = 0.5 * part - tau / h
                offsets[k, part] = math.floor(place)
                weights[k, part] = _hermite(place - math.floor(place), h)
    damping = 2.0 * pair.eps * pair.c * pair.zeta
    law = np.array(
        [pair.w0**2, pair.eps * pair.q * pair.w0, 0.0, damping] if slope is None else [0.0, 0.0, slope, damping]
    )
    law[0] -= pair.eps * pair.g_d if pair.tau_d == 0.0 else 0.0
    law[3] -= pair.eps * pair.g_v if pair.tau_v == 0.0 else 0.0
    return Stepper(
        omega=omega,
        h=h,
        steps=steps,
        back=math.ceil(max(delays) / h) + 2,
        law=law,
        feedback=pair.eps * np.array([pair.g_d, pair.g_v]),
        load=np.array([pair.mean_force, pair.force]),
        offsets=offsets,
        weights=weights,
    )


def advance(step: Stepper, history: tuple[Array, Array, Array], periods: int) -> tuple[Array, Array, Array]:
    """Integrate over whole periods of the excitation from phase 0.

    Args:
        step: from `stepper`.
        history: displacement, velocity, acceleration, each (back + 1 or more, lanes), the last row at the present.
        periods: how many.

    Returns:
        the same three over the last `back` + 1 rows and at least one period, so that they go on as history.
    """
    rows = max(step.back, step.steps) + 1
    block = [np.zeros((rows + step.steps, history[0].shape[1])) for _ in range(3)]
    kept = [part[-step.back - 1 :] for part in history]
    for whole, part in zip(block, kept, strict=True):
        whole[rows - len(part) : rows] = part
    for _ in range(periods):
        _period(step.law, step.feedback, step.load, step.offsets, step.weights, step.omega, step.h, rows - 1, *block)
        for whole in block:
            whole[:rows] = whole[step.steps :]
    return block[0][:rows], block[1][:rows], block[2][:rows]


def _hermite(u: float, h: float) -> Array:
    w = 1.0 - u
    return np.array([(1.0 + 2.0 * u) * w * w, u * u * (3.0 - 2.0 * u), h * u * w * w, -h * u * u * w])


_COMPILED = {"cache": True, "nogil": True, "error_model": "numpy", "fastmath": {"contract", "reassoc", "nsz"}}


@numba.njit(**_COMPILED)
def _period(
    law: Array, feedback: Array, load: Array, offsets: Whole, weights: Array, omega: float, h: float, present: int,
    x: Array, v: Array, a: Array,
) -> None:  # fmt: skip
    """Fill the rows after `present`, whose phase is 0."""
    late = np.zeros((3, x.shape[1]))
    for n in range(present, x.shape[0] - 1):
        for part in range(3):
            force = load[0] + load[1] * math.cos(omega * h * (n - present + 0.5 * part))
            d, s = n + offsets[0, part], n + offsets[1, part]
            _late(late[part], force, feedback, weights[0, part], weights[1, part], x[d], x[d + 1], v[d], v[d + 1],
                  v[s], v[s + 1], a[s], a[s + 1])  # fmt: skip
            if part == 0:
                for j in range(x.shape[1]):
                    a[n, j] = _pull(law, late[0, j], x[n, j], v[n, j])
        _step(law, h, late, x[n], v[n], a[n], x[n + 1], v[n + 1])


@numba.njit(**_COMPILED)
def _late(
    late: Array, force: float, feedback: Array, p: Array, q: Array,
    x0: Array, x1: Array, v0: Array, v1: Array, w0: Array, w1: Array, a0: Array, a1: Array,
) -> None:  # fmt: skip
    """Add up force and feedback in each lane."""
    p0, p1, p2, p3 = feedback[0] * p[0], feedback[0] * p[1], feedback[0] * p[2], feedback[0] * p[3]
    q0, q1, q2, q3 = feedback[1] * q[0], feedback[1] * q[1], feedback[1] * q[2], feedback[1] * q[3]
    for j in range(len(late)):
        late_x = p0 * x0[j] + p1 * x1[j] + p2 * v0[j] + p3 * v1[j]
        late_v = q0 * w0[j] + q1 * w1[j] + q2 * a0[j] + q3 * a1[j]
        late[j] = force + late_x + late_v


@numba.njit(inline="always", **_COMPILED)
def _pull(law: Array, given: float, x: float, v: float) -> float:
    gap = law[2] * (x - min(max(x, -1.0), 1.0))
    return float(given - law[3] * v - (law[0] + law[1] * x * x) * x - gap)


@numba.njit(**_COMPILED)
def _step(law: Array, h: float, late: Array, x: Array, v: Array, a: Array, x_next: Array, v_next: Array) -> None:
    """Make one step in each lane."""
    for j in range(len(x)):
        x1, v1, a1 = x[j], v[j], a[j]
        v2 = v1 + 0.5 * h * a1
        a2 = _pull(law, late[1, j], x1 + 0.5 * h * v1, v2)
        v3 = v1 + 0.5 * h * a2
        a3 = _pull(law, late[1, j], x1 + 0.5 * h * v2, v3)
        v4 = v1 + h * a3
        a4 = _pull(law, late[2, j], x1 + h * v3, v4)
        x_next[j] = x1 + h * (v1 + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
        v_next[j] = v1 + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
