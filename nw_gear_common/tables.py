"""A table of float64 with named columns: the one shape of every array that this project publishes or records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nw_gear_common.errors import InputError

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Table:
    """Rows of float64 under named columns.

    Attributes:
        row: what a row is (`sample`, `bin`, `order`, `point`, `row`).
        columns: the names, in order.
        data: array of shape (rows, len(columns)), SI units.
    """

    row: str
    columns: tuple[str, ...]
    data: Array

    def __post_init__(self) -> None:
        if self.data.ndim != 2 or self.data.shape[1] != len(self.columns):
            raise InputError("table", f"(rows, {len(self.columns)}) numbers", f"shape {self.data.shape}")

    def __len__(self) -> int:
        return int(self.data.shape[0])

    def column(self, name: str) -> Array:
        """Return one column, a view of shape (rows,).

        Raises:
            InputError: no column has this name.
        """
        return self.data[:, self.index(name)]

    def index(self, name: str) -> int:
        """Return the position of a column; raises InputError where there is none of that name."""
        try:
            return self.columns.index(name)
        except ValueError:
            raise InputError(f"column {name}", "one of " + ", ".join(self.columns), "none of them") from None

    def select(self, names: Sequence[str]) -> Array:
        """Return the named columns as an array of shape (rows, len(names))."""
        return self.data[:, [self.index(name) for name in names]]
