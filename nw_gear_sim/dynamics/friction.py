"""Tooth friction: one clipped integral along the contact lines, as tables over the mesh phase.

Per unit of normal force the driven gear feels the friction force g_0 and both gears moments made of g_0 and g_1:

    g_m(Phi) = 1/L sum_i int_(line i inside the plane of action) sgn(-s) mu(|V|) s^m dl,        m = 0, 1

s is the signed distance of a contact point from the pitch point along the line of action (approach s < 0), and
V = (omega_driver +- omega_driven) |s| the sliding speed. mu = base e^(-decay |V|) + growth sqrt(|V|), Buckingham's
semi-empirical coefficient (paper Eq 8, with |V| since the printed form fails for V < 0). Contact line i enters at
mesh phase Phi = 0: on the transverse plane at axial position b it stands at s = -approach + p_bt (Phi/2 pi + i) -
b tan beta_b. The five cases of the paper's Eq 11 hold for stage I only (they need eps_beta <= eps_alpha / 2); clipping
holds for all.

Since dl = ds / sin beta_b on every line, the integrals follow from primitives in s, computed once per speed:
-int_0^|s| mu dr for g_0 (even in s), -sgn(s) int_0^|s| mu r dr for g_1 (odd), on a grid that is dense at the pitch point.
"""

from __future__ import annotations

import math

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.geometry import PairGeometry
from nw_gear_sim.params import Friction

PHASES = 1024
"""Entries of a table over one mesh period."""
_POINTS = 4001
"""Points of the primitives along the path of contact."""
MOMENTS = 2


def coefficient(friction: Friction, sliding: Array) -> Array:
    """Buckingham's coefficient of friction; sliding speed in m/s."""
    speed = np.abs(sliding)
    return friction.base * np.exp(-friction.decay * speed) + friction.growth * np.sqrt(speed)


def sliding_rate(pair: PairGeometry, driver_speed: float) -> float:
    """Sliding speed per distance from the pitch point, |omega_driver -+ omega_driven|, rad/s."""
    driven = driver_speed * pair.speed_ratio
    return abs(driver_speed - driven) if pair.internal else abs(driver_speed) + abs(driven)


def contact_lines(pair: PairGeometry) -> tuple[Array, Array]:
    """Ends of every contact line, clipped to the plane of action.

    Returns:
        Two arrays (phases, lines) of the lower and the upper end s in metres; equal where a line is outside.
    """
    phase = np.arange(PHASES)[:, None] / PHASES
    overlap = pair.face_width / pair.halves * math.tan(pair.base_helix)
    lines = np.arange(math.ceil(pair.contact_ratio + overlap / pair.base_pitch) + 1)[None, :]
    front = -pair.approach + pair.base_pitch * (phase + lines)
    high = np.clip(front, -pair.approach, pair.recess)
    low = np.clip(front - overlap, -pair.approach, pair.recess)
    return low, high


def tables(pair: PairGeometry, friction: Friction, driver_speed: float, fade_speed: float) -> Array:
    """Return g_0 (dimensionless) and g_1 (m) over one mesh period, shape (2, PHASES + 1), periodic.

    Linear interpolation between entries is meant. Zero where friction is switched off. Below `fade_speed` (rad/s of the
    driver) friction falls linearly to zero at rest, where its sense has no meaning.
    """
    result = np.zeros((MOMENTS, PHASES + 1))
    if not friction.enabled:
        return result
    distance = max(pair.approach, pair.recess) * np.linspace(0.0, 1.0, _POINTS) ** 2
    mu = coefficient(friction, sliding_rate(pair, driver_speed) * distance)
    low, high = contact_lines(pair)
    length = (high - low).sum(axis=1)
    for m in range(MOMENTS):
        integrand = mu * distance**m
        steps = 0.5 * (integrand[1:] + integrand[:-1]) * np.diff(distance)
        primitive = -np.concatenate([[0.0], np.cumsum(steps)])
        ends = [np.sign(s) ** m * np.interp(np.abs(s), distance, primitive) for s in (high, low)]
        result[m, :-1] = (ends[0] - ends[1]).sum(axis=1) / length
    result[:, -1] = result[:, 0]
    if abs(driver_speed) < fade_speed:
        result *= abs(driver_speed) / fade_speed
    return result
