"""When the flanks of an orbit touch each other."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.harmonics import Orbit, basis

SAMPLES = 4096


def contacts(orbit: Orbit) -> tuple[Array, bool]:
    """Return the angles nu t in [0, 2 pi) where flanks touch or part, and whether they touch after the first.

    The angles ascend. Where there is none, the second says whether flanks touch all the time. Contacts shorter than
    2 pi/4096 are missed.
    """
    grid = 2.0 * np.pi * np.arange(SAMPLES + 1) / SAMPLES
    x = basis(orbit.order, grid) @ orbit.coefficients
    touch = np.abs(x) > 1.0
    where = np.flatnonzero(touch[1:] != touch[:-1])
    if len(where) == 0:
        return np.empty(0), bool(touch[0])
    flank = np.sign(x[where] + x[where + 1])
    k = np.arange(1, orbit.order + 1)
    a, b = orbit.coefficients[1 : orbit.order + 1], orbit.coefficients[orbit.order + 1 :]
    angles = 0.5 * (grid[where] + grid[where + 1])
    for _ in range(6):
        turned = np.multiply.outer(angles, k)
        slope = np.cos(turned) @ (k * b) - np.sin(turned) @ (k * a)
        step = (basis(orbit.order, angles) @ orbit.coefficients - flank) / np.where(slope == 0.0, 1.0, slope)
        angles = np.clip(angles - step, grid[where], grid[where + 1])
    return angles, bool(touch[where[0] + 1])
