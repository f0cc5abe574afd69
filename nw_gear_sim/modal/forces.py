"""The right-hand side with the ring in modes: everything that depends on time alone, then the forces per mass.

Turning angles (ring, mesh phases, cages) go on by rotations from substep to substep, exact for a speed that changes
linearly. The meshes of the ring are in series with the flexibility of the modes left out: with K in the teeth and R in
the ring (friction counted in) an elongation x of what is kept gives the force F = K/(1 + K R) f(x), and the teeth see
x - R F.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import fused, inlined, kernel, summing
from nw_gear_sim.modal.laws import ModalLaws
from nw_gear_sim.modal.ring import KNOTS
from nw_gear_sim.model import Interval
from nw_gear_sim.physics.bearing import MARKS, add_marks, bearing_forces_here, turn_marks
from nw_gear_sim.physics.friction import look_up
from nw_gear_sim.physics.mesh import Contact, Indices, backlash_function, excite
from nw_gear_sim.physics.spring import add_springs
from nw_gear_sim.physics.tooth import deviate

SLOTS = 3
"""Times within a step that are needed at once."""
PLANETS = 3


class ModalInstants(NamedTuple):
    """What depends on time alone, in slots: arrays whose first axis is the slot.

    Attributes:
        wheel: cosine, sine of what turns; of its change over a substep; and of the change of that, (6, wheels).
        turn, cage, mark, excitation, torque: as in `model.Instants`.
        knot, share: position of the contacts in the table, (slot, 3); drift: knots passed per second, (slot,).
        soft: 1/(1 + K R) of the ring's meshes, and its rate (1/s), (slot, 3, 2); flexibility: R, m/N, (slot, 3).
    """

    wheel: Array
    turn: Array
    cage: Array
    mark: Array
    excitation: Array
    torque: Array
    knot: Indices
    share: Array
    drift: Array
    soft: Array
    flexibility: Array


class ModalWork(NamedTuple):
    """Scratch memory, and what the last evaluation found.

    Attributes:
        lean, load: of the rollers; housing: forces on the bearings' housings, N, (bearings, 3).
        contact: of the meshes as the teeth see them; bare: elongations of the ring's meshes by what is kept, m, (3,).
        slopes: forces per mass of the stages of a step, (4, n); x, v: their state.
    """

    lean: Array
    load: Array
    housing: Array
    contact: Contact
    bare: Array
    slopes: Array
    x: Array
    v: Array


def new_instants(laws: ModalLaws) -> ModalInstants:
    """Return empty slots."""
    return ModalInstants(
        wheel=np.zeros((6, len(laws.wheel_ratio))),
        turn=np.zeros((SLOTS, 2)),
        cage=np.zeros((SLOTS, len(laws.cage_wheel), 2)),
        mark=np.zeros((SLOTS, MARKS, 2)),
        excitation=np.zeros((SLOTS, 7, 6)),
        torque=np.zeros(SLOTS),
        knot=np.zeros((SLOTS, PLANETS), np.int64),
        share=np.zeros((SLOTS, PLANETS)),
        drift=np.zeros(SLOTS),
        soft=np.ones((SLOTS, PLANETS, 2)),
        flexibility=np.zeros((SLOTS, PLANETS)),
    )


def new_work(laws: ModalLaws) -> ModalWork:
    """Return scratch memory."""
    n = len(laws.weight)
    return ModalWork(
        lean=np.zeros(len(laws.bearings.cos)),
        load=np.zeros(len(laws.bearings.cos)),
        housing=np.zeros((len(laws.cage_wheel), 3)),
        contact=Contact(np.zeros(7), np.zeros(7), np.zeros(7), np.zeros(7)),
        bare=np.zeros(PLANETS),
        slopes=np.zeros((4, n)),
        x=np.zeros(n),
        v=np.zeros(n),
    )


@kernel
def start_wheels(ratio: Array, interval: Interval, substep: float, wheel: Array) -> None:
    """Set the turning angles at the start of an interval, for substeps of `substep` s."""
    growth = (interval.speed_end - interval.speed_start) / interval.duration
    for k in range(len(ratio)):
        angle = ratio[k] * interval.angle
        advance = ratio[k] * (interval.speed_start + 0.5 * growth * substep) * substep
        bend = ratio[k] * growth * substep * substep
        wheel[0, k], wheel[1, k] = math.cos(angle), math.sin(angle)
        wheel[2, k], wheel[3, k] = math.cos(advance), math.sin(advance)
        wheel[4, k], wheel[5, k] = math.cos(bend), math.sin(bend)


@kernel
def turn_wheels(wheel: Array) -> None:
    """Go on by a substep."""
    for k in range(wheel.shape[1]):
        c, s, dc, ds = wheel[0, k], wheel[1, k], wheel[2, k], wheel[3, k]
        wheel[0, k], wheel[1, k] = c * dc - s * ds, s * dc + c * ds
        wheel[2, k], wheel[3, k] = dc * wheel[4, k] - ds * wheel[5, k], ds * wheel[4, k] + dc * wheel[5, k]


@inlined
def set_modal_instant(
    laws: ModalLaws, start: Array, end: Array, interval: Interval, elapsed: float, instants: ModalInstants, slot: int
) -> None:
    """Evaluate everything that depends on time alone; the wheels have to stand at that time.

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
    wheel = instants.wheel
    instants.torque[slot] = interval.torque_start + (interval.torque_end - interval.torque_start) * share
    instants.turn[slot, 0], instants.turn[slot, 1] = wheel[0, 0], wheel[1, 0]
    last, cos, sin = -1, 0.0, 0.0
    for b in range(len(laws.cage_wheel)):
        if laws.cage_wheel[b] != last:  # mostly it is the same; a loop of look-ups would be put into slow vectors
            last = laws.cage_wheel[b]
            cos, sin = wheel[0, last], wheel[1, last]
        instants.cage[slot, b, 0], instants.cage[slot, b, 1] = cos, sin
    excitation = instants.excitation[slot]
    for m in range(7):
        k = 1 + laws.mesh.stage[m]
        ratio = laws.wheel_ratio[k]
        excitation[m, 0], excitation[m, 1], excitation[m, 2] = excite(
            laws.mesh, m, wheel[0, k], wheel[1, k], ratio * speed
        )
        shares = look_up(start, end, share, k - 1, ratio * angle + laws.mesh.phase_offset[m])
        excitation[m, 3], excitation[m, 4] = shares
        excitation[m, 5] = 0.0
    for k in range(laws.teeth.used[0]):
        m = laws.teeth.mesh[k]
        ratio = laws.wheel_ratio[1 + laws.mesh.stage[m]]
        deviate(laws.teeth, k, ratio * angle + laws.mesh.phase_offset[m], ratio * speed, excitation[m])
    turn_marks(laws.bearings.marks, angle, instants.mark[slot])
    instants.drift[slot] = -speed * laws.knots_per_radian
    knots = len(laws.table.normal) - 1
    for j in range(3):
        position = (laws.planet_angle[j] - angle) * laws.knots_per_radian
        below = math.floor(position)
        instants.share[slot, j] = position - below
        instants.knot[slot, j] = int(below) % knots
        _soften(laws, instants, slot, j, laws.wheel_ratio[1] * speed)


