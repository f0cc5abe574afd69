"""Rolling bearings: the sum over their loaded rollers (paper Eqs 19-27).

    delta_i = (x cos th_i + y sin th_i) cos g + z sin g - c,    F = sum K delta_i^n (cos g cos th_i, cos g sin th_i, sin g)

over delta_i > 0, with th_i = 2 pi i / Z + cage angle: the roller set turns, so that the support stiffness varies with
time. This is the first-order form for rollers; the tilting term of Eqs 22-24 has no degree of freedom in Eq 36.
"""

from __future__ import annotations

import numba
import numpy as np

from nw_gear_common.tables import Array

ROLLER_EXPONENT = 10.0 / 9.0
_FAST = {"reassoc", "contract", "nsz", "arcp"}
_SEED = int(1023 * (1 + 1 / 9) * 2**20) - 56_000
"""High half of the bits of the first guess of d^(-1/9): the exponent divided by -9.

The shift centres the error of the piecewise linear guess, which two corrections then bring below 2e-12.
"""
_TINY = 1e-30


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def roller_power(deflection: float) -> float:
    """Deflection^(10/9) of a positive number, relative error below 2e-12, without branches (so that loops vectorise).

    r = d^(-1/9) from a guess by the exponent bits and two corrections r <- r (1 - e)^(-1/9), e = 1 - d r^9, the power
    expanded to e^3; then d^(10/9) = d^2 r^8.
    """
    high = np.float64(deflection).view(np.int64) >> 32
    r = np.int64((_SEED - ((high * 7282) >> 16)) << 32).view(np.float64)
    for _ in range(2):
        r2 = r * r
        r4 = r2 * r2
        e = 1.0 - deflection * r4 * r4 * r
        r += r * e * (1.0 / 9.0 + e * (5.0 / 81.0 + e * (95.0 / 2187.0)))
    r2 = r * r
    r4 = r2 * r2
    return deflection * deflection * r4 * r4


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def roller_sum(
    x: float, y: float, offset: float, cos: Array, sin: Array, absent: Array, exponent: float
) -> tuple[float, float, float]:
    """Sums of delta^n cos, delta^n sin and delta^n over the rollers.

    Args:
        x, y: shift of the inner ring times cos g, in the frame of the cage (m).
        offset: z sin g - c (m).
        cos, sin: of the roller angles in the frame of the cage.
        absent: 0 for a roller, a large number of metres for an entry that only fills the vector registers.
        exponent: n.
    """
    fx, fy, fz = 0.0, 0.0, 0.0
    if exponent == ROLLER_EXPONENT:
        for i in range(len(cos)):
            load = roller_power(max(x * cos[i] + y * sin[i] + offset - absent[i], _TINY))
            fx += load * cos[i]
            fy += load * sin[i]
            fz += load
    else:
        for i in range(len(cos)):
            load = max(x * cos[i] + y * sin[i] + offset - absent[i], 0.0) ** exponent
            fx += load * cos[i]
            fy += load * sin[i]
            fz += load
    return fx, fy, fz
