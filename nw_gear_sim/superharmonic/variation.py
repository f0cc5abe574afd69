"""Characteristic exponents by integrating small disturbances of an orbit over its period: made for kinks.

A disturbance obeys y'' + 2 eps c zeta y' + K(t) y = eps g_d y(t - tau_d) + eps g_v y'(t - tau_v), K the stiffness along
the orbit. All multipliers but those of the oscillator are next to 0 while gains are of order eps: once the delays have
passed, displacement and velocity at the ends of one more period give the 2 x 2 matrix whose eigenvalues they are.

With a backlash K(t) is the slope where flanks touch and 0 elsewhere. The force is continuous, so a disturbance
crosses these instants without a jump (its saltation matrix is 1). A step with a contact in it has the mean of K,
which leaves an error of order h^2; steps without have the fourth order of the method. Where the orbit grazes a flank,
x = +-1 with no speed, exponents aren't defined.
"""

from __future__ import annotations

import math

import numba
import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.contact import contacts
from nw_gear_sim.superharmonic.harmonics import Balance, Orbit, basis
from nw_gear_sim.superharmonic.lanes import Whole, stepper
from nw_gear_sim.superharmonic.restoring import Backlash

STEPS_PER_PERIOD = 4096


def exponents_in_time(balance: Balance, orbit: Orbit, steps: int = STEPS_PER_PERIOD) -> npt.NDArray[np.complex128]:
    """Return the two characteristic exponents of the oscillator, imaginary parts within +-omega/2, largest real first.

    Args:
        balance: the equation that the orbit belongs to; orbit: of it; steps: per period.
    """
    pair = balance.pair
    step = stepper(pair, orbit.omega, 1.0, steps)
    period = step.steps * step.h
    settling = math.ceil(max(pair.tau_d, pair.tau_v) / period) + 1
    rows = step.back + 1
    y, v, a = (np.zeros((rows + (settling + 1) * step.steps, 2)) for _ in range(3))
    y[rows - 1, 0] = v[rows - 1, 1] = 1.0
    _disturb(
        _stiffness(balance, orbit, step.steps) + step.law[0], step.law[3], step.feedback, step.offsets, step.weights,
        step.h, rows - 1, y, v, a,
    )  # fmt: skip
    first, last = rows - 1 + settling * step.steps, rows - 1 + (settling + 1) * step.steps
    begin, end = np.stack([y[first], v[first]]), np.stack([y[last], v[last]])
    found = np.log(np.linalg.eigvals(end @ np.linalg.inv(begin)).astype(complex)) / period
    ordered: npt.NDArray[np.complex128] = found[np.argsort(-found.real)]
    return ordered


def _stiffness(balance: Balance, orbit: Orbit, steps: int) -> Array:
    """Return the stiffness at the beginning, middle and end of each step of a period, (steps, 3)."""
    law = balance.restoring
    if isinstance(law, Backlash):
        return np.repeat(law.slope * _share(orbit, steps)[:, None], 3, axis=1)
    halves = 2.0 * np.pi * np.arange(2 * steps + 1) / (2 * steps)
    along = law.stiffness(basis(orbit.order, halves) @ orbit.coefficients)
    return np.stack([along[:-1:2], along[1::2], along[2::2]], axis=1)


def _share(orbit: Orbit, steps: int) -> Array:
    """Return the part of each step of a period in which flanks touch, (steps,)."""
    angles, touching = contacts(orbit)
    if len(angles) == 0:
        return np.full(steps, float(touching))
    edges = 2.0 * np.pi * np.arange(steps + 1) / steps
    bounds = np.concatenate([[0.0], angles, [2.0 * np.pi]])
    states = (np.arange(len(bounds) - 1) % 2 == 0) != touching
    so_far = np.concatenate([[0.0], np.cumsum(np.where(states, np.diff(bounds), 0.0))])
    share: Array = np.diff(np.interp(edges, bounds, so_far)) * steps / (2.0 * np.pi)
    return share


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _disturb(
    stiffness: Array, damping: float, feedback: Array, offsets: Whole, weights: Array, h: float, present: int,
    y: Array, v: Array, a: Array,
) -> None:  # fmt: skip
    """Integrate two disturbances to the end of the arrays, period after period."""
    late = np.zeros(3)
    for n in range(present, y.shape[0] - 1):
        k = stiffness[(n - present) % stiffness.shape[0]]
        for j in range(2):
            y1, v1 = y[n, j], v[n, j]
            for part in range(3):
                d, s = n + offsets[0, part], n + offsets[1, part]
                p, q = weights[0, part], weights[1, part]
                late_y = p[0] * y[d, j] + p[1] * y[d + 1, j] + p[2] * v[d, j] + p[3] * v[d + 1, j]
                late_v = q[0] * v[s, j] + q[1] * v[s + 1, j] + q[2] * a[s, j] + q[3] * a[s + 1, j]
                late[part] = feedback[0] * late_y + feedback[1] * late_v
                if part == 0:
                    a[n, j] = late[0] - damping * v1 - k[0] * y1
            a1 = a[n, j]
            v2 = v1 + 0.5 * h * a1
            a2 = late[1] - damping * v2 - k[1] * (y1 + 0.5 * h * v1)
            v3 = v1 + 0.5 * h * a2
            a3 = late[1] - damping * v3 - k[1] * (y1 + 0.5 * h * v2)
            v4 = v1 + h * a3
            a4 = late[2] - damping * v4 - k[2] * (y1 + h * v3)
            y[n + 1, j] = y1 + h * (v1 + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
            v[n + 1, j] = v1 + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
