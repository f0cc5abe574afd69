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
from nw_gear_sim.batch.lanes import LANES, exact, of
from nw_gear_sim.compiled import apart

Indices = npt.NDArray[np.int64]

PHASES = 256
"""Phases in a mesh period that have an entry in the table of friction, as in `physics.friction`."""
STAGE = (0, 0, 0, 1, 1, 1, 2)
"""Stage of each mesh."""
_COS, _SIN = math.cos(2.0 * math.pi / 3.0), math.sin(2.0 * math.pi / 3.0)


class GearRows(NamedTuple):
    """How gears touch: rows read by `lanes.of`.

    Attributes:
        mesh: of each contact; turning, moving: rows of its u and x; those of y and z follow, (contacts,).
        normal: (4 contacts); slide: of u, x, y, (3 contacts); roll: of u, (contacts).
    """

    mesh: Indices
    turning: Indices
    moving: Indices
    normal: Array
    slide: Array
    roll: Array


class MeshLaw(NamedTuple):
    """Data of the seven meshes, flat arrays (7, lanes) if not said otherwise.

    Attributes:
        stiffness, swing: K = stiffness + swing cos psi, N/m.
        error_mean, error_swing: e = error_mean + error_swing sin psi, m; error_rate: error_swing psi', m/s.
        backlash: m; damping: N s/m; gap_damping: share of it that acts in the gap, 0 or 1.
        flexible, beside: phi and that by the force of another planet, m/N.
        per_step: 1 / (2 h), 1/s.
        start, advance: of the friction phase, in turns, and in one step.
        table: shares g and g_1 (m), (3, lanes, PHASES + 1, 2).
        gears: rows of the gears.
    """

    stiffness: Array
    swing: Array
    error_mean: Array
    error_swing: Array
    error_rate: Array
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
    """What the meshes do, flat arrays (7, lanes).

    Attributes:
        y: elongation by the motions alone, m; moved, before: by how much in the last step and the one before.
        x, force, sliding, rolling: elongation (m), force (N) and friction forces of the last evaluation.
        open, back: steps without load, and with load on the back flanks.
        place, share: of the friction phase in the table, scratch.
    """

    y: Array
    moved: Array
    before: Array
    x: Array
    force: Array
    sliding: Array
    rolling: Array
    open: Array
    back: Array
    place: Array
    share: Array


@apart
def elongate(law: MeshLaw, x: Array, ring: Array, y: Array, force: Array) -> None:
    """Set the elongations y by the motions, m, flat (7, lanes).

    Args:
        law: of the meshes.
        x: displacements of gears, m, flat (motions, lanes).
        ring: sums over the ring's modes, of `ringstep.step_ring`.
        y: set here.
        force: of the last evaluation, for the ring's flexibility from planet to planet.
    """
    for lane in range(LANES):
        pushed = force[lane] + force[LANES + lane] + force[2 * LANES + lane]
        shift = ring[lane] - law.beside[lane] * pushed
        real, imaginary = ring[LANES + lane], ring[2 * LANES + lane]
        y[lane] = shift + real
        y[LANES + lane] = shift + _COS * real - _SIN * imaginary
        y[2 * LANES + lane] = shift + _COS * real + _SIN * imaginary
    for i in range(3 * LANES, 7 * LANES):
        y[i] = 0.0
    gears = law.gears
    for g in range(len(gears.mesh)):
        at, i, j = gears.mesh[g] * LANES, gears.turning[g] * LANES, gears.moving[g] * LANES
        y_g, turned, moved = y[at : at + LANES], x[i : i + LANES], x[j : j + 3 * LANES]
        for lane in range(LANES):
            y_g[lane] = (
                y_g[lane]
                + of(gears.normal, 4 * g, lane) * turned[lane]
                + of(gears.normal, 4 * g + 1, lane) * moved[lane]
                + of(gears.normal, 4 * g + 2, lane) * moved[LANES + lane]
                + of(gears.normal, 4 * g + 3, lane) * moved[2 * LANES + lane]
            )


