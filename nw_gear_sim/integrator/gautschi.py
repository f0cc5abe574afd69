"""The two-step method of Gautschi for damped oscillators x'' + gamma x' + square x = f(t, x, x').

Each oscillator's own motion is followed exactly, the force f counts as constant over a step (W. Gautschi, Numer. Math.
3 (1961) 381-397; with square = gamma = 0 it is the method of Stoermer and Verlet). One force a step, order 2:

    u_{k+1} = decay u_k + weight (f_k - square x_k),   x_{k+1} = x_k + h u_{k+1}

with u_k = (x_k - x_{k-1}) / h, decay = exp(-gamma h), weight = (1 - 2 exp(-gamma h/2) cos(omega_d h) + decay) / (h
square), omega_d^2 = square - gamma^2/4. A force that depends on the velocity is evaluated at the extrapolated velocity
(3 u_k - u_{k-1}) / 2; once the step is done the velocity at its start is known better: (u_k + u_{k+1}) / 2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import fused

ORDER = 2


class Coefficients(NamedTuple):
    """Of each oscillator, arrays of shape (n,): square (1/s^2), decay (1), weight (s); step h (s)."""

    square: Array
    decay: Array
    weight: Array
    step: float


def coefficients(square: Array, damping: Array, step: float) -> Coefficients:
    """Prepare the oscillators: squared angular frequencies (1/s^2) and damping gamma (1/s), shape (n,); step h (s)."""
    decay = np.exp(-damping * step)
    inner = np.emath.sqrt(square - damping**2 / 4) * step  # imaginary where overdamped
    swing = np.real(np.cos(inner)) * np.sqrt(decay)
    free = square * step**2 < 1e-12
    safe = np.where(free, 1.0, square)
    rate = np.where(damping * step < 1e-6, 1.0, damping)
    coasting = np.where(damping * step < 1e-6, step * (1 - damping * step / 2), (1 - decay) / rate)
    return Coefficients(square, decay, np.where(free, coasting, (1 - 2 * swing + decay) / (safe * step)), step)


@fused
def start(x: Array, v: Array, a: Array, h: float, u: Array, before: Array) -> None:
    """Set u = (x_0 - x_{-1}) / h and the one before from velocities v and accelerations a at the start, order 2."""
    for i in range(len(x)):
        u[i] = v[i] - 0.5 * h * a[i]
        before[i] = v[i] - 1.5 * h * a[i]


@fused
def extrapolate(u: Array, before: Array, v: Array) -> None:
    """Set the velocities v at which the forces of a step are evaluated."""
    for i in range(len(u)):
        v[i] = 1.5 * u[i] - 0.5 * before[i]


@fused
def proceed(c: Coefficients, f: Array, x: Array, u: Array, before: Array, v: Array) -> None:
    """Advance by one step with the forces f per mass (m/s^2).

    x, u and the u before are changed in place; v is set as `extrapolate` does.
    """
    square, decay, weight, step = c
    for i in range(len(x)):
        last = u[i]
        new = decay[i] * last + weight[i] * (f[i] - square[i] * x[i])
        x[i] += step * new
        u[i] = new
        before[i] = last
        v[i] = 1.5 * new - 0.5 * last


@fused
def centre(u: Array, before: Array, v: Array) -> None:
    """Set the velocities v at the start of the step just done."""
    for i in range(len(u)):
        v[i] = 0.5 * (u[i] + before[i])


def step_matrix(c: Coefficients, stiffness: Array, damping: Array) -> Array:
    """Return the matrix that takes (x, h u, h u before) over a step when f = -stiffness x - damping v.

    Args:
        c: of the oscillators.
        stiffness, damping: of the forces per mass, (n, n), 1/s^2 and 1/s.
    """
    n, h = len(c.square), c.step
    push = h * c.weight[:, None]
    by_x = -push * (stiffness + np.diag(c.square))
    by_u = np.diag(c.decay) - push * damping * (1.5 / h)
    by_before = push * damping * (0.5 / h)
    one, none = np.eye(n), np.zeros((n, n))
    return np.block([[one + by_x, by_u, by_before], [by_x, by_u, by_before], [none, one, none]])
