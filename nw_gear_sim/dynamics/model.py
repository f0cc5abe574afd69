"""The gearbox: adds the laws up to the acceleration of every motion.

Every mesh is derived from one scalar elongation x_n = h(t)^T q + e, its force F acts on every coordinate as -h F:
action and reaction, balance of moments and symmetric stiffness follow by themselves.

    I    x = cos b [u_r - u_p1 + n.(X_r - X_p1)] + sin b (z_r - z_p1) + e        (the ring blended from two segments)
    II   x = cos b [u_p2 - u_s + n.(X_p2 - X_s)] + sin b (z_p2 - z_s) + e
    III  x = cos b [u_1 - u_2 + n.(X_1 - X_2)] + e
    F = K(t) f(x, b) + C x'
"""

from __future__ import annotations

import math

import numba

from nw_gear_common.tables import Array
from nw_gear_sim.dynamics.bearing import roller_sum
from nw_gear_sim.dynamics.constants import Constants
from nw_gear_sim.dynamics.backlash import backlash
from nw_gear_sim.dynamics.ring import Record, ring_forces

_FAST = {"reassoc", "contract", "nsz"}
MESHES = 7
BEARINGS = 10
X, V, FORCE, BEARING = 0, MESHES, 2 * MESHES, 3 * MESHES
OBSERVED = 3 * MESHES + 3 * BEARINGS
"""Length of the vector of observations: x, x' and F of the meshes, then three force components of each bearing."""


