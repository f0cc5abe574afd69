"""Mean displacement of the mesh over the window."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.window import single


def mean(x: Array) -> float:
    """Mean of x (samples,), in its unit. It follows the load: x = F / K where the flanks stay in contact."""
    return float(np.mean(x))


INDICATOR = single("mean", "m", "mean displacement of the mesh over the window", lambda window: mean(window.x))
