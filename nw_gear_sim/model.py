"""The right-hand side: adds up the forces of all laws at a time.

Everything that depends on time alone (stiffness, errors, friction shares, engaged segments, cages) is evaluated once
per time and kept in one of three slots of `Instants`; a Runge-Kutta step needs two new ones for four evaluations.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import inlined, kernel
from nw_gear_sim.physics.bearing import MARKS, BearingLaw, add_bearings, add_marks, bearing_forces, turn_marks
from nw_gear_sim.physics.engagement import EngagementLaw, engage
from nw_gear_sim.physics.friction import FrictionLaw, look_up
from nw_gear_sim.physics.mesh import Contact, Indices, MeshLaw, Rows, add_meshes, empty_rows, excite
from nw_gear_sim.physics.ring import RingLaw, ring_forces
from nw_gear_sim.physics.spring import SpringLaw, add_springs
from nw_gear_sim.physics.tooth import ToothLaw, deviate

SLOTS = 3


class Laws(NamedTuple):
    """All constants of a gearbox.

    Attributes:
        ring, springs, bearings, mesh, engagement, friction, teeth: of the laws.
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
    teeth: ToothLaw
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
        turn: cosine and sine of the ring's angle; cage: of the cages' angles, (slot, bearings, 2); mark: of the places
            of race defects, (slot, MARKS, 2).
        excitation: K, e, e', g, g_1 of the meshes, and K' by deviating teeth, (slot, 7, 6); torque: input torque, N m.
        rows: of the meshes, one for each slot.
    """

    turn: Array
    cage: Array
    mark: Array
    excitation: Array
    torque: Array
    rows: tuple[Rows, Rows, Rows]


class Work(NamedTuple):
    """Scratch memory, and what the last evaluation found.

    Attributes:
        padded: motions of the ring with neighbours at both ends; lean, load: of the rollers.
        housing: forces on the bearings' housings, N, (bearings, 3); contact: of the meshes.
        slopes, q, v: of the stages of a step.
    """

    padded: Array
    lean: Array
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
        mark=np.zeros((SLOTS, MARKS, 2)),
        excitation=np.zeros((SLOTS, 7, 6)),
        torque=np.zeros(SLOTS),
        rows=(rows(), rows(), rows()),
    )


def new_work(laws: Laws) -> Work:
    """Return scratch memory for a gearbox."""
    dof = len(laws.weight)
    return Work(
        padded=np.zeros((4, len(laws.ring.cos) + 2)),
        lean=np.zeros(len(laws.bearings.cos)),
        load=np.zeros(len(laws.bearings.cos)),
        housing=np.zeros((len(laws.bearings.stiffness), 3)),
        contact=Contact(np.zeros(7), np.zeros(7), np.zeros(7), np.zeros(7)),
        slopes=np.zeros((4, dof)),
        q=np.zeros(dof),
        v=np.zeros(dof),
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
    turn_marks(laws.bearings.marks, angle, instants.mark[slot])
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
        excitation[m, 5] = 0.0
    for k in range(laws.teeth.used[0]):
        m = laws.teeth.mesh[k]
        ratio = laws.phase_ratio[mesh.stage[m]]
        deviate(laws.teeth, k, ratio * angle + mesh.phase_offset[m], ratio * speed, excitation[m])


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
    bearing_forces(laws.bearings, False, instants.cage[slot], q, work.lean, work.load, work.housing)
    if laws.bearings.marks.used[0] > 0:
        add_marks(laws.bearings, instants.mark[slot], instants.cage[slot], q, work.housing)
    add_bearings(laws.bearings, work.housing, v, out)
    add_meshes(laws.mesh, instants.rows[slot], instants.excitation[slot], q, v, work.contact, out)


@kernel
def set_slot(
    laws: Laws, start: Array, end: Array, interval: Interval, elapsed: float, instants: Instants, slot: int
) -> None:
    """Do the same as `set_instant`, for callers outside of compiled code."""
    set_instant(laws, start, end, interval, elapsed, instants, slot)


@kernel
def forces(laws: Laws, instants: Instants, slot: int, q: Array, v: Array, work: Work, out: Array) -> None:
    """Do the same as `add_forces`, for callers outside of compiled code."""
    add_forces(laws, instants, slot, q, v, work, out)


@kernel
def difference(
    laws: Laws,
    instants: Instants,
    slot: int,
    q: Array,
    v: Array,
    work: Work,
    step: float,
    by_velocity: bool,
    out: Array,
) -> None:
    """Set -d(forces)/dq (N/m), or -d(forces)/dv (N s/m), by central differences, shape (dof, dof).

    Args:
        laws, instants, slot, work: as for `forces`.
        q, v: where to differentiate; one is changed and put back.
        step: of the differences, m or m/s.
        by_velocity: differentiate by v.
        out: set here.
    """
    above, below = work.slopes[0], work.slopes[1]
    varied = v if by_velocity else q
    for k in range(len(varied)):
        kept = varied[k]
        varied[k] = kept + step
        forces(laws, instants, slot, q, v, work, above)
        varied[k] = kept - step
        forces(laws, instants, slot, q, v, work, below)
        varied[k] = kept
        for i in range(len(varied)):
            out[i, k] = (below[i] - above[i]) / (2.0 * step)
