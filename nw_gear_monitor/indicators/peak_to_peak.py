"""Largest less smallest displacement."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.window import single


def peak_to_peak(x: Array) -> float:
    """Return max(x) - min(x) of x (samples,); one outlier decides it, and noise raises it with the window's length."""
    return float(np.ptp(x))


INDICATOR = single("peak_to_peak", "m", "largest less smallest displacement", lambda window: peak_to_peak(window.x))
