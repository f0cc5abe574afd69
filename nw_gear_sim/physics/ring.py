"""The flexible ring: M rigid segments with elastic joints on the circle r_c, on radial and axial supports.

In the co-rotating polar frame of the segments (w radial, v tangential, p = psi r_b, z axial) the joint between
segment i and i + 1 is elongated, with c, s = cos, sin (pi / M), by

    D_r = c (w' - w) - s (v' + v) + r_c s (psi' + psi)            shear, k_s
    D_t = s (w' + w) + c (v' - v) + r_c (1 - c) (psi' - psi)      extension, k_t
    D_psi = psi' - psi                                            bending, k_theta
    D_z = z' - z                                                  axial shear, k_z

A consistent form of the paper's Eqs 28, 37, 38, whose printed joints carry a prestress and no bending; rigid motions
elongate nothing. Coriolis and centrifugal forces of the rotating frame are left out.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import fused


class RingLaw(NamedTuple):
    """Coefficients of the ring's forces.

    Attributes:
        own: joint forces on (w, v, p) of a segment by its own motion, (3, 3), N/m; w is coupled to nothing else.
        next: the same by the motion of segment i + 1; its transpose goes with segment i - 1.
        axial: k_z, N/m; damping_time: of the joints, s.
        radial_support, axial_support: N/m; radial_damping, axial_damping: N s/m.
        weight: of a segment, N; cos, sin: of the segments' angles 2 pi i / M relative to the direction of gravity.
        lever: 1 / (M r_c), tangential force on a segment over input torque.
    """

    own: Array
    next: Array
    axial: float
    damping_time: float
    radial_support: float
    axial_support: float
    radial_damping: float
    axial_damping: float
    weight: float
    cos: Array
    sin: Array
    lever: float


def joint_rows(segments: int, radius: float, base_radius: float) -> tuple[Array, Array]:
    """Elongations (D_r, D_t, D_psi) of a joint by (w, v, p) of segment i and by those of i + 1: two (3, 3) arrays."""
    c, s = math.cos(math.pi / segments), math.sin(math.pi / segments)
    k = radius / base_radius
    here = np.array([[-c, -s, k * s], [s, -c, -k * (1 - c)], [0, 0, -1 / base_radius]])
    beyond = np.array([[c, -s, k * s], [s, c, k * (1 - c)], [0, 0, 1 / base_radius]])
    return here, beyond


def ring_law(
    *,
    segments: int,
    radius: float,
    base_radius: float,
    joint: tuple[float, float, float, float],
    damping_time: float,
    support: tuple[float, float],
    support_damping: tuple[float, float],
    weight: float,
    gravity_direction: float,
) -> RingLaw:
    """Prepare the ring's coefficients.

    Args:
        segments: M; radius: r_c of the centroids (m); base_radius: of the ring's teeth (m).
        joint: stiffness k_s, k_t (N/m), k_theta (N m/rad), k_z (N/m).
        damping_time: damping of a joint over its stiffness (s).
        support: radial and axial, of one segment (N/m); support_damping: the same (N s/m).
        weight: of one segment (N); gravity_direction: from the x axis (rad).
    """
    here, beyond = joint_rows(segments, radius, base_radius)
    stiffness = np.diag(joint[:3])
    own = here.T @ stiffness @ here + beyond.T @ stiffness @ beyond
    angles = 2 * math.pi / segments * np.arange(segments) - gravity_direction
    return RingLaw(
        own=own,
        next=np.ascontiguousarray(here.T @ stiffness @ beyond),
        axial=joint[3],
        damping_time=damping_time,
        radial_support=support[0],
        axial_support=support[1],
        radial_damping=support_damping[0],
        axial_damping=support_damping[1],
        weight=weight,
        cos=np.cos(angles),
        sin=np.sin(angles),
        lever=1 / (segments * radius),
    )


@fused
def ring_forces(law: RingLaw, turn: Array, torque: float, q: Array, v: Array, padded: Array, force: Array) -> None:
    """Set the forces on all segments from joints, supports, weight and input torque.

    Args:
        law: coefficients.
        turn: cosine and sine of the ring's angle, shape (2,).
        torque: input torque, N m, spread over the segments as tangential forces.
        q, v: displacements (m) and velocities (m/s); their first 4 M entries are the ring's.
        padded: scratch of shape (4, M + 2).
        force: its first 4 M entries are set (N).
    """
    n = len(law.cos)
    beta = law.damping_time
    for part in range(4):
        row = padded[part]
        first = part * n
        for i in range(n):
            row[i + 1] = q[first + i] + beta * v[first + i]
        row[0] = row[n]
        row[n + 1] = row[1]
    _in_plane(law, law.weight * turn[0], law.weight * turn[1], torque * law.lever, q, v, padded, force)
    z = padded[3]
    k_z, support, damping = law.axial, law.axial_support, law.axial_damping
    axial_force = force[3 * n : 4 * n]
    z_q, z_v = q[3 * n : 4 * n], v[3 * n : 4 * n]
    for i in range(n):
        axial_force[i] = k_z * (z[i] + z[i + 2] - 2.0 * z[i + 1]) - support * z_q[i] - damping * z_v[i]


@fused
def _in_plane(
    law: RingLaw, weight_cos: float, weight_sin: float, push: float, q: Array, v: Array, padded: Array, force: Array
) -> None:
    cos, sin = law.cos, law.sin
    n = len(cos)
    w, t, p = padded[0], padded[1], padded[2]
    force_w, force_t, force_p = force[:n], force[n : 2 * n], force[2 * n : 3 * n]
    w_q, w_v = q[:n], v[:n]
    own_w, own_t, own_p, own_tp = law.own[0, 0], law.own[1, 1], law.own[2, 2], law.own[1, 2]
    a, b, c = law.next[0, 0], law.next[0, 1], law.next[0, 2]
    d, e, f = law.next[1, 0], law.next[1, 1], law.next[1, 2]
    g, h, k = law.next[2, 0], law.next[2, 1], law.next[2, 2]
    support, damping = law.radial_support, law.radial_damping
    for i in range(n):
        w0, w1, w2 = w[i], w[i + 1], w[i + 2]
        t0, t1, t2 = t[i], t[i + 1], t[i + 2]
        p0, p1, p2 = p[i], p[i + 1], p[i + 2]
        weight_w = weight_cos * cos[i] - weight_sin * sin[i]
        weight_t = -weight_sin * cos[i] - weight_cos * sin[i]
        joint_w = own_w * w1 + a * w2 + b * t2 + c * p2 + a * w0 + d * t0 + g * p0
        joint_t = own_t * t1 + own_tp * p1 + d * w2 + e * t2 + f * p2 + b * w0 + e * t0 + h * p0
        joint_p = own_p * p1 + own_tp * t1 + g * w2 + h * t2 + k * p2 + c * w0 + f * t0 + k * p0
        force_w[i] = weight_w - joint_w - support * w_q[i] - damping * w_v[i]
        force_t[i] = weight_t - joint_t + push
        force_p[i] = -joint_p
