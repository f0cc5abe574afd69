"""Largest deviation from the mean over the root mean square."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.window import single


def crest_factor(x: Array) -> float:
    """Return max|x - mean x| / rms about the mean: sqrt 2 for a sine, 4 to 5 for noise; NaN for a constant."""
    deviation = x - np.mean(x)
    rms = float(np.sqrt(np.mean(deviation * deviation)))
    return float(np.max(np.abs(deviation))) / rms if rms > 0.0 else float("nan")


INDICATOR = single(
    "crest_factor", "", "largest deviation from the mean over rms", lambda window: crest_factor(window.x)
)