@inlined
def _soften(laws: ModalLaws, instants: ModalInstants, slot: int, j: int, rate: float) -> None:
    """Set the flexibility of what is left out, R, and 1/(1 + K R) with its rate; `rate` of the mesh phase, rad/s."""
    k = instants.knot[slot, j] % KNOTS
    normal, slide, roll = laws.table.flexibility
    sliding, rolling = instants.excitation[slot, j, 3], instants.excitation[slot, j, 4]
    low = normal[k] - sliding * slide[k] - rolling * roll[k]
    slope = normal[k + 1] - sliding * slide[k + 1] - rolling * roll[k + 1] - low
    flexibility = low + instants.share[slot, j] * slope
    stiffness = instants.excitation[slot, j, 0]
    cos, sin = instants.wheel[0, 1], instants.wheel[1, 1]
    growth = rate * (laws.mesh.stiffness_sin[j] * cos - laws.mesh.stiffness_cos[j] * sin)
    growth += instants.excitation[slot, j, 5]
    soft = 1.0 / (1.0 + stiffness * flexibility)
    instants.flexibility[slot, j] = flexibility
    instants.soft[slot, j, 0] = soft
    instants.soft[slot, j, 1] = -soft * soft * (growth * flexibility + stiffness * slope * instants.drift[slot])