@apart
def load_meshes(law: MeshLaw, step: float, psi: Array, state: MeshState) -> None:
    """Set the forces at the elongations `state.y`.

    Args:
        law: of the meshes.
        step: number of the step, which gives the phase of friction.
        psi: cosine and sine of psi, flat (2, 7, lanes).
        state: changed in place.
    """
    look_up_friction(law, step, state)
    for i in range(7 * LANES):
        stiffness = law.stiffness[i] + law.swing[i] * psi[i]
        elongation = state.y[i] + law.error_mean[i] + law.error_swing[i] * psi[7 * LANES + i]
        rate = exact(3.0 * state.moved[i] - state.before[i], law.per_step) + law.error_rate[i] * psi[i]
        softer = 1.0 / (1.0 + law.flexible[i] * stiffness)
        touching = abs(elongation) > law.backlash[i]
        damped = exact(law.damping[i] * rate, softer if touching else law.gap_damping[i])
        elongation -= law.flexible[i] * damped
        elastic = exact(stiffness * softer, max(abs(elongation) - law.backlash[i], 0.0))
        pointed = math.copysign(elastic, elongation)
        state.x[i] = elongation - law.flexible[i] * pointed
        state.force[i] = pointed + damped
        state.sliding[i] *= elastic
        state.rolling[i] *= elastic
        state.open[i] += 0.0 if elastic > 0.0 else 1.0
        state.back[i] += 1.0 if pointed < 0.0 else 0.0


@apart
def look_up_friction(law: MeshLaw, step: float, state: MeshState) -> None:
    """Set g and g_1 (m) of all meshes as `sliding` and `rolling`, at a number of steps."""
    for i in range(7 * LANES):
        turns = law.start[i] + exact(law.advance[i], step)
        place = exact(turns - math.floor(turns), PHASES)
        whole = min(math.floor(place), PHASES - 1.0)
        state.place[i] = whole
        state.share[i] = place - whole
    for mesh in range(7):
        stage = STAGE[mesh]
        for lane in range(LANES):
            i = mesh * LANES + lane
            k, share = np.uint64(state.place[i]), state.share[i]
            after = k + np.uint64(1)
            near, far = law.table[stage, lane, k, 0], law.table[stage, lane, k, 1]
            state.sliding[i] = near + exact(share, law.table[stage, lane, after, 0] - near)
            state.rolling[i] = far + exact(share, law.table[stage, lane, after, 1] - far)


@apart
def add_gear_forces(gears: GearRows, pushed: Array, slid: Array, rolled: Array, force: Array) -> None:
    """Add the meshes' forces, flat (7, lanes), to those on the gears, N, flat (motions, lanes)."""
    for g in range(len(gears.mesh)):
        at, i, j = gears.mesh[g] * LANES, gears.turning[g] * LANES, gears.moving[g] * LANES
        push, slide, roll = pushed[at : at + LANES], slid[at : at + LANES], rolled[at : at + LANES]
        turning, moving = force[i : i + LANES], force[j : j + 3 * LANES]
        for lane in range(LANES):
            p, s = push[lane], slide[lane]
            rubbed = exact(of(gears.slide, 3 * g, lane), s) + of(gears.roll, g, lane) * roll[lane]
            turning[lane] = turning[lane] + rubbed - of(gears.normal, 4 * g, lane) * p
            x_rubbed, y_rubbed = of(gears.slide, 3 * g + 1, lane) * s, of(gears.slide, 3 * g + 2, lane) * s
            moving[lane] = moving[lane] + x_rubbed - of(gears.normal, 4 * g + 1, lane) * p
            moving[LANES + lane] = moving[LANES + lane] + y_rubbed - of(gears.normal, 4 * g + 2, lane) * p
            moving[2 * LANES + lane] -= of(gears.normal, 4 * g + 3, lane) * p
