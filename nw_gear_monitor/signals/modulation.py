"""How line amplitudes may change within a window: polynomials of speed and load.

A gearbox under wind passes its resonances slowly back and forth: at constant conditions a line is one complex number,
in a window with changing speed it is a curve over speed and load. Polynomials of both, scaled to the window's range,
describe it. They are made orthonormal over the window; members which add nothing new are left out.
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
TERMS = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3), (4, 0), (3, 1), (0, 4))
"""Degrees in speed and load, tried in this order."""
NEWNESS = 0.02
"""A term is left out if less than this share of it (rms) isn't already a sum of the ones before."""


@dataclass(frozen=True, eq=False)
class Modulation:
    """The amplitude curves of a window.

    Attributes:
        maps: (seconds, SHAPES, functions): each second's Legendre coefficients of every function; function 0 is 1.
        speed_spread, load_spread: (largest - smallest) / mean over the window.
    """

    maps: Array
    speed_spread: float
    load_spread: float

    @property
    def functions(self) -> int:
        """Number of amplitude curves."""
        return int(self.maps.shape[2])


def spread(values: Array) -> float:
    """Largest less smallest value over the absolute mean; infinite for a mean of zero."""
    mean = abs(float(np.mean(values)))
    return float(np.ptp(values)) / mean if mean > 0.0 else float("inf")


def modulation(speed: Array, load: Array) -> Modulation:
    """Choose the amplitude curves for a window.

    Args:
        speed: (seconds, nodes) any measure of speed at the nodes of every second.
        load: (seconds, nodes) any measure of load.
    """
    seconds = len(speed)
    speed_spread, load_spread = spread(speed), spread(load)
    s, p = _scaled(speed), _scaled(load)
    weights = np.tile(np.sqrt(0.5 * WEIGHTS), seconds)
    functions = [np.ones(speed.size)]
    basis = [weights / np.linalg.norm(weights)]
    for in_speed, in_load in TERMS:
        if (in_speed and speed_spread < LEAST_SPEED_SPREAD) or (in_load and load_spread < LEAST_LOAD_SPREAD):
            continue
        term = weights * _legendre(s, in_speed) * _legendre(p, in_load)
        rest = term.copy()
        for _ in range(2):  # twice is enough for orthogonality to rounding
            for vector in basis:
                rest -= vector * float(vector @ rest)
        if np.linalg.norm(rest) > NEWNESS * np.linalg.norm(term):
            basis.append(rest / np.linalg.norm(rest))
            functions.append(basis[-1] * np.sqrt(seconds) / weights)
    values = np.stack(functions, axis=-1).reshape(seconds, NODES.size, len(functions))
    projector = (np.arange(SHAPES) + 0.5)[:, None] * legendre.legvander(NODES, SHAPES - 1).T * WEIGHTS
    return Modulation(np.einsum("pn,bnm->bpm", projector, values), speed_spread, load_spread)


def _scaled(values: Array) -> Array:
    flat = values.ravel()
    half = 0.5 * float(np.ptp(flat))
    result: Array = (flat - flat.min()) / half - 1.0 if half > 0.0 else np.zeros_like(flat)
    return result


def _legendre(values: Array, degree: int) -> Array:
    result: Array = legendre.legval(values, np.eye(degree + 1)[degree])
    return result
