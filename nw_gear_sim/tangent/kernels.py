"""The equations of motion with the ring in modes, and beside them their tangent along the trajectory.

A deviation (dx, dv) follows the variational equations, whose right-hand side is the derivative of the forces:

    roller i of a bearing   dF = K n delta_i^(n-1) d_i (d_i . dx),   d_i its direction in x, y, z
    mesh, row h             dF = -h (K s^2 dX + C dX') + (slide g + roll g_1) s K s^2 dX,
                            dX = h . dx,  dX' = h . dv + h' . dx,  s = 1, -1 on the front and back flanks, 0 between

Both go through the same stages of the exponential Runge-Kutta method, so that the deviations are those of the map of a
step itself. Where mesh damping acts only while flanks touch, the force jumps by C X' as they meet or part; there a
deviation gets the impulse -h C dX or +h C dX (saltation matrix, Mueller, Chaos Solitons Fractals 5 (1995) 1671).

Columns of dx and dv are deviations, for the SIMD lanes. All kernels are in one file, since numba notices changes there
alone. Every mode is kept, so that nothing is in series with the meshes; races have no defects.
"""

from __future__ import annotations

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import apart, fused, kernel, summing
from nw_gear_sim.integrator import etdrk4, rk4
from nw_gear_sim.modal.forces import ModalInstants, ModalWork, accelerate, set_modal_instant, start_wheels, turn_wheels
from nw_gear_sim.modal.laws import ModalLaws
from nw_gear_sim.modal.stepping import lost
from nw_gear_sim.model import Interval
from nw_gear_sim.physics.spring import SpringLaw
from nw_gear_sim.tangent.slope import MESHES, PLANETS, UNKNOWN, Slope

GEAR = 8
"""Where the entries of the gear begin in the row of a mesh of the ring."""


@fused
def set_slope(laws: ModalLaws, instants: ModalInstants, slot: int, x: Array, slope: Slope) -> None:
    """Set what does not depend on the deviation: stiffness of the bearings at displacements x (m), rows of the ring."""
    law = laws.bearings
    exponent = law.marks.exponent
    for b in range(len(slope.bearing)):
        stiffness = slope.bearing[b]
        stiffness[:] = 0.0
        cos, sin = instants.cage[slot, b, 0], instants.cage[slot, b, 1]
        radial, axial = law.radial[b], law.axial[b]
        offset = axial * x[max(law.place[b, 2], 0)] - law.clearance[b]
        for i in range(law.start[b], law.start[b + 1]):
            c = radial * (cos * law.cos[i] - sin * law.sin[i])
            s = radial * (sin * law.cos[i] + cos * law.sin[i])
            approach = c * x[law.place[b, 0]] + s * x[law.place[b, 1]]
            _add_roller(stiffness, law.stiffness[b], exponent, approach + offset, c, s, axial)
            if law.paired[b]:
                _add_roller(stiffness, law.stiffness[b], exponent, offset - approach, -c, -s, axial)
    for j in range(PLANETS):
        knot, share = instants.knot[slot, j], instants.share[slot, j]
        sliding, rolling = instants.excitation[slot, j, 3], instants.excitation[slot, j, 4]
        normal, slide, roll = laws.table.normal, laws.table.slide, laws.table.roll
        for i in range(slope.row.shape[2]):
            step = normal[knot + 1, i] - normal[knot, i]
            slope.row[j, 0, i] = normal[knot, i] + share * step
            friction = sliding * (slide[knot, i] + share * (slide[knot + 1, i] - slide[knot, i]))
            friction += rolling * (roll[knot, i] + share * (roll[knot + 1, i] - roll[knot, i]))
            slope.row[j, 1, i] = friction
            slope.row[j, 2, i] = step * instants.drift[slot]


@kernel
def _add_roller(
    stiffness: Array, constant: float, exponent: float, reached: float, c: float, s: float, axial: float
) -> None:
    if reached <= 0.0:
        return
    k = constant * exponent * reached ** (exponent - 1.0)
    d = (c, s, axial)
    for i in range(3):
        for j in range(3):
            stiffness[i, j] += k * d[i] * d[j]


@apart
def _add(factor: float, source: Array, target: Array) -> None:
    for c in range(len(target)):
        target[c] += factor * source[c]


