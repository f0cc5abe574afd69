"""Every indicator that `indicators/<bearing>` carries, in the order of its columns."""

from __future__ import annotations

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Table
from nw_gear_monitor.indicators import bearing_envelope, bearing_shape
from nw_gear_monitor.indicators.bearing_window import BearingIndicator, BearingWindow
from nw_gear_monitor.indicators.window import Column

ALL: tuple[BearingIndicator, ...] = (
    bearing_shape.SHAPE,
    bearing_shape.LINES,
    bearing_envelope.INDICATOR,
    bearing_shape.IMPULSES,
)
COLUMNS: tuple[Column, ...] = tuple(column for indicator in ALL for column in indicator.columns)


def evaluate(time: float, window: BearingWindow | None) -> Table:
    """One row of `indicators/<bearing>`.

    Args:
        time: end of the window, s.
        window: None where it isn't filled yet: every indicator is NaN then.
    """
    if window is None:
        values: tuple[float, ...] = (float("nan"),) * len(COLUMNS)
    else:
        values = tuple(value for indicator in ALL for value in _values(indicator, window))
    return Table(names.ROW_ROW, ("time", *(column.name for column in COLUMNS)), np.array([[time, *values]]))


def _values(indicator: BearingIndicator, window: BearingWindow) -> tuple[float, ...]:
    """The indicator's numbers; NaN where it refuses the window (a constant, nothing in the band, too short)."""
    try:
        return indicator.compute(window)
    except InputError:
        return (float("nan"),) * len(indicator.columns)
