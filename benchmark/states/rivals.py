"""The plain ways to label a strobed section, for comparison: 0-1 test alone, counting clusters, fixed recurrence."""

from __future__ import annotations

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.zero_one import zero_one
from nw_gear_monitor.signals.resample import whole_turns
from states.cases import Signal

TOLERANCE = 1e-2
"""Of the section's standard deviation: what a user sets who doesn't know the noise."""
CHAOTIC_K = 0.5
LONGEST = 16


def section(signal: Signal) -> Array:
    """(strobes, coordinates): one point a period, coordinates in units of their standard deviation over all samples."""
    parts = []
    for channel in (signal.x, signal.v):
        if channel is not None and np.ptp(channel) > 0.0:
            scaled = (channel - channel.mean()) / channel.std()
            parts.append(scaled if signal.phase is None else whole_turns(signal.phase, scaled, per_turn=4).values[:, 0])
    return np.column_stack(parts)


def by_zero_one(points: Array) -> str:
    """K above 0.5: chaotic; else regular, which says neither the period nor torus."""
    return names.CHAOTIC if zero_one(points[:, 0]) > CHAOTIC_K else "regular"


def by_clusters(points: Array) -> str:
    """Number of clusters of points nearer than TOLERANCE: up to 16 are a period, more are chaos."""
    centres: list[Array] = []
    for point in points:
        if all(np.max(np.abs(point - centre)) > TOLERANCE for centre in centres):
            centres.append(point)
            if len(centres) > LONGEST:
                return names.CHAOTIC
    return names.PERIODS[len(centres) - 1]


def by_recurrence(points: Array) -> str:
    """Smallest n for which 90 % of abs(P(k + n) - P(k)) are below TOLERANCE; where there is none, K decides."""
    for n in range(1, LONGEST + 1):
        if float(np.quantile(np.max(np.abs(points[n:] - points[:-n]), axis=1), 0.9)) < TOLERANCE:
            return names.PERIODS[n - 1]
    return names.CHAOTIC if zero_one(points[:, 0]) > CHAOTIC_K else names.QUASI_PERIODIC


def right(label: str, truth: str) -> bool:
    """Whether a rival's label is right; `regular` is granted for anything but chaos."""
    return label == truth or (label == "regular" and truth != names.CHAOTIC)
