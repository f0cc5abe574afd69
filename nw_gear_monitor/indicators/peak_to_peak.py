"""Largest less smallest displacement."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.window import single


def peak_to_peak(x: Array) -> float:
    """max(x) - min(x), in the unit of x (samples,). A single outlier decides it; it grows with the length of the window for noise."""
    return float(np.ptp(x))


INDICATOR = single("peak_to_peak", "m", "largest less smallest displacement", lambda window: peak_to_peak(window.x))
