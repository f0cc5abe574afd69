"""The classical Runge-Kutta method of fourth order for q'' = a(q, q', t), as vector operations.

The caller evaluates a; these functions know nothing of what is integrated. One step of length h:

    k1 = f(t, y);  k2 = f(t + h/2, y + h/2 k1);  k3 = f(t + h/2, y + h/2 k2);  k4 = f(t + h, y + h k3)
    y <- y + h/6 (k1 + 2 k2 + 2 k3 + k4)

with y = (q, q') and f = (q', a). On a linear system it is stable while h |lambda| < 2.785 on the imaginary axis... see
`STABLE_IMAGINARY`.
"""

from __future__ import annotations

import numba

from nw_gear_common.tables import Array

STABLE_IMAGINARY = 2.0 * 2.0**0.5
"""Bound of h |lambda| for undamped oscillations (Hairer, Norsett, Wanner, Solving ODEs II, section IV.2)."""
_FAST = {"reassoc", "contract", "nsz"}


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def trial(q: Array, rate: Array, slope_q: Array, slope_rate: Array, step: float, to_q: Array, to_rate: Array) -> None:
    """Set (to_q, to_rate) = (q, rate) + step (slope_q, slope_rate); `to_rate` may be `slope_q`."""
    for i in range(len(q)):
        to_q[i] = q[i] + step * slope_q[i]
    for i in range(len(q)):
        to_rate[i] = rate[i] + step * slope_rate[i]


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def combine(y: Array, k1: Array, k2: Array, k3: Array, k4: Array, step: float) -> None:
    """Add the weighted mean of the four slopes to y in place."""
    for i in range(len(y)):
        y[i] += step / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
