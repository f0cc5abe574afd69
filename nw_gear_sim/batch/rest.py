"""Static equilibrium of the points of a block, in the frame of the meshes.

The ring is linear: under constant forces its modes reduce to the flexibility matrix of the three contacts, so that each
point has one unknown for each motion of the gears and bearings, the ring's rotation and three contact displacements.
Newton's method with a fading stiffness to the last position, as in `equilibrium`, for all points at a time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.batch.lanes import LANES
from nw_gear_sim.batch.stepping import Laws
from nw_gear_sim.batch.wheels import CHAINS, MOTIONS, TWISTS

TOLERANCE = 1e-3
"""Largest residual force accepted, N."""
MOST_ITERATIONS = 300
BACK = 0.9
STIFFNESS_ADDED = 1e8
LEAST_ADDED, MOST_ADDED = 1e4, 1e14
LEAST_FLEXIBILITY = 1e-16
"""Added to a contact (m/N), so that a rigid ring has a flexibility matrix with an inverse."""

_SIZE = MOTIONS + 4


@dataclass(frozen=True, eq=False)
class Rest:
    """Where the points rest: x (MOTIONS, LANES), m; rotation of the ring's own mode, (LANES,); residual, N, (LANES,).

    Attributes:
        force, sliding, rolling: of the meshes, N, N and N m, (7, LANES).
    """

    x: Array
    rotation: Array
    residual: Array
    force: Array
    sliding: Array
    rolling: Array


@dataclass(frozen=True, eq=False)
class _System:
    """Linear part and contacts, lanes first: stiffness (n, s, s), load (n, s), rows (n, 7, s)."""

    stiffness: Array
    load: Array
    normal: Array
    slide: Array
    roll: Array


def wide(table: Array) -> Array:
    """Return a table read by `lanes.of` as (rows, LANES)."""
    return np.repeat(table[:, None], LANES, axis=1) if table.ndim == 1 else table


def find_rest(laws: Laws, stiffness: Array, error: Array, shares: tuple[Array, Array]) -> Rest:
    """Find the equilibrium of each point, its meshes held at one phase.

    Args:
        laws: of the block.
        stiffness, error: of the meshes, N/m and m, (7, LANES).
        shares: g and g_1 (m) of friction, (7, LANES) each.
    """
    system = _system(laws)
    held = stiffness.T, error.T, laws.mesh.backlash.reshape(7, LANES).T, shares[0].T, shares[1].T
    w, added = np.zeros((LANES, _SIZE)), np.full(LANES, STIFFNESS_ADDED)
    force, matrix, meshes = _forces(laws, system, held, w)
    for _ in range(MOST_ITERATIONS):
        open_lanes = ~(np.max(np.abs(force), axis=1) <= TOLERANCE)
        if not open_lanes.any():
            break
        step = np.linalg.solve(matrix + added[:, None, None] * np.eye(_SIZE), force[..., None])[..., 0]
        step[~open_lanes] = 0.0
        after, after_matrix, after_meshes = _forces(laws, system, held, w + step)
        well = (np.sum(after * step, axis=1) > -BACK * np.sum(force * step, axis=1)) | (added > MOST_ADDED)
        well &= open_lanes
        w[well] += step[well]
        force[well], matrix[well] = after[well], after_matrix[well]
        for kept, new in zip(meshes, after_meshes, strict=True):
            kept[well] = new[well]
        added = np.where(well, added / 10, np.where(open_lanes, 10 * np.maximum(added, LEAST_ADDED), added))
    x = np.ascontiguousarray(w[:, :MOTIONS].T)
    return Rest(x, w[:, MOTIONS].copy(), np.max(np.abs(force), axis=1), *(np.ascontiguousarray(m.T) for m in meshes))


def _system(laws: Laws) -> _System:
    stiffness, load = np.zeros((LANES, _SIZE, _SIZE)), np.zeros((LANES, _SIZE))
    _add_springs(laws, stiffness)
    load[:, :MOTIONS] = laws.wheels.load.reshape(MOTIONS, LANES).T
    normal, slide, roll = (np.zeros((LANES, 7, _SIZE)) for _ in range(3))
    gears = laws.mesh.gears
    tables = [wide(table) for table in (gears.normal, gears.slide, gears.roll)]
    for g, (mesh, turning, moving) in enumerate(zip(gears.mesh, gears.turning, gears.moving, strict=True)):
        columns = [turning, moving, moving + 1, moving + 2]
        normal[:, mesh, columns] += tables[0][4 * g : 4 * g + 4].T
        slide[:, mesh, columns[:3]] += tables[1][3 * g : 3 * g + 3].T
        roll[:, mesh, turning] += tables[2][g]
    _add_ring(laws, _System(stiffness, load, normal, slide, roll))
    return _System(stiffness, load, normal, slide, roll)


def _add_springs(laws: Laws, stiffness: Array) -> None:
    spring = wide(laws.wheels.spring)
    for k in range(3 * CHAINS):
        a, b = k, k + CHAINS
        for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            stiffness[:, i, j] += sign * spring[k]
    aa, ab, bb = (wide(table) for table in (laws.wheels.aa, laws.wheels.ab, laws.wheels.bb))
    for t in range(TWISTS):
        a, b = 4 * CHAINS + t, 4 * CHAINS + TWISTS + t
        for i, j, value in ((a, a, aa), (b, b, bb), (a, b, -ab), (b, a, -ab)):
            stiffness[:, i, j] += value[t]
    still = np.flatnonzero(np.all(wide(laws.wheels.gain) == 0.0, axis=1))
    stiffness[:, still, still] += 1.0


def _add_ring(laws: Laws, system: _System) -> None:
    """Add the ring's rotation (unknown MOTIONS) and the displacements of its contacts (the three after it)."""
    ring, lanes = laws.ring, np.arange(LANES)
    square, (load_re, load_im) = wide(ring.square), ring_load(laws)
    inverse = np.where(square > 0, 1.0 / np.where(square > 0, square, 1.0), 0.0)
    at = _at_contacts(laws, wide(ring.normal_re), wide(ring.normal_im))

    def flexibility(re: Array, im: Array) -> Array:
        """Elongation of contact k by a force along a row of contact j, m/N, (LANES, k, j)."""
        moved = _at_contacts(laws, re * inverse, im * inverse)
        found = np.empty((LANES, 3, 3))
        for k in range(3):
            for j in range(3):
                found[:, k, j] = np.sum(moved[0, :, j] * at[0, :, k] + moved[1, :, j] * at[1, :, k], axis=0)
        return found

    beside, own = laws.mesh.beside.reshape(7, LANES)[0], laws.mesh.flexible.reshape(7, LANES)[0]
    matrix = flexibility(wide(ring.normal_re), wide(ring.normal_im)) + beside[:, None, None]
    stiff = np.linalg.inv(matrix + (own + LEAST_FLEXIBILITY)[:, None, None] * np.eye(3))
    contact = slice(MOTIONS + 1, MOTIONS + 4)
    system.stiffness[:, contact, contact] += stiff
    shift = np.array([np.sum(inverse * (load_re * at[0, :, k] + load_im * at[1, :, k]), axis=0) for k in range(3)])
    system.load[:, contact] += (stiff @ shift.T[..., None])[..., 0]
    system.normal[:, [0, 1, 2], [MOTIONS + 1, MOTIONS + 2, MOTIONS + 3]] = 1.0
    slide, roll = flexibility(wide(ring.slide_re), wide(ring.slide_im)), wide(ring.roll)
    system.slide[:, :3, contact] = np.einsum("ljk,lkm->lmj", stiff, slide)
    system.roll[:, :3, contact] = np.einsum("ljk,lkm->lmj", stiff, flexibility(np.zeros_like(roll), roll))
    free = free_pair(laws)
    for rows, values in ((system.normal, ring.normal_im), (system.slide, ring.slide_im), (system.roll, ring.roll)):
        rows[:, :3, MOTIONS] = wide(values)[free, lanes][:, None]
    system.load[:, MOTIONS] += load_im[free, lanes]


