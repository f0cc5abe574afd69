"""Every indicator that `indicators/<mesh>` carries, in the order of its columns. A new one: a file and a line here."""

from __future__ import annotations

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.indicators import (
    crest_factor,
    kurtosis,
    line_state,
    mean,
    mesh_harmonics,
    off_line_ratio,
    peak_to_peak,
    rms,
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
        values = tuple(value for indicator in ALL for value in indicator.compute(window))
    return Table(names.ROW_ROW, ("time", *(column.name for column in COLUMNS)), np.array([[time, *values]]))
