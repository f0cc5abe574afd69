"""The ring's modes in the frame of the meshes, as complex pairs.

The families A and B of a harmonic n (see `modal.ring`) move as z = z_A + i z_B. In the frame that stands still with the
planets this is Z = z exp(i n theta), and the contact at the fixed angle th_j has a constant row r exp(i n th_j):

    x_j = Re[conj(Z) r exp(i n th_j)],      r = cos bb (-sin a W - i [cos a V + (1 - r_c/r_b cos a) P]) + sin bb Z_z

with the displacement between the segments' centroids following the trigonometric functions cos n phi and sin n phi of
the modes instead of the blend of two segments. With th_j = 2 pi (j - 1) / 3 the harmonics fall into the classes
n mod 3 = 0 and, those with n mod 3 = 2 taken as conjugates, 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.modal.ring import RingModes, rigid_ring_modes, ring_modes
from nw_gear_sim.model import Laws

Key = tuple[int, int, int, int]
"""Order of a pair: class, harmonic, kind (0 in the plane, 1 axial, 2 torsion), number among its like."""


@dataclass(frozen=True)
class Pair:
    """One pair of modes of unit modal mass.

    Attributes:
        turns: n, negative where the conjugate is taken: Z turns by turns * (angle of the ring).
        square, damping: omega^2 (1/s^2) and gamma (1/s).
        normal, slide: complex rows; roll: imaginary row; see `physics.mesh.Rows`.
        weight: modal force by the ring's weight; push: imaginary modal force by 1 N m of input torque.
    """

    turns: int
    square: float
    damping: float
    normal: complex
    slide: complex
    roll: float
    weight: complex
    push: float


@dataclass(frozen=True)
class Residual:
    """Static flexibility (m/N) of the modes left out, for a mesh's own force and for that of another planet.

    Attributes:
        push: elongation by 1 N m of input torque, 1/N.
    """

    own: float
    neighbour: float
    push: float


def ring_pairs(laws: Laws, mass: Array, bandwidth: float | None) -> tuple[dict[Key, Pair], Residual]:
    """Return the pairs of the ring and what the others add.

    Args:
        laws: of the gearbox; mass: of its motions, kg.
        bandwidth: modes up to this frequency (Hz) are kept; None: a rigid ring.
    """
    law, engagement = laws.ring, laws.engagement
    own = mass[: 4 * engagement.segments]
    if bandwidth is None:
        modes = rigid_ring_modes(law, own, engagement.radius, engagement.base_radius)
        limit = math.inf
    else:
        modes, limit = ring_modes(law, own), (2 * math.pi * bandwidth) ** 2
    kept: dict[Key, Pair] = {}
    own_flex, neighbour, push = 0.0, 0.0, 0.0
    for key, pair, nyquist in _pairs(laws, modes):
        if pair.square <= limit and not nyquist:
            kept[key] = pair
            continue
        share = (0.5 if nyquist else 1.0) * abs(pair.normal) ** 2 / pair.square
        own_flex += share
        neighbour += share * math.cos(2 * math.pi / 3 * pair.turns)
        push += pair.normal.imag * pair.push / pair.square
    return kept, Residual(own_flex, neighbour, push)


def _pairs(laws: Laws, modes: RingModes) -> list[tuple[Key, Pair, bool]]:
    """All pairs with their keys, and whether they are of the highest harmonic M/2, which doesn't turn."""
    count = laws.engagement.segments
    angle = 2 * math.pi * np.arange(count) / count
    seen: dict[tuple[int, int], int] = {}
    found = []
    for k, (n, family) in enumerate(zip(modes.harmonic.tolist(), modes.family.tolist(), strict=True)):
        edge = n == 0 or 2 * n == count
        if family % 2 == 1 and not edge:
            continue  # B is A turned
        w, v, p, z = modes.shapes[:, k].reshape(4, count)
        cos, sin = np.cos(n * angle), np.sin(n * angle)
        share = 1 / count if edge else 2 / count
        if edge and family == 1:
            amplitudes = (0.0, -share * float(v @ cos), -share * float(p @ cos), 0.0)
        else:
            amplitudes = (
                share * float(w @ cos),
                share * float(v @ sin),
                share * float(p @ sin),
                share * float(z @ cos),
            )
        kind = 1 if family >= 2 else (2 if family == 1 else 0)
        number = seen.get((n, kind), 0)
        seen[n, kind] = number + 1
        pair = _pair(laws, n, float(modes.square[k]), max(0.0, float(modes.damping[k, k])), amplitudes)
        found.append(((0 if n % 3 == 0 else 1, n, kind, number), pair, n > 0 and edge))
    return found


def _pair(laws: Laws, n: int, square: float, damping: float, shape: tuple[float, float, float, float]) -> Pair:
    law, ring = laws.engagement, laws.ring
    w, v, p, z = shape
    sin, cos = math.sin(law.working_angle), math.cos(law.working_angle)
    slope = law.radius / law.base_radius
    normal = law.cos_helix * complex(-sin * w, -(cos * v + (1 - slope * cos) * p)) + law.sin_helix * z
    slide = complex(cos * w, -(sin * v + (sin / cos - slope * sin) * p))
    weight, push = 0j, 0.0
    if n == 1:
        towards = complex(ring.cos[0], -ring.sin[0])  # exp(i gravity_direction)
        weight = law.segments / 2 * ring.weight * (w - v) * towards
    if n == 0:
        push = -law.segments * ring.lever * v
    pair = Pair(n, square, damping, normal, slide, p / law.base_radius, weight, push)
    return _conjugate(pair) if n % 3 == 2 else pair


def _conjugate(pair: Pair) -> Pair:
    return Pair(
        turns=-pair.turns,
        square=pair.square,
        damping=pair.damping,
        normal=pair.normal.conjugate(),
        slide=pair.slide.conjugate(),
        roll=-pair.roll,
        weight=pair.weight.conjugate(),
        push=-pair.push,
    )
