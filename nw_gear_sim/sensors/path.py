"""From a bearing's force to the acceleration of its housing: one damped oscillator for each bearing and direction.

    m x'' + 2 zeta w m x' + w^2 m x = F,     w = 2 pi f,     a = x''

m, f and zeta are guesses (section `housing` of the configuration): the model's bearings stand on ground, and this is
the least that has a resonance. What it leaves out: how the force of one bearing shakes the housing at another, and all
further modes. Far above f the housing answers as a free mass (a = F / m), far below as a spring (a = -w_F^2 F / k).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from nw_gear_common.tables import Array
from nw_gear_sim.kinematics import bearing_kind
from nw_gear_sim.params import Configuration, Housing

AXES = ("x", "y")


class Path(NamedTuple):
    """The exact step of several oscillators under forces that run linearly from sample to sample.

        z = (x, x'),   z[n+1] = step z[n] + now F[n] + then F[n+1],   a[n] = out z[n] + F[n] / m

    Attributes:
        step: (channels, 2, 2); now, then: (channels, 2); out: (channels, 2).
        inertance: 1 / m, (channels,), 1/kg; compliance: 1 / (m w^2), (channels,), m/N.
    """

    step: Array
    now: Array
    then: Array
    out: Array
    inertance: Array
    compliance: Array


def make_path(housings: Sequence[Housing], interval: float) -> Path:
    """Prepare the step of oscillators.

    The force is held by a first-order hold, for which the step is exact: the exponential of

        [ A  B   0  ]
        [ 0  0  1/h ] h,     A = [0 1; -w^2 -2 zeta w],   B = (0, 1/m)
        [ 0  0   0  ]

    Source: Franklin, Powell, Workman, "Digital control of dynamic systems", triangle-hold equivalent, from memory.

    Args:
        housings: one for each channel.
        interval: between samples, s.
    """
    channels = len(housings)
    path = Path(
        np.zeros((channels, 2, 2)),
        np.zeros((channels, 2)),
        np.zeros((channels, 2)),
        np.zeros((channels, 2)),
        np.zeros(channels),
        np.zeros(channels),
    )
    for k, housing in enumerate(housings):
        w = 2.0 * math.pi * housing.frequency
        damping = 2.0 * housing.damping_ratio * w
        extended = np.zeros((4, 4))
        extended[:2, :2] = [[0.0, 1.0], [-w * w, -damping]]
        extended[1, 2] = 1.0 / housing.mass
        extended[2, 3] = 1.0 / interval
        whole = expm(extended * interval)
        path.step[k] = whole[:2, :2]
        path.then[k] = whole[:2, 3]
        path.now[k] = whole[:2, 2] - whole[:2, 3]
        path.out[k] = [-w * w, -damping]
        path.inertance[k] = 1.0 / housing.mass
        path.compliance[k] = 1.0 / (housing.mass * w * w)
    return path


def housings_of(configuration: Configuration, bearings: Sequence[str]) -> list[Housing]:
    """Return the housing under each channel: x and y of the first bearing, of the second, and so on."""
    return [getattr(configuration.housing, bearing_kind(bearing)) for bearing in bearings for _ in AXES]


def transfer(housing: Housing, frequency: Array) -> Array:
    """Return |a / F| of a housing at frequencies (Hz), 1/kg: w_F^2 / (m |w^2 - w_F^2 + 2 i zeta w w_F|)."""
    w, forced = 2.0 * math.pi * housing.frequency, 2.0 * math.pi * np.asarray(frequency, dtype=np.float64)
    dynamic = w * w - forced**2 + 2j * housing.damping_ratio * w * forced
    return np.asarray(forced**2 / (housing.mass * np.abs(dynamic)), dtype=np.float64)