@fused
def push(
    laws: ModalLaws,
    instants: ModalInstants,
    slot: int,
    elastic: Array,
    slope: Slope,
    dx: Array,
    dv: Array,
    out: Array,
) -> None:
    """Set the forces per mass on deviations, without each oscillator's own; `set_slope` comes first.

    Args:
        laws, instants, slot: of the gearbox.
        elastic: forces of the meshes at the state, N, (7,): their signs count.
        slope: of the forces there.
        dx, dv: deviations of displacement and velocity, (n, k).
        out: set here, (n, k).
    """
    modes, law = len(laws.turn), laws.bearings
    out[:] = 0.0
    for k in range(len(laws.first)):
        _add(-laws.coupling[k], dv[laws.second[k]], out[laws.first[k]])
    _push_springs(laws.springs, dx, dv, out)
    for b in range(len(slope.bearing)):
        for i in range(3):
            for j in range(3):
                if law.place[b, i] >= 0 and law.place[b, j] >= 0:
                    _add(-slope.bearing[b, i, j], dx[law.place[b, j]], out[law.place[b, i]])
    for mesh in range(MESHES):
        _push_mesh(laws, instants.excitation[slot, mesh], mesh, elastic[mesh], slope, dx, dv, out)
    for i in range(modes, len(out)):
        for c in range(out.shape[1]):
            out[i, c] *= laws.inverse_mass[i]


@fused
def _push_springs(springs: SpringLaw, dx: Array, dv: Array, out: Array) -> None:
    for k in range(len(springs.first)):
        i, j, beta = springs.first[k], springs.second[k], springs.damping_time[k]
        aa, ab, bb = springs.aa[k], springs.ab[k], springs.bb[k]
        for target, source, factor in ((i, i, -aa), (i, j, ab), (j, i, ab), (j, j, -bb)):
            _add(factor, dx[source], out[target])
            _add(factor * beta, dv[source], out[target])


@fused
def _elongate(laws: ModalLaws, mesh: int, slope: Slope, dx: Array, dv: Array) -> None:
    """Set `reach` to the deviations of a mesh's elongation and of its rate."""
    place, normal = laws.rows.place[mesh], laws.rows.normal[mesh]
    slope.reach[:] = 0.0
    if mesh < PLANETS:
        row = slope.row[mesh]
        for i in range(row.shape[1]):
            _add(row[0, i], dx[i], slope.reach[0])
            _add(row[0, i], dv[i], slope.reach[1])
            _add(row[2, i], dx[i], slope.reach[1])
    for k in range(GEAR if mesh < PLANETS else 0, laws.mesh.entries[mesh]):
        _add(normal[k], dx[place[k]], slope.reach[0])
        _add(normal[k], dv[place[k]], slope.reach[1])


@fused
def _push_mesh(
    laws: ModalLaws, excitation: Array, mesh: int, elastic: float, slope: Slope, dx: Array, dv: Array, out: Array
) -> None:
    touching = elastic != 0.0
    damping = laws.mesh.damping[mesh] if touching or laws.mesh.damping_in_gap else 0.0
    if not touching and damping == 0.0:
        return
    _elongate(laws, mesh, slope, dx, dv)
    stiffness = excitation[0] if touching else 0.0
    side = 1.0 if elastic > 0.0 else -1.0
    springy, total = slope.reach
    for c in range(len(total)):
        force = stiffness * springy[c]
        total[c] = force + damping * total[c]
        springy[c] = side * force
    if mesh < PLANETS:
        row = slope.row[mesh]
        for i in range(row.shape[1]):
            _add(-row[0, i], total, out[i])
            _add(row[1, i], springy, out[i])
    rows = laws.rows
    for k in range(GEAR if mesh < PLANETS else 0, laws.mesh.entries[mesh]):
        target = out[rows.place[mesh, k]]
        _add(-rows.normal[mesh, k], total, target)
        _add(rows.slide[mesh, k] * excitation[3] + rows.roll[mesh, k] * excitation[4], springy, target)


@fused
def meet(laws: ModalLaws, elastic: Array, slope: Slope, dx: Array, dv: Array) -> None:
    """Give the deviations the impulses of flanks that met or parted since the last step began."""
    for mesh in range(MESHES):
        carries = 1.0 if elastic[mesh] != 0.0 else 0.0
        before, slope.carrying[mesh] = slope.carrying[mesh], carries
        if laws.mesh.damping_in_gap or before in (UNKNOWN, carries):
            continue
        _elongate(laws, mesh, slope, dx, dv)
        impulse = laws.mesh.damping[mesh] * (before - carries)
        if mesh < PLANETS:
            for i in range(slope.row.shape[2]):
                _add(impulse * slope.row[mesh, 0, i], slope.reach[0], dv[i])
        for k in range(GEAR if mesh < PLANETS else 0, laws.mesh.entries[mesh]):
            i = laws.rows.place[mesh, k]
            _add(impulse * laws.rows.normal[mesh, k] * laws.inverse_mass[i], slope.reach[0], dv[i])


