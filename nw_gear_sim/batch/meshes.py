"""The seven meshes of many points at once: elongation, force by backlash, stiffness and damping, and friction.

The laws are those of `physics.mesh` and `physics.friction`, with the flexibility phi of the ring modes that were left
out in series with stage I: where the flanks touch, K f / (1 + phi K) instead of K f.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import fused

Indices = npt.NDArray[np.int64]

PHASES = 256
"""Phases in a mesh period that have an entry in the table of friction, as in `physics.friction`."""
STAGE = (0, 0, 0, 1, 1, 1, 2)
"""Stage of each mesh."""


class GearRows(NamedTuple):
    """How gears touch: places of u, x, y, z (contacts, 4); mesh of each contact; rows with points in the last axis.

    Attributes:
        normal: (contacts, 4, lanes); slide: u, x, y, (contacts, 3, lanes); roll: u, (contacts, lanes).
    """

    place: Indices
    mesh: Indices
    normal: Array
    slide: Array
    roll: Array


class MeshLaw(NamedTuple):
    """Data of the seven meshes, arrays of shape (7, lanes) if not said otherwise.

    Attributes:
        stiffness, swing: K = stiffness + swing cos psi, N/m.
        error_mean, error_swing: e = error_mean + error_swing sin psi, m; error_rate: error_swing psi', m/s.
        turn_cos, turn_sin: rotation of psi in one step.
        backlash: m; damping: N s/m; gap_damping: share of it that acts in the gap, 0 or 1.
        flexible, beside: phi and that by the force of another planet, m/N.
        per_step: 1 / (2 h), 1/s.
        start, advance: of the friction phase, in turns, and in one step.
        table: shares g and g_1 (m), (3, PHASES + 1, 2, lanes).
        gears: rows of the gears.
    """

    stiffness: Array
    swing: Array
    error_mean: Array
    error_swing: Array
    error_rate: Array
    turn_cos: Array
    turn_sin: Array
    backlash: Array
    damping: Array
    gap_damping: Array
    flexible: Array
    beside: Array
    per_step: float
    start: Array
    advance: Array
    table: Array
    gears: GearRows


class MeshState(NamedTuple):
    """What the meshes do, arrays of shape (7, lanes).

    Attributes:
        cos, sin: of psi.
        y: elongation by the motions alone, m; moved, before: by how much in the last step and the one before.
        x, force, sliding, rolling: elongation (m), force (N) and friction forces of the last evaluation.
        open, back: steps without load, and with load on the back flanks.
    """

    cos: Array
    sin: Array
    y: Array
    moved: Array
    before: Array
    x: Array
    force: Array
    sliding: Array
    rolling: Array
    open: Array
    back: Array


@fused
def elongate(law: MeshLaw, x: Array, ring: Array, y: Array, state: MeshState) -> None:
    """Set the elongations y by the motions, m, (7, lanes).

    Args:
        law: of the meshes.
        x: displacements of gears, m, (motions, lanes).
        ring: sums over the ring's modes, (3, lanes): class 0, and real and imaginary part of class 1.
        y: set here.
        state: its forces of the last evaluation count for the ring's flexibility from planet to planet.
    """
    lanes = x.shape[1]
    for mesh in range(3):
        cos, sin = math.cos(2.0 * math.pi / 3.0 * mesh), math.sin(2.0 * math.pi / 3.0 * mesh)
        for lane in range(lanes):
            pushed = state.force[0, lane] + state.force[1, lane] + state.force[2, lane]
            own = ring[0, lane] + cos * ring[1, lane] - sin * ring[2, lane]
            y[mesh, lane] = own - law.beside[mesh, lane] * pushed
    for mesh in range(3, 7):
        for lane in range(lanes):
            y[mesh, lane] = 0.0
    gears = law.gears
    for g in range(len(gears.mesh)):
        i, j, k, m = gears.place[g]
        mesh = gears.mesh[g]
        for lane in range(lanes):
            y[mesh, lane] += (
                gears.normal[g, 0, lane] * x[i, lane]
                + gears.normal[g, 1, lane] * x[j, lane]
                + gears.normal[g, 2, lane] * x[k, lane]
                + gears.normal[g, 3, lane] * x[m, lane]
            )


@fused
def load_meshes(law: MeshLaw, step: float, state: MeshState) -> None:
    """Set the forces at the elongations `state.y`, the number of the step giving the phase of friction."""
    size = state.y.size
    stiffness, swing = law.stiffness.reshape(size), law.swing.reshape(size)
    error_mean, error_swing = law.error_mean.reshape(size), law.error_swing.reshape(size)
    error_rate, backlash = law.error_rate.reshape(size), law.backlash.reshape(size)
    damping, gap_damping, flexible = law.damping.reshape(size), law.gap_damping.reshape(size), law.flexible.reshape(size)
    start, advance, table = law.start.reshape(size), law.advance.reshape(size), law.table.reshape(law.table.size)
    cos, sin, y = state.cos.reshape(size), state.sin.reshape(size), state.y.reshape(size)
    moved, before, x = state.moved.reshape(size), state.before.reshape(size), state.x.reshape(size)
    force, sliding, rolling = state.force.reshape(size), state.sliding.reshape(size), state.rolling.reshape(size)
    opened, back = state.open.reshape(size), state.back.reshape(size)
    lanes = state.y.shape[1]
    for mesh in range(7):
        stage = STAGE[mesh]
        for lane in range(lanes):
            i = mesh * lanes + lane
            turns = start[i] + advance[i] * step
            place = (turns - math.floor(turns)) * PHASES
            k = min(int(place), PHASES - 1)
            share = place - k
            at = ((stage * (PHASES + 1) + k) * 2) * lanes + lane
            sliding[i] = table[at] + share * (table[at + 2 * lanes] - table[at])
            rolling[i] = table[at + lanes] + share * (table[at + 3 * lanes] - table[at + lanes])
    for i in range(size):
        k_now = stiffness[i] + swing[i] * cos[i]
        elongation = y[i] + error_mean[i] + error_swing[i] * sin[i]
        rate = (3.0 * moved[i] - before[i]) * law.per_step + error_rate[i] * cos[i]
        softer = 1.0 / (1.0 + flexible[i] * k_now)
        touching = abs(elongation) > backlash[i]
        damped = damping[i] * rate * (softer if touching else gap_damping[i])
        elongation -= flexible[i] * damped
        elastic = k_now * softer * max(abs(elongation) - backlash[i], 0.0)
        pointed = math.copysign(elastic, elongation)
        x[i] = elongation - flexible[i] * pointed
        force[i] = pointed + damped
        sliding[i] *= elastic
        rolling[i] *= elastic
        opened[i] += 0.0 if elastic > 0.0 else 1.0
        back[i] += 1.0 if pointed < 0.0 else 0.0


@fused
def add_gear_forces(law: MeshLaw, state: MeshState, force: Array) -> None:
    """Add the meshes' forces to those on the gears, N, (motions, lanes)."""
    gears = law.gears
    for g in range(len(gears.mesh)):
        i, j, k, m = gears.place[g]
        mesh = gears.mesh[g]
        for lane in range(force.shape[1]):
            pushed, slid, rolled = state.force[mesh, lane], state.sliding[mesh, lane], state.rolling[mesh, lane]
            force[i, lane] += (
                gears.slide[g, 0, lane] * slid + gears.roll[g, lane] * rolled - gears.normal[g, 0, lane] * pushed
            )
            force[j, lane] += gears.slide[g, 1, lane] * slid - gears.normal[g, 1, lane] * pushed
            force[k, lane] += gears.slide[g, 2, lane] * slid - gears.normal[g, 2, lane] * pushed
            force[m, lane] -= gears.normal[g, 3, lane] * pushed
