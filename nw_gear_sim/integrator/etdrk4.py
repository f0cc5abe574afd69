"""An exponential Runge-Kutta method of order 4 for damped oscillators x'' + gamma x' + square x = f(t, x, x').

Each oscillator's own motion is followed exactly, so that stiff linear parts set no bound to the step; f is treated like
in the classical method, whose four evaluations it has (S. Krogstad, J. Comput. Phys. 203 (2005) 72-88, scheme
ETDRK4-B). With A = [[0, 1], [-square, -gamma]], b = (0, 1) and phi_k of h A:

    z_2 = e^{hA/2} z + h/2 phi_1(hA/2) b f_1
    z_3 = e^{hA/2} z + h/2 (phi_1 - 2 phi_2)(hA/2) b f_1 + h phi_2(hA/2) b f_2
    z_4 = e^{hA} z + h (phi_1 - 2 phi_2) b f_1 + 2 h phi_2 b f_3
    z' = e^{hA} z + h [(phi_1 - 3 phi_2 + 4 phi_3) f_1 + (2 phi_2 - 4 phi_3) (f_2 + f_3) + (4 phi_3 - phi_2) f_4] b
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import fused, kernel

ORDER = 4


class Coefficients(NamedTuple):
    """Of each oscillator: half and whole, the entries of e^{hA/2} and e^{hA} by rows, (4, n); forces by stage.

    Attributes:
        second, third, fourth, last: weights of the forces in z_2 .. z': (2 forces, n), x before v for each force.
    """

    half: Array
    whole: Array
    second: Array
    third: Array
    fourth: Array
    last: Array


def coefficients(square: Array, damping: Array, step: float) -> Coefficients:
    """Prepare the oscillators: squared angular frequencies (1/s^2) and damping gamma (1/s), shape (n,); step h (s)."""
    half, (one, two, _) = _exponentials(square, damping, 0.5 * step)
    whole, (first, second, third) = _exponentials(square, damping, step)
    return Coefficients(
        half=half,
        whole=whole,
        second=one,
        third=np.vstack([one - 2 * two, 2 * two]),
        fourth=np.vstack([first - 2 * second, 2 * second]),
        last=np.vstack([first - 3 * second + 4 * third, 2 * second - 4 * third, 4 * third - second]),
    )


def _exponentials(square: Array, damping: Array, step: float) -> tuple[Array, tuple[Array, Array, Array]]:
    """Return e^{hA} by rows, (4, n), and h phi_k(hA) b for k = 1, 2, 3, each (2, n)."""
    count = len(square)
    chain = np.zeros((count, 5, 5))
    chain[:, 0, 1], chain[:, 1, 0], chain[:, 1, 1] = step, -step * square, -step * damping
    chain[:, 1, 2] = 1.0
    chain[:, 2, 3] = chain[:, 3, 4] = 1.0
    power = scipy.linalg.expm(chain)
    phi = [np.ascontiguousarray(step * power[:, :2, 1 + k].T) for k in (1, 2, 3)]
    return np.ascontiguousarray(power[:, :2, :2].reshape(count, 4).T), (phi[0], phi[1], phi[2])


@kernel
def proceed(stage: int, c: Coefficients, f: Array, x: Array, v: Array, x_next: Array, v_next: Array) -> None:
    """Go on after the evaluation `stage` (0 to 3): to the state of the next one, or after the last to t + h.

    Args:
        stage: whose force has just been set.
        c: of the oscillators.
        f: forces per mass (m/s^2), shape (4, n), set up to `stage`.
        x, v: the state at t, advanced in place after the last stage.
        x_next, v_next: the state of the next evaluation, set before that.
    """
    if stage == 0:
        _combine(c.half, c.second, f[0], f[0], False, x, v, x_next, v_next)
    elif stage == 1:
        _combine(c.half, c.third, f[0], f[1], True, x, v, x_next, v_next)
    elif stage == 2:
        _combine(c.whole, c.fourth, f[0], f[2], True, x, v, x_next, v_next)
    else:
        _finish(c.whole, c.last, f, x, v)


@fused
def _combine(
    e: Array, w: Array, f: Array, g: Array, both: bool, x: Array, v: Array, x_next: Array, v_next: Array
) -> None:
    for i in range(len(x)):
        x_next[i] = e[0, i] * x[i] + e[1, i] * v[i] + w[0, i] * f[i]
        v_next[i] = e[2, i] * x[i] + e[3, i] * v[i] + w[1, i] * f[i]
    if both:
        for i in range(len(x)):
            x_next[i] += w[2, i] * g[i]
            v_next[i] += w[3, i] * g[i]


@fused
def _finish(e: Array, w: Array, f: Array, x: Array, v: Array) -> None:
    for i in range(len(x)):
        middle = f[1, i] + f[2, i]
        x_new = e[0, i] * x[i] + e[1, i] * v[i] + w[0, i] * f[0, i] + w[2, i] * middle + w[4, i] * f[3, i]
        v[i] = e[2, i] * x[i] + e[3, i] * v[i] + w[1, i] * f[0, i] + w[3, i] * middle + w[5, i] * f[3, i]
        x[i] = x_new


def step_matrix(c: Coefficients, stiffness: Array, damping: Array) -> Array:
    """Return the matrix that takes (x, v) over a step when f = -stiffness x - damping v.

    Args:
        c: of the oscillators.
        stiffness, damping: of the forces per mass, (n, n), 1/s^2 and 1/s.
    """
    n = stiffness.shape[0]
    force = -np.hstack([stiffness, damping])
    start = np.eye(2 * n)

    def free(e: Array) -> Array:
        return np.block([[np.diag(e[0]), np.diag(e[1])], [np.diag(e[2]), np.diag(e[3])]])

    def pushed(w: Array, f: Array) -> Array:
        return np.vstack([w[0][:, None] * f, w[1][:, None] * f])

    f1 = force @ start
    f2 = force @ (free(c.half) + pushed(c.second, f1))
    f3 = force @ (free(c.half) + pushed(c.third[:2], f1) + pushed(c.third[2:], f2))
    f4 = force @ (free(c.whole) + pushed(c.fourth[:2], f1) + pushed(c.fourth[2:], f3))
    return free(c.whole) + pushed(c.last[:2], f1) + pushed(c.last[2:4], f2 + f3) + pushed(c.last[4:], f4)
