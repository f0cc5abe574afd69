"""Fourth standardised moment: how much impacts stand out."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.window import single


def kurtosis(x: Array) -> float:
    """Return mean(d^4) / mean(d^2)^2 with d = x - mean x; NaN for a constant.

    1.5 for a sine, 3 for normal noise (no 3 is subtracted).
    """
    square = (x - np.mean(x)) ** 2
    variance = float(np.mean(square))
    return float(np.mean(square * square)) / variance**2 if variance > 0.0 else float("nan")


INDICATOR = single("kurtosis", "", "fourth standardised moment (normal noise: 3)", lambda window: kurtosis(window.x))
