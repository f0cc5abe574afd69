"""Which columns of a waveform are looked at, and what makes a block one that can't be read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Table

LEAST_ROWS = 2
"""A block of one sample tells no sample rate."""
LARGEST = 1e60
"""A value beyond this is no measurement; its fourth power would hardly be one."""


@dataclass(frozen=True)
class Layout:
    """Columns that a waveform has to have besides `time`, and some that it may have; their order doesn't matter.

    Attributes:
        phases: unwrapped phases, rad.
        cycles: mesh cycles per turn of each (the largest, where several stages follow it).
        values: everything else that has to be there.
        optional: what is looked at where it is there.
    """

    phases: tuple[str, ...]
    cycles: tuple[float, ...]
    values: tuple[str, ...]
    optional: tuple[str, ...] = ()

    @property
    def required(self) -> tuple[str, ...]:
        """Everything that has to be there."""
        return ("time", *self.phases, *self.values)

    def chosen(self, columns: tuple[str, ...]) -> tuple[str, ...]:
        """The columns that are looked at of those that a block has, in an order of its own."""
        return (*self.required, *(name for name in self.optional if name in columns))


def malformed(table: Table, layout: Layout) -> str:
    """Say in words why a table can't be a block of the waveform; an empty text where it can."""
    if table.row != names.ROW_SAMPLE:
        return f"row meaning: expected {names.ROW_SAMPLE}, got {table.row or 'none'}"
    missing = [name for name in layout.required if name not in table.columns]
    if missing:
        return f"columns: expected {', '.join(layout.required)}, got none named {', '.join(missing)}"
    if len(set(table.columns)) != len(table.columns):
        return "columns: expected different names, got a name twice"
    if len(table) < LEAST_ROWS:
        return f"rows: expected at least {LEAST_ROWS}, got {len(table)}"
    return _wrong_values(table, layout.chosen(table.columns))


def _wrong_values(table: Table, chosen: tuple[str, ...]) -> str:
    data = table.data if chosen == table.columns else table.select(chosen)
    usable = np.abs(data) < LARGEST  # False for NaN
    if not usable.all():
        column = chosen[int(np.argmin(usable.all(axis=0)))]
        return f"values: expected finite numbers, got others in column {column}"
    if not np.median(np.diff(data[:, 0])) > 0.0:
        return "time: expected stamps that ascend, got others"
    return ""
