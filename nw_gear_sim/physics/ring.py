"""The flexible ring: rigid segments with elastic joints, in the frame that turns with the ring.

Joint i|i+1 lies on the circle r_c, half a segment from both centroids. With c, s = cos, sin(pi/M):

    D_r = c (w' - w) - s (v' + v) + r_c s (psi' + psi)
    D_t = s (w' + w) + c (v' - v) + r_c (1 - c) (psi' - psi)
    D_psi = psi' - psi,   D_z = z' - z

are zero for every motion of the whole ring as a rigid body. Each joint has a shear, a tangential, a bending and an axial
spring with stiffness-proportional damping; the paper's translational springs alone (Eq 28) leave M mechanisms.
Coriolis and centrifugal terms of the turning frame are left out.
"""

from __future__ import annotations

from typing import Any

import numba

from nw_gear_common.tables import Array


Record = Any
"""A compiled record has no static type."""
_FAST = {"reassoc", "contract", "nsz"}


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST, inline="always")
def _strain(c: Record, a: Array, joint: Array, i: int, k: int) -> None:
    """Forces of the joint between segments i and k = i + 1 from a = q + beta q'."""
    m, cos, sin = c.segments, c.cos_half, c.sin_half
    arm_r, arm_t, angle = c.radius * sin / c.base, c.radius * (1.0 - cos) / c.base, 1.0 / c.base
    w0, w1, v0, v1 = a[i], a[k], a[m + i], a[m + k]
    p0, p1 = a[2 * m + i], a[2 * m + k]
    joint[i] = c.radial * (cos * (w1 - w0) - sin * (v1 + v0) + arm_r * (p1 + p0))
    joint[m + i] = c.tangential * (sin * (w1 + w0) + cos * (v1 - v0) + arm_t * (p1 - p0))
    joint[2 * m + i] = c.rotational * angle * (p1 - p0)
    joint[3 * m + i] = c.axial * (a[3 * m + k] - a[3 * m + i])


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST, inline="always")
def _resist(c: Record, joint: Array, force: Array, h: int, i: int) -> None:
    """Generalised forces on segment i from its joints h = i - 1 and i: minus the transposed strains."""
    m, cos, sin = c.segments, c.cos_half, c.sin_half
    arm_r, arm_t, angle = c.radius * sin / c.base, c.radius * (1.0 - cos) / c.base, 1.0 / c.base
    r0, r1, t0, t1 = joint[h], joint[i], joint[m + h], joint[m + i]
    force[i] = cos * (r1 - r0) - sin * (t1 + t0)
    force[m + i] = sin * (r1 + r0) + cos * (t1 - t0)
    force[2 * m + i] = -arm_r * (r1 + r0) + arm_t * (t1 - t0) + angle * (joint[2 * m + i] - joint[2 * m + h])
    force[3 * m + i] = joint[3 * m + i] - joint[3 * m + h]


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def ring_forces(c: Record, q: Array, rate: Array, work: Array, force: Array) -> None:
    """Set force[:4M] to what joints and supports exert on (w, v, p, z) of every segment.

    Args:
        c: constants.
        q, rate: displacements (m) and their rates (m/s), the ring's entries first.
        work: space for 8 M numbers.
        force: generalised forces (N); the ring's entries are overwritten.
    """
    m = c.segments
    a, joint = work[: 4 * m], work[4 * m : 8 * m]
    for i in range(4 * m):
        a[i] = q[i] + c.damping_time * rate[i]
    for i in range(m - 1):
        _strain(c, a, joint, i, i + 1)
    _strain(c, a, joint, m - 1, 0)
    for i in range(1, m):
        _resist(c, joint, force, i - 1, i)
    _resist(c, joint, force, m - 1, 0)
    for i in range(m):
        force[i] -= c.radial_support * q[i] + c.radial_support_damping * rate[i]
        k = 3 * m + i
        force[k] -= c.axial_support * q[k] + c.axial_support_damping * rate[k]
