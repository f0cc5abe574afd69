"""Sliding friction of the flanks: Buckingham's coefficient integrated over the clipped contact lines (paper Eqs 4-18).

A contact point at the distance s from the pitch point along the line of action (approach s < 0) slides at
|V| = |s| w, where w is the sum of both angular speeds (their difference in an internal mesh). With the elastic load
spread evenly over the total length L of the contact lines the friction force and its first moment are, over that load,

    g(phase)  = 1/L int sgn(-s) mu(|s| w) dl,      g_1(phase) = 1/L int sgn(-s) mu(|s| w) s dl

where tooth i covers s from s_i - eps_beta p_bt to s_i = -approach + p_bt (phase / 2 pi + i), clipped to the path of
contact. One integral for any contact ratio; the paper's five branches (Eq 11) need eps_beta <= eps_alpha / 2.
The integrals are exact; between the table's phases they are interpolated linearly: against the exact ones rms 0.02 %
of the coefficient of friction, at most 0.3 % next to kinks (256 phases, stage I).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import kernel

PHASES = 256
"""Phases in a mesh period that have a table entry."""
LEAST_OVERLAP = 1e-3
"""Spur teeth enter over this share of a pitch instead of at once."""
FADE_RATIO = 5e-3
"""Below this share of rated speed the friction fades to zero, since at rest it has no direction."""


class FrictionLaw(NamedTuple):
    """Data of the three stages, arrays of shape (3,), and the coefficients of mu(V).

    Attributes:
        approach, recess, pitch: of the path of contact, m; overlap: eps_beta.
        sliding: w over the ring's speed; fade_speed: ring speed below which friction fades, rad/s.
        base, decay, growth: mu(V) = base exp(-decay V) + growth sqrt V.
    """

    approach: Array
    recess: Array
    pitch: Array
    overlap: Array
    sliding: Array
    fade_speed: float
    base: float
    decay: float
    growth: float


def empty_table() -> Array:
    """Return a table for `fill_table`: shape (stages, 2, PHASES + 1)."""
    return np.zeros((3, 2, PHASES + 1))


@kernel
def fill_table(law: FrictionLaw, speed: float, table: Array) -> None:
    """Fill a table with g and g_1 (m) of each stage at a ring speed (rad/s)."""
    fade = min(1.0, max(0.0, speed) / law.fade_speed)
    for stage in range(3):
        for k in range(PHASES):
            force, moment = friction_share(law, stage, 2.0 * math.pi * k / PHASES, speed)
            table[stage, 0, k] = fade * force
            table[stage, 1, k] = fade * moment
        table[stage, 0, PHASES] = table[stage, 0, 0]
        table[stage, 1, PHASES] = table[stage, 1, 0]


@kernel
def friction_share(law: FrictionLaw, stage: int, phase: float, speed: float) -> tuple[float, float]:
    """Return g and g_1 (m) of a stage (0, 1, 2) at a mesh phase in [0, 2 pi) (rad) and a ring speed (rad/s)."""
    pitch, overlap = law.pitch[stage], max(law.overlap[stage], LEAST_OVERLAP)
    low, high = -law.approach[stage], law.recess[stage]
    rate = law.sliding[stage] * max(0.0, speed)
    length, force, moment = 0.0, 0.0, 0.0
    head = low + pitch * phase / (2.0 * math.pi)
    while head - overlap * pitch < high:
        start, end = max(low, head - overlap * pitch), min(high, head)
        if end > start:
            length += end - start
            force_start, moment_start = _integrals(law, start, rate)
            force_end, moment_end = _integrals(law, end, rate)
            force += force_end - force_start
            moment += moment_end - moment_start
        head += pitch
    return force / length, moment / length


@kernel
def _integrals(law: FrictionLaw, s: float, rate: float) -> tuple[float, float]:
    """Integrals from 0 to s of sgn(-s) mu and of sgn(-s) mu s."""
    u = abs(s)
    k = law.decay * rate
    x = k * u
    if x < 1e-3:  # series, where the closed form cancels
        flat = u * (1.0 - x / 2.0 + x * x / 6.0)
        sloped = u * u * (0.5 - x / 3.0 + x * x / 8.0)
    else:
        flat = -math.expm1(-x) / k
        sloped = (-math.expm1(-x) - x * math.exp(-x)) / (k * k)
    root = law.growth * math.sqrt(rate * u)
    zeroth = law.base * flat + root * u * 2.0 / 3.0
    first = law.base * sloped + root * u * u * 2.0 / 5.0
    return -zeroth, -math.copysign(first, s)


@kernel
def look_up(start: Array, end: Array, share: float, stage: int, phase: float) -> tuple[float, float]:
    """Interpolate g and g_1 (m) between two tables, `share` of the way from start to end; phase in rad, any turn."""
    turns = phase / (2.0 * math.pi)
    place = (turns - math.floor(turns)) * PHASES
    k = min(int(place), PHASES - 1)
    f = place - k
    a, b = (1.0 - share) * (1.0 - f), (1.0 - share) * f
    c, d = share * (1.0 - f), share * f
    force = a * start[stage, 0, k] + b * start[stage, 0, k + 1] + c * end[stage, 0, k] + d * end[stage, 0, k + 1]
    moment = a * start[stage, 1, k] + b * start[stage, 1, k + 1] + c * end[stage, 1, k] + d * end[stage, 1, k + 1]
    return force, moment