def _at_contacts(laws: Laws, re: Array, im: Array) -> Array:
    """Return rows of the pairs (pairs, LANES) turned to the three contacts: real and imaginary, (2, pairs, 3, LANES).

    In real numbers, since NumPy rounds products of complex ones differently in different places of an array.
    """
    turns = np.where(np.arange(len(re)) < laws.ring.straight, 0.0, 2 * math.pi / 3)[:, None, None]
    cos, sin = np.cos(turns * np.arange(3)[:, None]), np.sin(turns * np.arange(3)[:, None])
    re, im = re[:, None], im[:, None]
    return np.stack([re * cos - im * sin, re * sin + im * cos])


def free_pair(laws: Laws) -> npt.NDArray[np.int64]:
    """Return the pair in which the ring turns freely, (LANES,)."""
    square = wide(laws.ring.square)
    found: npt.NDArray[np.int64] = np.argmin(square + (wide(laws.ring.normal_im) == 0) * np.max(square), axis=0)
    return found


def ring_load(laws: Laws) -> Array:
    """Return the constant forces on the pairs, real and imaginary, (2, pairs, LANES)."""
    ring = laws.ring
    load = np.zeros((2, len(ring.harmonic), LANES))
    gain, decay = wide(ring.gain)[ring.loaded], wide(ring.decay)[ring.loaded]
    back = np.where(gain > 0, decay / np.where(gain > 0, gain, 1.0), 0.0)
    load[:, ring.loaded] = ring.kick.reshape(-1, 2, LANES).swapaxes(0, 1) * back
    return load


