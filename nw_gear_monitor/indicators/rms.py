"""Root mean square of the displacement about its mean."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.window import single


def rms(x: Array) -> float:
    """Return sqrt(mean((x - mean x)^2)) of x (samples,); the mean is taken out because it is load, not vibration."""
    return float(np.std(x))


INDICATOR = single("rms", "m", "root mean square of the displacement about its mean", lambda window: rms(window.x))
