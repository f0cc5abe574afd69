"""Energy outside the mesh's own harmonics over all energy: a cheap cue, which other stages' lines raise as well."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.mesh_harmonics import DIVISORS, mesh_lines
from nw_gear_monitor.indicators.window import single


def off_line_ratio(amplitudes: Sequence[float], x: Array) -> float:
    """1 - sum_k A_k^2 / 2 / var(x) over the first five harmonics k of the mesh frequency, at least 0.

    Args:
        amplitudes: of the first harmonics of the mesh frequency, m.
        x: (samples,) m.

    Returns:
        0 for a signal of these harmonics alone, 1 for one without them; NaN for a constant or when nothing turns.
        Slow load changes count as outside; `residual_ratio` is the measure that takes them and other stages out.
    """
    variance = float(np.var(x))
    if variance == 0.0:
        return float("nan")
    power = 0.5 * float(np.sum(np.square(amplitudes)))
    return max(1.0 - power / variance, 0.0) if np.isfinite(power) else float("nan")


INDICATOR = single(
    "off_line_ratio",
    "",
    "energy outside the mesh harmonics over all",
    lambda window: off_line_ratio(window.once(mesh_lines)[len(DIVISORS) :], window.x),
)
