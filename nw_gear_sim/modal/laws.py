"""The gearbox with the ring in modes: constants of the forces, made from those of the whole model.

Coordinates are the modal coordinates of the ring (sqrt(kg) m), then all other motions as in `layout` (m). Linear forces
of an oscillator on itself (a mode's frequency and damping, a bearing's damping to ground) are left to the integrator.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.modal.ring import KNOTS, ContactTable, RingModes, contact_table, rigid_ring_modes, ring_modes
from nw_gear_sim.physics.bearing import BearingLaw
from nw_gear_sim.physics.friction import FrictionLaw
from nw_gear_sim.physics.mesh import Indices, MeshLaw, Rows
from nw_gear_sim.physics.spring import SpringLaw
from nw_gear_sim.physics.tooth import ToothLaw

COUPLING = 1e-9
"""Share of the largest modal damping below which a coupling of two modes is rounding."""
VECTOR = 8
"""The modes are filled up to a multiple of this, the numbers in a vector of 64 bytes."""


class ModalLaws(NamedTuple):
    """All constants; n motions of which the first `modes` are the ring's.

    Attributes:
        springs, bearings, mesh, friction, teeth, rows: as in `model.Laws`, places counted in the n motions; the
            bearings have no damping here, and the ring's part of the rows is in `table`.
        table: contact of the planets with the modes; planet_angle: th_j, rad; knots_per_radian: of the table.
        weight_cos, weight_sin: forces on the modes by the ring's weight, times cosine and sine of its angle, (modes,).
        turn: mean rotation of the ring by the modes, and force on them for 1 N m of input torque, (modes,).
        push: elongation of the ring's meshes by 1 N m acting on the modes left out, 1/N.
        reach: where a motion moves its part of the gearbox by 1 m, (n,).
        first, second, coupling: damping forces -coupling v[second] on modes `first` (1/s).
        weight: constant forces on the motions, (n,), N; inverse_mass: (n,), 1/kg.
        square, damping: of each motion as an oscillator of its own, (n,), 1/s^2 and 1/s.
        quick: whether the bearings take the quick powers.
        wheel_ratio: angle of everything that turns over that of the ring: the ring, the meshes' phases I to III, cages.
        cage_wheel: which of them each bearing's cage is.
        output, output_push, probes: as in `model.Laws`.
    """

    springs: SpringLaw
    bearings: BearingLaw
    mesh: MeshLaw
    friction: FrictionLaw
    teeth: ToothLaw
    rows: Rows
    table: ContactTable
    planet_angle: Array
    knots_per_radian: float
    weight_cos: Array
    weight_sin: Array
    turn: Array
    push: float
    reach: Array
    first: Indices
    second: Indices
    coupling: Array
    weight: Array
    inverse_mass: Array
    square: Array
    damping: Array
    quick: bool
    wheel_ratio: Array
    cage_wheel: Indices
    output: int
    output_push: float
    probes: Indices


def choose_modes(gearbox: Gearbox, bandwidth: float, *, rigid: bool, coupled: bool) -> tuple[ModalLaws, RingModes]:
    """Return the laws and the ring's modes they work with.

    Args:
        gearbox: the whole model.
        bandwidth: frequency above which modes are left out, Hz; inf = none.
        rigid: the ring moves as one body.
        coupled: keep the damping that couples modes, and take powers exactly.
    """
    law, count = gearbox.laws.ring, 4 * gearbox.layout.segments
    mass = gearbox.mass[:count]
    if rigid:
        kept = rigid_ring_modes(law, mass, gearbox.laws.engagement.radius, gearbox.laws.engagement.base_radius)
        dropped = kept.select(np.zeros(0, np.int64))
    else:
        modes = ring_modes(law, mass)
        below = np.sqrt(modes.square) <= 2 * np.pi * bandwidth
        kept, dropped = modes.select(below).padded(VECTOR), modes.select(~below)
    return _laws(gearbox, kept, contact_table(gearbox.laws.engagement, kept, dropped), coupled), kept


def _laws(gearbox: Gearbox, ring: RingModes, table: ContactTable, coupled: bool) -> ModalLaws:
    laws, segments, modes = gearbox.laws, gearbox.layout.segments, len(ring.square)
    shift = 4 * segments - modes
    rest = slice(4 * segments, None)
    wheel_ratio, cage_wheel = np.unique(laws.bearings.cage_ratio, return_inverse=True)
    pull = laws.ring.weight * ring.shapes[: 2 * segments].reshape(2, segments, modes)
    largest = np.max(np.abs(ring.shapes), axis=0)
    inverse_mass = np.concatenate([np.ones(modes), laws.inverse_mass[rest]])
    own_damping = np.zeros(gearbox.layout.size - 4 * segments)
    for places, damping in zip(laws.bearings.place, laws.bearings.damping, strict=True):
        held = places[places >= 0] - 4 * segments
        own_damping[held] += damping * laws.inverse_mass[rest][held]
    first, second = np.nonzero(np.abs(ring.damping - np.diag(np.diag(ring.damping))) > COUPLING * ring.damping.max())
    if not coupled:
        first, second = first[:0], second[:0]
    return ModalLaws(
        springs=laws.springs._replace(first=laws.springs.first - shift, second=laws.springs.second - shift),
        bearings=laws.bearings._replace(
            place=np.where(laws.bearings.place >= 0, laws.bearings.place - shift, -1),
            damping=np.zeros_like(laws.bearings.damping),
        ),
        mesh=laws.mesh,
        friction=laws.friction,
        teeth=laws.teeth,
        rows=_shifted(laws.rows, shift),
        table=table,
        planet_angle=laws.engagement.planet_angle,
        knots_per_radian=KNOTS / laws.engagement.pitch,
        weight_cos=laws.ring.cos @ pull[0] - laws.ring.sin @ pull[1],
        weight_sin=-laws.ring.sin @ pull[0] - laws.ring.cos @ pull[1],
        turn=laws.ring.lever * ring.shapes[segments : 2 * segments].sum(axis=0),
        push=laws.ring.lever * table.push,
        reach=np.concatenate([1 / np.where(largest > 0.0, largest, 1.0), np.ones(len(own_damping))]),
        first=first,
        second=second,
        coupling=ring.damping[first, second],
        weight=np.concatenate([np.zeros(modes), laws.weight[rest]]),
        inverse_mass=inverse_mass,
        square=np.concatenate([ring.square, np.zeros(len(own_damping))]),
        damping=np.concatenate([np.diag(ring.damping), own_damping]),
        quick=not coupled,
        wheel_ratio=np.concatenate([[1.0], laws.phase_ratio, wheel_ratio]),
        cage_wheel=4 + cage_wheel.astype(np.int64),
        output=laws.output - shift,
        output_push=laws.output_push,
        probes=laws.probes - shift,
    )


def _shifted(rows: Rows, shift: int) -> Rows:
    """Rows with places counted in the reduced motions; entries that nothing uses stay at 0."""
    return rows._replace(place=np.where(rows.place > 0, rows.place - shift, 0))
