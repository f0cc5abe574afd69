"""Poincaré sections: the state (x, v) of a mesh each time its own mesh phase passes a fixed value."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.signals.hermite import crossings, interpolate


def section(time: Array, phase: Array, x: Array, v: Array, at: float, low: float, high: float) -> Array:
    """Points of one mesh's section.

    Args:
        time: (samples,) s.
        phase: (samples,) unwrapped phase of this mesh, rad, increasing.
        x, v: (samples,) displacement (m) and velocity (m/s).
        at: phase of the section, rad, taken modulo 2 pi.
        low, high: only crossings at sample numbers (fractional) low <= number < high are given; the samples outside
            serve the interpolation.

    Returns:
        (points, 3): time (s), x (m), v (m/s). Empty where the phase doesn't grow by a sample step (not turning).
    """
    cycle = 2.0 * np.pi
    if phase.size < 2 or not np.all(np.diff(phase) > 0):
        return np.empty((0, 3))
    counts = np.arange(np.ceil((phase[0] - at) / cycle), np.floor((phase[-1] - at) / cycle) + 1.0)
    position = crossings(phase, at + cycle * counts)
    position = position[(position >= low) & (position < high)]
    step = (time[-1] - time[0]) / (time.size - 1)
    points_x, points_v = interpolate(position, x[:, None], v[:, None], step)
    moments = np.interp(position, np.arange(time.size), time)
    return np.column_stack([moments, points_x[:, 0], points_v[:, 0]])
