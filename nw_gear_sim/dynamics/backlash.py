"""The force of a gear mesh along its normal (paper Eqs 3, 10, 34, 35)."""

from __future__ import annotations

import numba

_FAST = {"reassoc", "contract", "nsz"}


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def backlash(x: float, half: float) -> float:
    """Backlash function f(x, b): elastic deflection of the teeth (m), 0 inside the gap (paper Eq 10)."""
    if x > half:
        return x - half
    if x < -half:
        return x + half
    return 0.0