@inlined
def accelerate(
    laws: ModalLaws, instants: ModalInstants, slot: int, x: Array, v: Array, work: ModalWork, out: Array
) -> None:
    """Set the forces per mass (m/s^2, for modes m sqrt(kg)/s^2) on all motions, without each oscillator's own."""
    modes = len(laws.turn)
    cos, sin, torque = instants.turn[slot, 0], instants.turn[slot, 1], instants.torque[slot]
    for i in range(modes):
        out[i] = laws.weight_cos[i] * cos + laws.weight_sin[i] * sin + laws.turn[i] * torque
    for i in range(modes, len(out)):
        out[i] = laws.weight[i]
    for k in range(len(laws.first)):
        out[laws.first[k]] -= laws.coupling[k] * v[laws.second[k]]
    out[laws.output] += laws.output_push * torque
    add_springs(laws.springs, x, v, out)
    bearing_forces_here(laws.bearings, laws.quick, instants.cage[slot], x, work.lean, work.load, work.housing)
    if laws.bearings.marks.used[0] > 0:
        add_marks(laws.bearings, instants.mark[slot], instants.cage[slot], x, work.housing)
    for b in range(len(work.housing)):
        for axis in range(3):
            place = laws.bearings.place[b, axis]
            if place >= 0:
                out[np.uint64(place)] -= work.housing[b, axis]
    pushed = laws.push * torque
    others = work.contact.force[0] + work.contact.force[1] + work.contact.force[2]
    for j in range(3):
        lean = pushed - laws.table.neighbour * (others - work.contact.force[j])
        _ring_mesh(laws, instants, slot, j, lean, x, v, work, out)
    _other_meshes(laws, instants.excitation[slot], x, v, work.contact, out)
    for i in range(modes, len(out)):
        out[i] *= laws.inverse_mass[i]


@summing
def _along(low: Array, high: Array, share: float, x: Array, v: Array, modes: int) -> tuple[float, float, float]:
    """Return row . x, row . v and (d row / d knot) . x for a row between two knots."""
    elongation, rate, slope = 0.0, 0.0, 0.0
    for i in range(modes):
        step = high[i] - low[i]
        row = low[i] + share * step
        elongation += row * x[i]
        rate += row * v[i]
        slope += step * x[i]
    return elongation, rate, slope


@inlined
def _push_modes(
    normal: Array, slide: Array, roll: Array, share: float, total: float, sliding: float, rolling: float, out: Array
) -> None:
    """Add the forces of a contact to the modes; rows of the knots on both sides, each (2, modes)."""
    there, here = share * total, (1.0 - share) * total
    sliding_there, sliding_here = share * sliding, (1.0 - share) * sliding
    rolling_there, rolling_here = share * rolling, (1.0 - share) * rolling
    for i in range(normal.shape[1]):
        friction = sliding_here * slide[0, i] + sliding_there * slide[1, i]
        friction += rolling_here * roll[0, i] + rolling_there * roll[1, i]
        out[i] += friction - here * normal[0, i] - there * normal[1, i]


