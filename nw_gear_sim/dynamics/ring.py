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




@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def ring_forces(c: Record, q: Array, rate: Array, work: Array, force: Array) -> None:
    """Set force[:4M] to what joints and supports exert on (w, v, p, z) of every segment.

    Each loop writes one row, reads views that start where it needs them and uses local copies of the record's numbers:
    only so does the compiler vectorise it.

    Args:
        c: record of constants (see `constants.RING`).
        q, rate: displacements (m) and their rates (m/s), the ring's entries first.
        work: space for 8 (M + 1) numbers.
        force: generalised forces (N); the ring's entries are overwritten.
    """
    m, beta = c.segments, c.damping_time
    moved = work[: 4 * (m + 1)].reshape(4, m + 1)  # q + beta q', segment 0 repeated at the end
    joint = work[4 * (m + 1) : 8 * (m + 1)].reshape(4, m + 1)  # joint i-1|i at i, the closing one at both ends
    for k in range(4):
        row, displacement, velocity = moved[k], q[k * m : (k + 1) * m], rate[k * m : (k + 1) * m]
        for i in range(m):
            row[i] = displacement[i] + beta * velocity[i]
        row[m] = row[0]
    _joints(c, moved, joint)
    for k in range(4):
        joint[k, 0] = joint[k, m]
    _balance(c, joint, force)
    _support(c.radial_support, c.radial_support_damping, q[:m], rate[:m], force[:m])
    axial = slice(3 * m, 4 * m)
    _support(c.axial_support, c.axial_support_damping, q[axial], rate[axial], force[axial])


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _support(stiffness: float, damping: float, q: Array, rate: Array, force: Array) -> None:
    for i in range(len(q)):
        force[i] -= stiffness * q[i] + damping * rate[i]


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _joints(c: Record, moved: Array, joint: Array) -> None:
    """Forces of the joints: stiffness times strain of q + beta q'."""
    m, cos, sin = c.segments, c.cos_half, c.sin_half
    arm_r, arm_t, angle = c.radius * sin / c.base, c.radius * (1.0 - cos) / c.base, c.rotational / c.base
    k_r, k_t, k_z = c.radial, c.tangential, c.axial
    w0, v0, p0, z0 = moved[0], moved[1], moved[2], moved[3]
    w1, v1, p1, z1 = moved[0, 1:], moved[1, 1:], moved[2, 1:], moved[3, 1:]
    shear, tension, bending, axial = joint[0, 1:], joint[1, 1:], joint[2, 1:], joint[3, 1:]
    for i in range(m):
        shear[i] = k_r * (cos * (w1[i] - w0[i]) - sin * (v1[i] + v0[i]) + arm_r * (p1[i] + p0[i]))
    for i in range(m):
        tension[i] = k_t * (sin * (w1[i] + w0[i]) + cos * (v1[i] - v0[i]) + arm_t * (p1[i] - p0[i]))
    for i in range(m):
        bending[i] = angle * (p1[i] - p0[i])
    for i in range(m):
        axial[i] = k_z * (z1[i] - z0[i])


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _balance(c: Record, joint: Array, force: Array) -> None:
    """Forces on the segments: minus the transposed strains of the joints before and behind each."""
    m, cos, sin = c.segments, c.cos_half, c.sin_half
    arm_r, arm_t, angle = c.radius * sin / c.base, c.radius * (1.0 - cos) / c.base, 1.0 / c.base
    r0, t0, b0, z0 = joint[0], joint[1], joint[2], joint[3]
    r1, t1, b1, z1 = joint[0, 1:], joint[1, 1:], joint[2, 1:], joint[3, 1:]
    w, v, p, z = force[:m], force[m : 2 * m], force[2 * m : 3 * m], force[3 * m : 4 * m]
    for i in range(m):
        w[i] = cos * (r1[i] - r0[i]) - sin * (t1[i] + t0[i])
    for i in range(m):
        v[i] = sin * (r1[i] + r0[i]) + cos * (t1[i] - t0[i])
    for i in range(m):
        p[i] = arm_t * (t1[i] - t0[i]) - arm_r * (r1[i] + r0[i]) + angle * (b1[i] - b0[i])
    for i in range(m):
        z[i] = z1[i] - z0[i]