def _forces(
    laws: Laws, system: _System, held: tuple[Array, ...], w: Array
) -> tuple[Array, Array, tuple[Array, Array, Array]]:
    """Return forces (n, s), stiffness matrix (n, s, s), and the meshes' force, sliding, rolling (n, 7)."""
    stiffness, error, backlash, share, share_1 = held
    x = np.einsum("lms,ls->lm", system.normal, w) + error
    depth = np.maximum(np.abs(x) - backlash, 0.0)
    side, k = np.sign(x), stiffness * (depth > 0)
    pushed, slid, rolled = stiffness * depth * side, share * stiffness * depth, share_1 * stiffness * depth
    force = system.load - np.einsum("lij,lj->li", system.stiffness, w)
    force += np.einsum("lms,lm->ls", system.slide, slid) + np.einsum("lms,lm->ls", system.roll, rolled)
    force -= np.einsum("lms,lm->ls", system.normal, pushed)
    rubbing = system.slide * share[..., None] + system.roll * share_1[..., None]
    row = system.normal - rubbing * side[..., None]
    matrix = system.stiffness + np.einsum("lms,lm,lmt->lst", row, k, system.normal)
    _add_rollers(laws, w, force, matrix)
    return force, matrix, (pushed, slid, rolled)


def _add_rollers(laws: Laws, w: Array, force: Array, matrix: Array) -> None:
    law = laws.rollers
    cage = laws.cage.start.reshape(-1, LANES)
    rows = [table.reshape(-1, LANES) for table in (law.radial, law.axial, law.clearance, law.radial_force)]
    exponent = 1 + float(law.power.slope[0]) / 2.0**23
    for b, first in enumerate(law.first):
        place = np.arange(first, first + 3)
        radial, axial, clearance, radial_force = (row[b][:, None] for row in rows)
        count = (law.start[b + 1] - law.start[b]) * (2 if law.opposed[b] else 1)
        angle = cage[b][:, None] + 2 * math.pi * np.arange(count) / count
        unit = [np.array([turn(a) for a in angle.flat]).reshape(angle.shape) for turn in (math.cos, math.sin)]
        towards = np.stack([radial * unit[0], radial * unit[1], np.broadcast_to(axial, angle.shape)])
        depth = np.maximum(np.einsum("dlr,ld->lr", towards, w[:, place]) - clearance, 0.0)
        load = radial_force / radial * depth**exponent
        slope = np.where(depth > 0, exponent * load / np.where(depth > 0, depth, 1.0), 0.0)
        pushed, block = np.einsum("dlr,lr->ld", towards, load), np.einsum("dlr,lr,elr->lde", towards, slope, towards)
        for d in range(3):
            force[:, place[d]] -= pushed[:, d]
            for e in range(3):
                matrix[:, place[d], place[e]] += block[:, d, e]
