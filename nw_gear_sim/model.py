"""The right-hand side: adds up the forces of all laws, at a time, and steps through it.

Everything that depends on time alone (stiffness, errors, friction shares, engaged segments, cages) is evaluated once
per time and kept in one of three slots of `Instants`; a Runge-Kutta step needs two new ones for four evaluations.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import inlined, kernel
from nw_gear_sim.integrator import rk4
from nw_gear_sim.physics.bearing import BearingLaw, add_bearings, bearing_forces
from nw_gear_sim.physics.engagement import EngagementLaw, engage
from nw_gear_sim.physics.friction import FrictionLaw, look_up
from nw_gear_sim.physics.mesh import Contact, Indices, MeshLaw, Rows, add_meshes, empty_rows, excite
from nw_gear_sim.physics.ring import RingLaw, ring_forces
from nw_gear_sim.physics.spring import SpringLaw, add_springs

SLOTS = 3


class Laws(NamedTuple):
    """All constants of a gearbox.

    Attributes:
        ring, springs, bearings, mesh, engagement, friction: of the laws.
        rows: of the meshes; their moving entries are set for each time.
        weight: constant forces on the motions, N, shape (dof,); the ring's own are left to its law.
        inverse_mass: 1/kg, shape (dof,).
        phase_ratio: phase of each stage over the ring's angle, shape (3,).
        output: entry of the output gear's u; output_push: force on it over the input torque, 1/m.
        probes: entries of u of the gears whose rotation is recorded.
    """

    ring: RingLaw
    springs: SpringLaw
    bearings: BearingLaw
    mesh: MeshLaw
    engagement: EngagementLaw
    friction: FrictionLaw
    rows: Rows
    weight: Array
    inverse_mass: Array
    phase_ratio: Array
    output: int
    output_push: float
    probes: Indices


class Instants(NamedTuple):
    """What depends on time alone, in slots: arrays whose first axis is the slot.

    Attributes:
        turn: cosine and sine of the ring's angle; cage: of the cages' angles, (slot, bearings, 2).
        excitation: K, e, e', g, g_1 of the meshes, (slot, 7, 5); torque: input torque, N m.
        rows: of the meshes, one for each slot.
    """

    turn: Array
    cage: Array
    excitation: Array
    torque: Array
    rows: tuple[Rows, Rows, Rows]


class Work(NamedTuple):
    """Scratch memory, and what the last evaluation found.

    Attributes:
        padded: motions of the ring with neighbours at both ends; load: of the rollers.
        housing: forces on the bearings' housings, N, (bearings, 3); contact: of the meshes.
        slopes, q, v: of the stages of a step.
    """

    padded: Array
    load: Array
    housing: Array
    contact: Contact
    slopes: Array
    q: Array
    v: Array


class Interval(NamedTuple):
    """Drive of an interval of `duration` s, linear in between; `angle` of the ring at its start (rad)."""

    angle: float
    speed_start: float
    speed_end: float
    torque_start: float
    torque_end: float
    duration: float


class Course(NamedTuple):
    """What happened in the steps: arrays of shape (samples, ...) and counts of the steps, (7,).

    Attributes:
        x, rate, force: of the meshes; housing: (samples, bearings, 3).
        twist, twist_rate: of the ring's mean (rad) and of the probes (m), and their rates, (samples, 1 + probes).
        open, back: steps in which a mesh carried nothing, or carried on its back flanks.
    """

    x: Array
    rate: Array
    force: Array
    housing: Array
    twist: Array
    twist_rate: Array
    open: Array
    back: Array


def new_instants(laws: Laws) -> Instants:
    """Return empty slots for a gearbox."""
    bearings = len(laws.bearings.stiffness)

    def rows() -> Rows:
        copy = empty_rows()
        for target, source in zip(copy, laws.rows, strict=True):
            target[:] = source
        return copy

    return Instants(
        turn=np.zeros((SLOTS, 2)),
        cage=np.zeros((SLOTS, bearings, 2)),
        excitation=np.zeros((SLOTS, 7, 5)),
        torque=np.zeros(SLOTS),
        rows=(rows(), rows(), rows()),
    )


def new_work(laws: Laws) -> Work:
    """Return scratch memory for a gearbox."""
    dof = len(laws.weight)
    return Work(
        padded=np.zeros((4, len(laws.ring.cos) + 2)),
        load=np.zeros(len(laws.bearings.cos)),
        housing=np.zeros((len(laws.bearings.stiffness), 3)),
        contact=Contact(np.zeros(7), np.zeros(7), np.zeros(7), np.zeros(7)),
        slopes=np.zeros((4, dof)),
        q=np.zeros(dof),
        v=np.zeros(dof),
    )


def new_course(laws: Laws, samples: int) -> Course:
    """Return memory for the samples of an interval."""
    bearings, probes = len(laws.bearings.stiffness), 1 + len(laws.probes)
    return Course(
        x=np.zeros((samples, 7)),
        rate=np.zeros((samples, 7)),
        force=np.zeros((samples, 7)),
        housing=np.zeros((samples, bearings, 3)),
        twist=np.zeros((samples, probes)),
        twist_rate=np.zeros((samples, probes)),
        open=np.zeros(7),
        back=np.zeros(7),
    )


@inlined
def set_instant(
    laws: Laws, start: Array, end: Array, interval: Interval, elapsed: float, instants: Instants, slot: int
) -> None:
    """Evaluate everything that depends on time alone.

    Args:
        laws: of the gearbox.
        start, end: friction tables at the interval's ends.
        interval: its drive; elapsed: time since its start, s.
        instants: its slot `slot` is set.
    """
    share = elapsed / interval.duration
    change = interval.speed_end - interval.speed_start
    speed = interval.speed_start + change * share
    angle = interval.angle + (interval.speed_start + 0.5 * change * share) * elapsed
    instants.torque[slot] = interval.torque_start + (interval.torque_end - interval.torque_start) * share
    instants.turn[slot, 0], instants.turn[slot, 1] = math.cos(angle), math.sin(angle)
    cage_ratio = laws.bearings.cage_ratio
    for b in range(len(cage_ratio)):
        if b > 0 and cage_ratio[b] == cage_ratio[b - 1]:
            instants.cage[slot, b, 0] = instants.cage[slot, b - 1, 0]
            instants.cage[slot, b, 1] = instants.cage[slot, b - 1, 1]
        else:
            turned = cage_ratio[b] * angle
            instants.cage[slot, b, 0], instants.cage[slot, b, 1] = math.cos(turned), math.sin(turned)
    rows = instants.rows[slot]
    engage(laws.engagement, angle, speed, rows.place, rows.normal, rows.slide, rows.roll, rows.drift)
    _set_excitation(laws, start, end, share, angle, speed, instants.excitation[slot])


@inlined
def _set_excitation(
    laws: Laws, start: Array, end: Array, share: float, angle: float, speed: float, excitation: Array
) -> None:
    mesh = laws.mesh
    last = -1
    phase, rate, cos, sin = 0.0, 0.0, 0.0, 0.0
    for m in range(7):
        stage = mesh.stage[m]
        if stage != last:
            phase, rate = laws.phase_ratio[stage] * angle, laws.phase_ratio[stage] * speed
            cos, sin = math.cos(phase), math.sin(phase)
            last = stage
        excitation[m, 0], excitation[m, 1], excitation[m, 2] = excite(mesh, m, cos, sin, rate)
        shares = look_up(start, end, share, stage, phase + mesh.phase_offset[m])
        excitation[m, 3], excitation[m, 4] = shares


@inlined
def accelerate(laws: Laws, instants: Instants, slot: int, q: Array, v: Array, work: Work, out: Array) -> None:
    """Set the accelerations (m/s^2) at displacements q (m) and velocities v (m/s), all of shape (dof,)."""
    add_forces(laws, instants, slot, q, v, work, out)
    for i in range(len(out)):
        out[i] *= laws.inverse_mass[i]


@inlined
def add_forces(laws: Laws, instants: Instants, slot: int, q: Array, v: Array, work: Work, out: Array) -> None:
    """Set the generalised forces (N) on all motions."""
    torque = instants.torque[slot]
    ring_forces(laws.ring, instants.turn[slot], torque, q, v, work.padded, out)
    for i in range(4 * len(laws.ring.cos), len(out)):
        out[i] = laws.weight[i]
    out[laws.output] += laws.output_push * torque
    add_springs(laws.springs, q, v, out)
    bearing_forces(laws.bearings, instants.cage[slot], q, work.load, work.housing)
    add_bearings(laws.bearings, work.housing, v, out)
    add_meshes(laws.mesh, instants.rows[slot], instants.excitation[slot], q, v, work.contact, out)


@kernel
def advance(
    laws: Laws,
    start: Array,
    end: Array,
    interval: Interval,
    steps_per_sample: int,
    limit: float,
    q: Array,
    v: Array,
    instants: Instants,
    work: Work,
    course: Course,
) -> int:
    """Integrate over the interval and record; the state before a step is its sample.

    Returns:
        steps done: all, or fewer where a displacement left +-limit (m) or stopped being a number.
    """
    steps = len(course.x) * steps_per_sample
    h = interval.duration / steps
    now, middle, then = 0, 1, 2
    a1, a2, a3, a4 = work.slopes[0], work.slopes[1], work.slopes[2], work.slopes[3]
    set_instant(laws, start, end, interval, 0.0, instants, now)
    for step in range(steps):
        set_instant(laws, start, end, interval, (step + 0.5) * h, instants, middle)
        set_instant(laws, start, end, interval, (step + 1) * h, instants, then)
        accelerate(laws, instants, now, q, v, work, a1)
        _record(laws, step, steps_per_sample, q, v, work, course)
        rk4.second(h, q, v, a1, work.q, work.v)
        accelerate(laws, instants, middle, work.q, work.v, work, a2)
        rk4.third(h, q, v, a1, a2, work.q, work.v)
        accelerate(laws, instants, middle, work.q, work.v, work, a3)
        rk4.fourth(h, q, v, a2, a3, work.q, work.v)
        accelerate(laws, instants, then, work.q, work.v, work, a4)
        rk4.finish(h, q, v, a1, a2, a3, a4)
        now, then = then, now
        if (step + 1) % steps_per_sample == 0 and out_of_bounds(q, limit) >= 0:
            return step + 1
    return steps


@kernel
def _record(laws: Laws, step: int, steps_per_sample: int, q: Array, v: Array, work: Work, course: Course) -> None:
    x = work.contact.x
    for mesh in range(7):
        backlash = laws.mesh.backlash[mesh]
        course.open[mesh] += abs(x[mesh]) <= backlash
        course.back[mesh] += x[mesh] < -backlash
    if step % steps_per_sample == 0:
        sample = step // steps_per_sample
        for mesh in range(7):
            course.x[sample, mesh] = x[mesh]
            course.rate[sample, mesh] = work.contact.rate[mesh]
            course.force[sample, mesh] = work.contact.force[mesh]
        for b in range(len(work.housing)):
            for axis in range(3):
                course.housing[sample, b, axis] = work.housing[b, axis]
        _twist(laws, q, course.twist[sample])
        _twist(laws, v, course.twist_rate[sample])


@kernel
def _twist(laws: Laws, q: Array, out: Array) -> None:
    n = len(laws.ring.cos)
    total = 0.0
    for i in range(n, 2 * n):
        total += q[i]
    out[0] = total * laws.ring.lever
    for k in range(len(laws.probes)):
        out[1 + k] = q[laws.probes[k]]


@kernel
def out_of_bounds(q: Array, limit: float) -> int:
    """Return the first entry that isn't within +-limit, or isn't a number; -1 where all are."""
    for i in range(len(q)):
        if not abs(q[i]) <= limit:
            return i
    return -1


@kernel
def set_slot(laws: Laws, start: Array, end: Array, interval: Interval, elapsed: float, instants: Instants, slot: int) -> None:
    """Do the same as `set_instant`, for callers outside of compiled code."""
    set_instant(laws, start, end, interval, elapsed, instants, slot)


@kernel
def forces(laws: Laws, instants: Instants, slot: int, q: Array, v: Array, work: Work, out: Array) -> None:
    """Do the same as `add_forces`, for callers outside of compiled code."""
    add_forces(laws, instants, slot, q, v, work, out)
