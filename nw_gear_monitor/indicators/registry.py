"""Every indicator that `indicators/<mesh>` carries, in the order of its columns. A new one: a file and a line here."""

from __future__ import annotations

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Table
from nw_gear_monitor.indicators import (
    contact,
    crest_factor,
    gear_turns,
    kurtosis,
    line_state,
    mean,
    mesh_harmonics,
    off_line_ratio,
    peak_to_peak,
    rms,
    strobed_motion,
    subharmonics,
)
from nw_gear_monitor.indicators.window import Column, Indicator, MeshWindow

ALL: tuple[Indicator, ...] = (
    mean.INDICATOR,
    rms.INDICATOR,
    peak_to_peak.INDICATOR,
    crest_factor.INDICATOR,
    kurtosis.INDICATOR,
    mesh_harmonics.INDICATOR,
    subharmonics.INDICATOR,
    off_line_ratio.INDICATOR,
    line_state.INDICATOR,
    contact.INDICATOR,
    gear_turns.SIDEBANDS,
    gear_turns.AVERAGES,
    strobed_motion.INDICATOR,
)
COLUMNS: tuple[Column, ...] = tuple(column for indicator in ALL for column in indicator.columns)


def evaluate(time: float, window: MeshWindow | None) -> Table:
    """One row of `indicators/<mesh>`.

    Args:
        time: end of the window, s.
        window: None where it isn't filled yet: every indicator is NaN then.
    """
    if window is None:
        values: tuple[float, ...] = (float("nan"),) * len(COLUMNS)
    else:
        values = tuple(value for indicator in ALL for value in _values(indicator, window))
    return Table(names.ROW_ROW, ("time", *(column.name for column in COLUMNS)), np.array([[time, *values]]))


def _values(indicator: Indicator, window: MeshWindow) -> tuple[float, ...]:
    """The indicator's numbers; NaN where it refuses the window (a constant, no mesh line, too short)."""
    try:
        return indicator.compute(window)
    except InputError:
        return (float("nan"),) * len(indicator.columns)