def work_size(segments: int) -> int:
    """Length of the work space of `accelerations`."""
    return 8 * (segments + 1)


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def accelerations(
    c: Constants, tables: Array, q: Array, rate: Array, angle: float, speed: float, torque: float,
    work: Array, observed: Array, result: Array,
) -> None:
    """Accelerations of all motions at one moment.

    Args:
        c: constants.
        tables: friction over the mesh phase, shape (3, 2, phases + 1), see `friction.tables`.
        q, rate: displacements (m) and rates (m/s).
        angle, speed: of the ring, rad and rad/s.
        torque: on the ring, N m.
        work: space (see `work_size`).
        observed: filled with mesh displacements, rates, forces and bearing forces (see OBSERVED).
        result: filled with the accelerations (m/s^2).
    """
    ring_forces(c.ring[0], q, rate, work, result)
    _load_ring(c.ring[0], c.angles, c.gravity, angle, torque, result)
    m = 4 * c.ring[0].segments
    for i in range(len(c.weight)):
        result[m + i] = c.weight[i]
    result[c.output] -= torque * c.output_share
    for i in range(len(c.spring)):
        _spring(c.spring[i], q, rate, result)
    for i in range(3):
        _mesh_ring(c.ring[0], c.mesh[i], tables[0], q, rate, angle, speed, observed[i:], result)
    for i in range(3, MESHES):
        _mesh_wheels(c.mesh[i], tables[1 if i < MESHES - 1 else 2], q, rate, angle, speed, observed[i:], result)
    for i in range(BEARINGS):
        _bearing(c.bearing[i], c.rollers, q, rate, angle, observed[BEARING + 3 * i :], result)
    for i in range(len(result)):
        result[i] *= c.inverse_mass[i]


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _load_ring(r: Record, angles: Array, gravity: Array, angle: float, torque: float, force: Array) -> None:
    """Gravity in the turning frame, and the input torque as equal tangential forces on the segments."""
    m = r.segments
    cos, sin = math.cos(angle), math.sin(angle)
    gx, gy = r.mass * gravity[0], r.mass * gravity[1]
    ax, ay = gx * cos + gy * sin, gy * cos - gx * sin
    drive = torque / (m * r.radius)
    radial, tangential, cosines, sines = force[:m], force[m : 2 * m], angles[0], angles[1]
    for i in range(m):
        radial[i] += ax * cosines[i] + ay * sines[i]
    for i in range(m):
        tangential[i] += ay * cosines[i] - ax * sines[i] + drive


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _spring(s: Record, q: Array, rate: Array, force: Array) -> None:
    tension = s.stiffness * (s.scale_a * q[s.a] - s.scale_b * q[s.b])
    tension += s.damping * (s.scale_a * rate[s.a] - s.scale_b * rate[s.b])
    force[s.a] -= s.scale_a * tension
    force[s.b] += s.scale_b * tension


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _excite(g: Record, table: Array, angle: float) -> tuple[float, float, float, float, float]:
    """Stiffness (N/m), error (m), its derivative by the phase (m/rad), friction integrals g_0 and g_1 (m) of a mesh."""
    phase = g.ratio * angle + g.offset
    cos, sin = math.cos(phase - g.phase), math.sin(phase - g.phase)
    stiffness = g.stiffness * (1.0 + g.variation * cos)
    error = g.error_mean + g.error_amplitude * sin
    turns = phase / (2.0 * math.pi)
    count = table.shape[1] - 1
    place = (turns - math.floor(turns)) * count
    k = min(int(place), count - 1)
    share = place - k
    g0 = table[0, k] + share * (table[0, k + 1] - table[0, k])
    g1 = table[1, k] + share * (table[1, k + 1] - table[1, k])
    return stiffness, error, g.error_amplitude * cos, g0, g1


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _force(g: Record, stiffness: float, x: float, v: float, observed: Array) -> tuple[float, float]:
    """Normal force, and the size of its elastic part, on which friction acts (N)."""
    deflection = backlash(x, g.half_backlash)
    elastic = stiffness * deflection
    force = elastic
    if g.damping_in_gap or deflection != 0.0:
        force += g.damping * v
    observed[X] = x
    observed[V] = v
    observed[FORCE] = force
    return force, abs(elastic)


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _mesh_ring(
    r: Record, g: Record, table: Array, q: Array, rate: Array, angle: float, speed: float, observed: Array, force: Array
) -> None:
    """Stage I: ring and planet; the ring's motion at the contact is blended from the two segments beside it."""
    m = r.segments
    stiffness, error, slope, g0, g1 = _excite(g, table, angle)
    pitch = 2.0 * math.pi / m
    place = (g.planet_angle - angle) / pitch
    whole = math.floor(place)
    share = place - whole
    i0 = int(whole) % m
    i1 = i0 + 1 if i0 + 1 < m else 0
    cb, sb = g.cos_helix, g.sin_helix
    s0, c0 = math.sin(-share * pitch - g.working_angle), math.cos(-share * pitch - g.working_angle)
    s1, c1 = math.sin((1.0 - share) * pitch - g.working_angle), math.cos((1.0 - share) * pitch - g.working_angle)
    p0, p1 = (r.base - r.radius * c0) / r.base, (r.base - r.radius * c1) / r.base
    w0, w1 = 1.0 - share, share
    d, nx, ny = g.driven, g.normal_x, g.normal_y
    a0 = cb * (s0 * q[i0] + c0 * q[m + i0] + p0 * q[2 * m + i0]) + sb * q[3 * m + i0]
    a1 = cb * (s1 * q[i1] + c1 * q[m + i1] + p1 * q[2 * m + i1]) + sb * q[3 * m + i1]
    x = w0 * a0 + w1 * a1 + error - cb * (q[d] + nx * q[d + 1] + ny * q[d + 2]) - sb * q[d + 3]
    v = w0 * (cb * (s0 * rate[i0] + c0 * rate[m + i0] + p0 * rate[2 * m + i0]) + sb * rate[3 * m + i0])
    v += w1 * (cb * (s1 * rate[i1] + c1 * rate[m + i1] + p1 * rate[2 * m + i1]) + sb * rate[3 * m + i1])
    v += slope * g.ratio * speed - cb * (rate[d] + nx * rate[d + 1] + ny * rate[d + 2]) - sb * rate[d + 3]
    lever = r.radius / r.base
    turn = w0 * cb * (c0 * q[i0] - s0 * q[m + i0] + lever * s0 * q[2 * m + i0])
    turn += w1 * cb * (c1 * q[i1] - s1 * q[m + i1] + lever * s1 * q[2 * m + i1])
    v += speed * (turn + (a0 - a1) / pitch)  # the ring turns past the contact: (dh/dt)^T q
    f, pressed = _force(g, stiffness, x, v, observed)
    rub = pressed * g0 * g.friction_sign
    moment = pressed * (g.driver_arm * g0 - g1)
    f0, f1 = w0 * f, w1 * f
    force[i0] += w0 * rub * c0 - cb * s0 * f0
    force[i1] += w1 * rub * c1 - cb * s1 * f1
    force[m + i0] += -w0 * rub * s0 - cb * c0 * f0
    force[m + i1] += -w1 * rub * s1 - cb * c1 * f1
    force[2 * m + i0] += w0 * (moment + rub * r.radius * s0) / r.base - cb * p0 * f0
    force[2 * m + i1] += w1 * (moment + rub * r.radius * s1) / r.base - cb * p1 * f1
    force[3 * m + i0] -= sb * f0
    force[3 * m + i1] -= sb * f1
    force[d] += cb * f - pressed * (g.driven_arm * g0 - g1) / g.driven_base
    force[d + 1] += cb * nx * f - ny * rub
    force[d + 2] += cb * ny * f + nx * rub
    force[d + 3] += sb * f


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _mesh_wheels(
    g: Record, table: Array, q: Array, rate: Array, angle: float, speed: float, observed: Array, force: Array
) -> None:
    """Stages II and III: two external gears."""
    stiffness, error, slope, g0, g1 = _excite(g, table, angle)
    a, b, cb, sb, nx, ny = g.driver, g.driven, g.cos_helix, g.sin_helix, g.normal_x, g.normal_y
    x = cb * (q[a] - q[b] + nx * (q[a + 1] - q[b + 1]) + ny * (q[a + 2] - q[b + 2])) + error
    v = cb * (rate[a] - rate[b] + nx * (rate[a + 1] - rate[b + 1]) + ny * (rate[a + 2] - rate[b + 2]))
    v += slope * g.ratio * speed
    if g.axial:
        x += sb * (q[a + 3] - q[b + 3])
        v += sb * (rate[a + 3] - rate[b + 3])
    f, pressed = _force(g, stiffness, x, v, observed)
    rub = pressed * g0 * g.friction_sign
    force[a] += pressed * (g.driver_arm * g0 + g1) / g.driver_base - cb * f
    force[b] += cb * f - pressed * (g.driven_arm * g0 - g1) / g.driven_base
    force[a + 1] += ny * rub - cb * nx * f
    force[a + 2] -= nx * rub + cb * ny * f
    force[b + 1] += cb * nx * f - ny * rub
    force[b + 2] += cb * ny * f + nx * rub
    if g.axial:
        force[a + 3] -= sb * f
        force[b + 3] += sb * f


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _bearing(b: Record, rollers: Array, q: Array, rate: Array, angle: float, observed: Array, force: Array) -> None:
    d, cg, sg = b.first, b.cos_contact, b.sin_contact
    cos, sin = math.cos(b.cage * angle), math.sin(b.cage * angle)
    x, y = cg * (q[d] * cos + q[d + 1] * sin), cg * (q[d + 1] * cos - q[d] * sin)
    z = q[d + 2] if b.axes == 3 else 0.0
    k, n = b.kind, b.rollers
    fx, fy, fz = roller_sum(
        x, y, z * sg - b.clearance, rollers[0, k, :n], rollers[1, k, :n], rollers[2, k, :n], b.exponent
    )
    observed[0] = b.load * cg * (fx * cos - fy * sin)
    observed[1] = b.load * cg * (fy * cos + fx * sin)
    observed[2] = b.load * sg * fz
    for j in range(b.axes):
        force[d + j] -= observed[j] + b.damping * rate[d + j]
