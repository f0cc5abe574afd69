"""How line amplitudes may change within a window: splines in time with a knot at every second.

At constant conditions a line is one complex number for the whole window. Under wind, speed and load wander, resonances
are passed slowly back and forth, and each line's amplitude is a curve. Quadratic B-splines describe any curve that is
smooth on the scale of a second, without knowing what made it. A line with such a curve takes up about 1 Hz of
bandwidth, so that broadband motion between the lines stays residual.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from nw_gear_common.tables import Array
from nw_gear_monitor.signals.normal import NODES, SHAPES, WEIGHTS

LEAST_SPEED_SPREAD = 0.005
"""Below this (largest less smallest over mean) speed counts as constant."""
LEAST_LOAD_SPREAD = 0.05
"""The same for load, of which the mean displacement of the meshes is the measure."""

SECONDS_BETWEEN_NODES = 0.5 * float(NODES[-1] - NODES[0])
"""Between the first and the last node of a second."""


@dataclass(frozen=True, eq=False)
class Modulation:
    """The amplitude curves of a window.

    Attributes:
        maps: (seconds, SHAPES, functions): each second's Legendre coefficients of every function.
        speed_spread, load_spread: (largest - smallest) / mean over the window.
        speed_rate: the fastest relative change of speed within a second, 1/s.
    """

    maps: Array
    speed_spread: float
    load_spread: float
    speed_rate: float

    @property
    def functions(self) -> int:
        """Number of amplitude curves."""
        return int(self.maps.shape[2])


def spread(values: Array) -> float:
    """Largest less smallest value over the absolute mean; infinite for a mean of zero."""
    mean = abs(float(np.mean(values)))
    return float(np.ptp(values)) / mean if mean > 0.0 else float("inf")


def modulation(speed: Array, load: Array) -> Modulation:
    """Choose the amplitude curves for a window: a constant, or splines where speed or load change.

    Args:
        speed: (seconds, nodes) any measure of speed at the nodes of every second.
        load: (seconds, nodes) any measure of load.
    """
    speed_spread, load_spread = spread(speed), spread(load)
    constant = speed_spread < LEAST_SPEED_SPREAD and load_spread < LEAST_LOAD_SPREAD
    maps = _constant(len(speed)) if constant else _splines(len(speed))
    within = np.ptp(speed, axis=1) / np.abs(speed.mean(axis=1))
    return Modulation(maps, speed_spread, load_spread, float(np.max(within)) / SECONDS_BETWEEN_NODES)


def _constant(seconds: int) -> Array:
    maps = np.zeros((seconds, SHAPES, 1))
    maps[:, 0, 0] = 1.0
    return maps


def _splines(seconds: int) -> Array:
    """Uniform quadratic B-splines: three of the seconds + 2 functions differ from zero in each second."""
    u = 0.5 * (NODES + 1.0)
    pieces = np.stack([0.5 * (1.0 - u) ** 2, 0.5 + u - u**2, 0.5 * u**2])
    projector = (np.arange(SHAPES) + 0.5)[:, None] * legendre.legvander(NODES, SHAPES - 1).T * WEIGHTS
    shapes = projector @ pieces.T
    maps = np.zeros((seconds, SHAPES, seconds + 2))
    for second in range(seconds):
        maps[second, :, second : second + 3] = shapes
    return maps