@inlined
def _ring_mesh(
    laws: ModalLaws,
    instants: ModalInstants,
    slot: int,
    j: int,
    lean: float,
    x: Array,
    v: Array,
    work: ModalWork,
    out: Array,
) -> None:
    """Add the forces between the ring and planet j; `lean`: elongation (m) by other forces on what is left out."""
    place, normal, slide, roll, _ = laws.rows
    knot, share, excitation = instants.knot[slot, j], instants.share[slot, j], instants.excitation[slot]
    table = laws.table.normal
    along, rate, slope = _along(table[knot], table[knot + 1], share, x, v, table.shape[1])
    bare = excitation[j, 1] + lean + along
    rate += excitation[j, 2] + slope * instants.drift[slot]
    for k in range(8, 12):
        i = np.uint64(place[j, k])  # unsigned: no check for negative indices
        bare += normal[j, k] * x[i]
        rate += normal[j, k] * v[i]
    soft = instants.soft[slot, j, 0]
    elastic = soft * excitation[j, 0] * backlash_function(bare, laws.mesh.backlash[j])
    total = elastic
    if elastic != 0.0:
        total += soft * soft * laws.mesh.damping[j] * rate
    elif laws.mesh.damping_in_gap:
        total += laws.mesh.damping[j] * rate
    sliding, rolling = excitation[j, 3] * abs(elastic), excitation[j, 4] * abs(elastic)
    knots = slice(knot, knot + 2)
    _push_modes(
        laws.table.normal[knots], laws.table.slide[knots], laws.table.roll[knots], share, total, sliding, rolling, out
    )
    for k in range(8, 12):
        out[np.uint64(place[j, k])] += slide[j, k] * sliding + roll[j, k] * rolling - normal[j, k] * total
    contact = work.contact
    work.bare[j] = bare
    contact.x[j] = bare - instants.flexibility[slot, j] * elastic
    contact.force[j], contact.elastic[j] = total, elastic


@inlined
def _other_meshes(laws: ModalLaws, excitation: Array, x: Array, v: Array, contact: Contact, out: Array) -> None:
    """Add the forces of stages II and III."""
    place, normal, slide, roll, _ = laws.rows
    for mesh in range(3, 7):
        elongation, rate = excitation[mesh, 1], excitation[mesh, 2]
        count = laws.mesh.entries[mesh]
        for k in range(count):
            i = np.uint64(place[mesh, k])
            elongation += normal[mesh, k] * x[i]
            rate += normal[mesh, k] * v[i]
        elastic = excitation[mesh, 0] * backlash_function(elongation, laws.mesh.backlash[mesh])
        total = elastic
        if laws.mesh.damping_in_gap or elastic != 0.0:
            total += laws.mesh.damping[mesh] * rate
        sliding, rolling = excitation[mesh, 3] * abs(elastic), excitation[mesh, 4] * abs(elastic)
        for k in range(count):
            out[np.uint64(place[mesh, k])] += (
                slide[mesh, k] * sliding + roll[mesh, k] * rolling - normal[mesh, k] * total
            )
        contact.x[mesh], contact.force[mesh], contact.elastic[mesh] = elongation, total, elastic


@fused
def mesh_rates(laws: ModalLaws, instants: ModalInstants, slot: int, x: Array, v: Array, work: ModalWork) -> None:
    """Set the rates of the elongations (m/s) at the time of the last evaluation from better velocities v."""
    place, normal = laws.rows.place, laws.rows.normal
    table, contact = laws.table.normal, work.contact
    for mesh in range(7):
        rate = instants.excitation[slot, mesh, 2]
        for k in range(8 if mesh < 3 else 0, laws.mesh.entries[mesh]):
            rate += normal[mesh, k] * v[place[mesh, k]]
        if mesh < 3:
            knot = instants.knot[slot, mesh]
            share = instants.share[slot, mesh]
            _, along, slope = _along(table[knot], table[knot + 1], share, x, v, table.shape[1])
            rate += along + slope * instants.drift[slot]
            deflection = backlash_function(work.bare[mesh], laws.mesh.backlash[mesh])
            if deflection != 0.0:
                rate = instants.soft[slot, mesh, 0] * rate + instants.soft[slot, mesh, 1] * deflection
        contact.rate[mesh] = rate
