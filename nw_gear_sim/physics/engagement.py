"""Where the turning ring's segments engage with a planet, and with which rows of the mesh (paper Eqs 29-31).

The contact of planet j is at the angle A = th_j - theta of the ring, between the centroids of segment i0 = floor(A/p)
and the next one, p = 2 pi / M. The displacement of the contact point is extrapolated as a rigid motion from both and
blended with weights 1 - s, s, s = A/p - i0; the force is shared out alike. Continuous in displacement and force, and
exact for rigid motions. With D_i = phi_i - th_j, segment i enters x_n with

    cos bb [sin(D - a) w + cos(D - a) v + (r_b - r_c cos(D - a)) psi] + sin bb z
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import kernel

Indices = npt.NDArray[np.int64]


class EngagementLaw(NamedTuple):
    """Data of the internal meshes.

    Attributes:
        planet_angle: th_j, rad, shape (3,).
        segments: M; pitch: 2 pi / M, rad; radius: r_c, m; base_radius: of the ring, m.
        working_angle: a, rad; cos_helix, sin_helix: of the base helix angle.
    """

    planet_angle: Array
    segments: int
    pitch: float
    radius: float
    base_radius: float
    working_angle: float
    cos_helix: float
    sin_helix: float


@kernel
def engage(
    law: EngagementLaw,
    angle: float,
    speed: float,
    place: Indices,
    normal: Array,
    slide: Array,
    roll: Array,
    drift: Array,
) -> None:
    """Set the first eight entries of the rows of the three internal meshes.

    Args:
        law: data of the meshes.
        angle, speed: of the ring, rad and rad/s.
        place, normal, slide, roll, drift: rows of the meshes (see `mesh.Rows`), shape (meshes, entries).
    """
    rows = (place, normal, slide, roll, drift)
    cos_pitch, sin_pitch = math.cos(law.pitch), math.sin(law.pitch)
    for planet in range(3):
        position = (law.planet_angle[planet] - angle) / law.pitch
        below = math.floor(position)
        s = position - below
        first = int(below) % law.segments
        turned = -s * law.pitch - law.working_angle
        cos, sin = math.cos(turned), math.sin(turned)
        _segment(law, rows, planet, 0, first, 1.0 - s, speed / law.pitch, cos, sin, speed)
        cos, sin = cos * cos_pitch - sin * sin_pitch, sin * cos_pitch + cos * sin_pitch
        second = first + 1 if first + 1 < law.segments else 0
        _segment(law, rows, planet, 4, second, s, -speed / law.pitch, cos, sin, speed)


@kernel
def _segment(
    law: EngagementLaw,
    rows: tuple[Indices, Array, Array, Array, Array],
    mesh: int,
    k: int,
    segment: int,
    weight: float,
    weight_rate: float,
    cos: float,
    sin: float,
    speed: float,
) -> None:
    """Set four entries from k on; cos and sin are those of D - a."""
    place, normal, slide, roll, drift = rows
    for motion in range(4):
        place[mesh, k + motion] = segment + motion * law.segments
    helix = law.cos_helix
    lever = 1.0 - law.radius / law.base_radius * cos
    lever_rate = law.radius / law.base_radius * sin * speed
    normal[mesh, k] = weight * helix * sin
    normal[mesh, k + 1] = weight * helix * cos
    normal[mesh, k + 2] = weight * helix * lever
    normal[mesh, k + 3] = weight * law.sin_helix
    drift[mesh, k] = helix * (weight_rate * sin + weight * speed * cos)
    drift[mesh, k + 1] = helix * (weight_rate * cos - weight * speed * sin)
    drift[mesh, k + 2] = helix * (weight_rate * lever + weight * lever_rate)
    drift[mesh, k + 3] = weight_rate * law.sin_helix
    slide[mesh, k] = weight * cos
    slide[mesh, k + 1] = -weight * sin
    slide[mesh, k + 2] = weight * (math.tan(law.working_angle) + law.radius / law.base_radius * sin)
    roll[mesh, k + 2] = -weight / law.base_radius
