"""How many points go side by side, and how kernels read a constant.

Arrays of a block are flat, entry `row * LANES + lane`: with a stride known while compiling, LLVM turns a loop over the
lanes into SIMD instructions without further checks. Constants which all points of a block share are kept once a row.
"""

from __future__ import annotations

from typing import Any

from numba.extending import overload

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import rounding

LANES = 16
"""Points in a block: two registers of AVX-512, four of AVX2."""


def of(table: Array, row: int, lane: int) -> Any:
    """Return the constant of a row: of a table (rows,) for all lanes, of a table (rows, LANES) that of the lane."""
    return table[row] if table.ndim == 1 else table[row, lane]


@overload(of, inline="always")
def _of(table: Any, row: Any, lane: Any) -> Any:  # numba calls it with types
    def shared(table: Any, row: Any, lane: Any) -> Any:
        return table[row]

    def own(table: Any, row: Any, lane: Any) -> Any:
        return table[row, lane]

    return shared if table.ndim == 1 else own


@rounding
def exact(a: float, b: float) -> float:
    """Return a b, rounded.

    In a b + c d the compiler may fuse either product with the sum, and may do it differently for different tables; in
    exact(a, b) + c d it has no choice, so that a point's results don't depend on the others of its block.
    """
    return a * b
