"""Contact of the teeth as the displacement tells it, where the gap between the flanks is known."""

from __future__ import annotations

import math

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.window import Column, Indicator, MeshWindow


def contact(x: Array, half_gap: float) -> tuple[float, float]:
    """Shares of the samples without contact and with contact on the back flanks.

    Open: abs(x) <= half gap; back flank: x < -half gap. Samples stand for time; a separation shorter than a sample can
    be missed.

    Args:
        x: (samples,) displacement from the middle of the gap, m; positive towards the loaded flank.
        half_gap: displacement at which the flanks touch, m.
    """
    return float(np.mean(np.abs(x) <= half_gap)), float(np.mean(x < -half_gap))


def _compute(window: MeshWindow) -> tuple[float, ...]:
    return (math.nan, math.nan) if window.half_gap is None else contact(window.x, window.half_gap)


INDICATOR = Indicator(
    (
        Column("open_share", "", "share of the samples with open teeth: displacement within the configured gap"),
        Column("back_flank_share", "", "share of the samples with contact on the back flanks"),
    ),
    _compute,
)
