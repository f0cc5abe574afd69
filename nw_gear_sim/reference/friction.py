"""Contact lines of a mesh and the friction at each of their points (paper Eqs 4-14, with the load spread evenly)."""

import math
from itertools import pairwise

import numpy as np

from nw_gear_sim.kinematics import Stage
from nw_gear_sim.params import Friction

GAUSS_NODES, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(40)


def contact_lines(stage: Stage, phase: float) -> list[tuple[float, float]]:
    """Contact lines at a phase as intervals of s, the distance from the pitch point along the line of action.

    A line runs over the face width b at the slope tan(beta_b), which is eps_beta p_bt along s; its front end has
    moved by the phase over 2 pi times p_bt since the tooth entered.
    """
    pair = stage.pair
    overlap = pair.overlap_ratio * pair.base_pitch
    start = (phase / (2 * math.pi) % 1.0) * pair.base_pitch
    lines = []
    for tooth in range(math.ceil(pair.contact_ratio + pair.overlap_ratio) + 1):
        front = -pair.approach + start + tooth * pair.base_pitch
        low, high = max(front - overlap, -pair.approach), min(front, pair.recess)
        if high > low:
            lines.append((low, high))
    return lines


def sliding_friction(friction: Friction, stage: Stage, phase: float, speed: float) -> list[tuple[float, float]]:
    """Points s of the contact lines and the friction there over the normal force of the whole mesh.

    The normal force is spread evenly over the contact lines. Positive while the driver's flank slides inwards.
    """
    pair = stage.pair
    driver = speed * stage.mesh_ratio / pair.driver.teeth
    driven = driver * pair.speed_ratio
    slide = abs(driven - driver) if pair.internal else driven + driver
    lines = contact_lines(stage, phase)
    total = sum(high - low for low, high in lines)
    out = []
    for low, high in lines:
        cuts = [low, 0.0, high] if low < 0 < high else [low, high]
        for start, end in pairwise(cuts):
            for s, weight in _square_root_gauss(start, end):
                velocity = slide * abs(s)
                mu = friction.base * math.exp(-friction.decay * velocity) + friction.growth * math.sqrt(velocity)
                out.append((s, -math.copysign(mu, s) * weight / total))
    return out


def _square_root_gauss(start: float, end: float) -> list[tuple[float, float]]:
    """Points and weights of an integral over [start, end] on one side of 0, exact for smooth functions of sqrt|s|."""
    sign = -1.0 if start + end < 0 else 1.0
    low, high = sorted(math.sqrt(abs(bound)) for bound in (start, end))
    roots = (low + high) / 2 + (high - low) / 2 * GAUSS_NODES
    return [(sign * r * r, 2 * r * w * (high - low) / 2) for r, w in zip(roots, GAUSS_WEIGHTS, strict=True)]