@fused
def divergence(laws: ModalLaws, elastic: Array, slope: Slope) -> float:
    """Return the trace of the derivative of (x', v') by (x, v), 1/s: what damping takes away."""
    total = 0.0
    for i in range(len(laws.damping)):
        total -= laws.damping[i]
    springs, inverse = laws.springs, laws.inverse_mass
    for k in range(len(springs.first)):
        i, j, beta = springs.first[k], springs.second[k], springs.damping_time[k]
        total -= beta * (springs.aa[k] * inverse[i] + springs.bb[k] * inverse[j])
    for mesh in range(MESHES):
        if elastic[mesh] == 0.0 and not laws.mesh.damping_in_gap:
            continue
        square = 0.0
        if mesh < PLANETS:
            for i in range(slope.row.shape[2]):
                square += slope.row[mesh, 0, i] ** 2
        for k in range(GEAR if mesh < PLANETS else 0, laws.mesh.entries[mesh]):
            square += laws.rows.normal[mesh, k] ** 2 * inverse[laws.rows.place[mesh, k]]
        total -= laws.mesh.damping[mesh] * square
    return total


@kernel
def _set_instant(
    laws: ModalLaws, table: Array, interval: Interval, elapsed: float, instants: ModalInstants, slot: int
) -> None:
    set_modal_instant(laws, table, table, interval, elapsed, instants, slot)


@summing
def _evaluate(
    laws: ModalLaws, instants: ModalInstants, slot: int, x: Array, v: Array, work: ModalWork, slope: Slope, out: Array
) -> None:
    """Set the forces per mass and their derivative."""
    accelerate(laws, instants, slot, x, v, work, out)
    set_slope(laws, instants, slot, x, slope)


@summing
def advance(
    laws: ModalLaws,
    oscillators: tuple[etdrk4.Coefficients, etdrk4.Coefficients],
    table: Array,
    interval: Interval,
    steps: int,
    limit: float,
    x: Array,
    v: Array,
    instants: ModalInstants,
    work: ModalWork,
    slope: Slope,
) -> int:
    """Integrate state and deviations over an interval of constant speed.

    Args:
        laws: of the gearbox; oscillators: of the integrator for this step, and those `repeated` for the deviations.
        table: of friction; interval: the drive; steps: in it; limit: of a displacement, m.
        x, v: the state, changed in place, (n,).
        instants, work, slope: memory; the deviations are in `slope.here`.

    Returns:
        steps done: all, or fewer where a displacement left +-limit or stopped being a number.
    """
    h = interval.duration / steps
    here, stages = slope.here_flat, slope.stage_flat
    start_wheels(laws.wheel_ratio, interval, 0.5 * h, instants.wheel)
    now, middle, then = 0, 1, 2
    for step in range(steps):
        for half in range(0 if step == 0 else 1, 3):
            slot = now if half == 0 else (middle if half == 1 else then)
            if half > 0:
                turn_wheels(instants.wheel)
            _set_instant(laws, table, interval, (step + 0.5 * half) * h, instants, slot)
        rk4.first(x, v, work.x, work.v)
        for stage in range(4):
            slot = now if stage == 0 else (then if stage == 3 else middle)
            _evaluate(laws, instants, slot, work.x, work.v, work, slope, work.slopes[stage])
            if stage == 0:
                meet(laws, work.contact.elastic, slope, slope.here[0], slope.here[1])
                slope.divergence[0] += divergence(laws, work.contact.elastic, slope)
                rk4.first(here[0], here[1], stages[0], stages[1])
            push(laws, instants, slot, work.contact.elastic, slope, slope.stage[0], slope.stage[1], slope.push[stage])
            etdrk4.proceed(stage, oscillators[0], work.slopes, x, v, work.x, work.v)
            etdrk4.proceed(stage, oscillators[1], slope.push_flat, here[0], here[1], stages[0], stages[1])
        now, then = then, now
        if lost(laws.reach, x, limit) >= 0:
            return step + 1
    return steps


@kernel
def derivative(
    laws: ModalLaws,
    table: Array,
    interval: Interval,
    x: Array,
    v: Array,
    instants: ModalInstants,
    work: ModalWork,
    slope: Slope,
) -> None:
    """Set the forces per mass and those on the deviations `slope.here` at the start of an interval, in stage 0."""
    start_wheels(laws.wheel_ratio, interval, 0.0, instants.wheel)
    _set_instant(laws, table, interval, 0.0, instants, 0)
    _evaluate(laws, instants, 0, x, v, work, slope, work.slopes[0])
    push(laws, instants, 0, work.contact.elastic, slope, slope.here[0], slope.here[1], slope.push[0])
    slope.divergence[0] = divergence(laws, work.contact.elastic, slope)
