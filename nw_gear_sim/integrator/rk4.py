"""The classical Runge-Kutta method of order 4 for q'' = a(t, q, q'), written out for second-order equations.

With the slopes a1 .. a4 at (t, q, v), (t + h/2, q2, v2), (t + h/2, q3, v3), (t + h, q4, v4) this is the classical
method for the pair (q, v), whose own slopes are eliminated. The caller evaluates a between the calls. Stable for
undamped oscillations up to h |lambda| = 2 sqrt 2.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import fused, kernel

ORDER = 4


@kernel
def first(q: Array, v: Array, q1: Array, v1: Array) -> None:
    """Set the state of the first evaluation, at t: a copy; all arrays have shape (n,)."""
    for i in range(len(q)):
        q1[i], v1[i] = q[i], v[i]


@kernel
def proceed(stage: int, h: float, q: Array, v: Array, slopes: Array, q_next: Array, v_next: Array) -> None:
    """Go on after the evaluation `stage` (0 to 3): to the state of the next one, or after the last to t + h.

    Args:
        stage: whose slope has just been set in `slopes`, shape (4, n).
        h: the step.
        q, v: the state at t, advanced in place after the last stage.
        q_next, v_next: the state of the next evaluation, set before that.
    """
    if stage == 0:
        second(h, q, v, slopes[0], q_next, v_next)
    elif stage == 1:
        third(h, q, v, slopes[0], slopes[1], q_next, v_next)
    elif stage == 2:
        fourth(h, q, v, slopes[1], slopes[2], q_next, v_next)
    else:
        finish(h, q, v, slopes[0], slopes[1], slopes[2], slopes[3])


@fused
def second(h: float, q: Array, v: Array, a1: Array, q2: Array, v2: Array) -> None:
    """Set the state of the second evaluation, at t + h/2."""
    half = 0.5 * h
    for i in range(len(q)):
        q2[i] = q[i] + half * v[i]
        v2[i] = v[i] + half * a1[i]


@fused
def third(h: float, q: Array, v: Array, a1: Array, a2: Array, q3: Array, v3: Array) -> None:
    """Set the state of the third evaluation, at t + h/2."""
    half, quarter = 0.5 * h, 0.25 * h * h
    for i in range(len(q)):
        q3[i] = q[i] + half * v[i] + quarter * a1[i]
        v3[i] = v[i] + half * a2[i]


@fused
def fourth(h: float, q: Array, v: Array, a2: Array, a3: Array, q4: Array, v4: Array) -> None:
    """Set the state of the fourth evaluation, at t + h."""
    half = 0.5 * h * h
    for i in range(len(q)):
        q4[i] = q[i] + h * v[i] + half * a2[i]
        v4[i] = v[i] + h * a3[i]


@fused
def finish(h: float, q: Array, v: Array, a1: Array, a2: Array, a3: Array, a4: Array) -> None:
    """Advance q and v by the step h, in place."""
    sixth, square = h / 6.0, h * h / 6.0
    for i in range(len(q)):
        q[i] += h * v[i] + square * (a1[i] + a2[i] + a3[i])
        v[i] += sixth * (a1[i] + 2.0 * (a2[i] + a3[i]) + a4[i])


def amplification(z: npt.NDArray[np.complex128]) -> Array:
    """Growth of a step |R(z)| for z = h lambda; R = 1 + z + z^2/2 + z^3/6 + z^4/24."""
    return np.abs(1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4))))


def largest_stable_step(eigenvalues: npt.NDArray[np.complex128]) -> float:
    """Return the largest step (s) up to which no mode grows; eigenvalues in 1/s, those of growing modes left out.

    inf where no eigenvalue decays.
    """
    decaying = eigenvalues[eigenvalues.real < 0]
    if not len(decaying):
        return math.inf
    low, high = 0.0, 4.0 / float(np.min(np.abs(decaying)))
    bound = 3.0 / float(np.max(np.abs(decaying)))
    high = min(high, bound)  # |R| > 1 everywhere in the left half-plane from |z| = 3 on
    for _ in range(60):
        middle = 0.5 * (low + high)
        stable = bool(np.all(amplification(middle * decaying) <= 1.0))
        low, high = (middle, high) if stable else (low, middle)
    return low
