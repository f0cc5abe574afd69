"""How kernels are compiled: cached on disk, without the GIL, dividing by zero as NumPy does.

`_nrt=False` leaves out the counting of references to arrays, which would take half of the time of a right-hand side;
kernels then can't make arrays, they work on those they are given. The option is numba's own but undocumented, so the
version of numba is pinned.
"""

from __future__ import annotations

from typing import Any

import numba

_OPTIONS: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "_nrt": False}

kernel = numba.njit(**_OPTIONS)
"""Compiles a function on its first call."""

inlined = numba.njit(**_OPTIONS, inline="always")
"""The same, put into its callers, so that large tuples of constants aren't passed on."""

fused = numba.njit(**_OPTIONS, fastmath={"contract"})
"""The same as `kernel`, with multiplications and additions fused."""

summing = numba.njit(**_OPTIONS, fastmath={"contract", "reassoc", "nsz"})
"""The same as `fused`, with sums in any order, so that they run in lanes; it is the same on one machine."""
