"""States from which a block of points starts: at rest in static equilibrium."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.batch.blocks import copy_state, new_state, new_work
from nw_gear_sim.batch.lanes import LANES
from nw_gear_sim.batch.meshes import elongate, load_meshes, look_up_friction
from nw_gear_sim.batch.rest import Rest, find_rest, free_pair, ring_load, wide
from nw_gear_sim.batch.ringstep import contact_sums, share_out
from nw_gear_sim.batch.stepping import Laws, State, move, set_phases


def resting_state(laws: Laws) -> tuple[State, Array]:
    """Return a block at rest in static equilibrium at step 0, and the residual forces, N, (LANES,).

    The parts rest in their own frames: the ring's deformation turns with it at first, as in `Simulation`.
    """
    state = new_state(laws)
    set_phases(laws.psi, 0, state.psi)
    look_up_friction(laws.mesh, 0.0, state.mesh)
    mesh = laws.mesh
    stiffness = (mesh.stiffness + mesh.swing * state.psi[: 7 * LANES]).reshape(7, LANES)
    error = (mesh.error_mean + mesh.error_swing * state.psi[7 * LANES :]).reshape(7, LANES)
    shares = state.mesh.sliding.reshape(7, LANES).copy(), state.mesh.rolling.reshape(7, LANES).copy()
    rest = find_rest(laws, stiffness, error, shares)
    state.x[:] = rest.x.ravel()
    state.led[:] = state.x
    state.mesh.force[:] = rest.force.ravel()
    state.z.reshape(-1, 4, LANES)[:, :2] = _ring_at_rest(laws, rest)
    begin(laws, state)
    return state, rest.residual


def _ring_at_rest(laws: Laws, rest: Rest) -> Array:
    """Return Z of the pairs under the meshes' forces, (pairs, 2, LANES)."""
    ring, shares = laws.ring, np.zeros(9 * LANES)
    share_out(rest.force.ravel(), rest.sliding.ravel(), rest.rolling.ravel(), shares)
    f, f_1, f_i, g, g_1, g_i, r, r_1, r_i = shares.reshape(9, LANES)
    straight = (np.arange(len(ring.harmonic)) < ring.straight)[:, None]
    pushed, slid, rolled = np.where(straight, f, f_1), np.where(straight, g, g_1), np.where(straight, r, r_1)
    pushed_i, slid_i, rolled_i = (np.where(straight, 0.0, part) for part in (f_i, g_i, r_i))
    nr, ni, sr, si = (wide(row) for row in (ring.normal_re, ring.normal_im, ring.slide_re, ring.slide_im))
    roll, square, load = wide(ring.roll), wide(ring.square), ring_load(laws)
    re = load[0] - nr * pushed + ni * pushed_i + sr * slid - si * slid_i - roll * rolled_i
    im = load[1] - nr * pushed_i - ni * pushed + sr * slid_i + si * slid + roll * rolled
    z = np.where(square > 0, np.stack([re, im]) / np.where(square > 0, square, 1.0), 0.0)
    z[:, free_pair(laws), np.arange(LANES)] = np.stack([np.zeros(LANES), rest.rotation])
    return z.swapaxes(0, 1)


def begin(laws: Laws, state: State) -> None:
    """Set up the first step from displacements at rest: x(-h) = x(0) + h^2 a / 2."""
    ring, mesh = laws.ring, state.mesh
    set_phases(laws.psi, 0, state.psi)
    set_phases(laws.cage, 0, state.cage)
    pairs = state.z.reshape(-1, 4, LANES)
    here = _elongation(laws, state, state.x, pairs[:, 0], pairs[:, 1])
    ahead, behind = (_elongation(laws, state, state.x, *_turned(laws, pairs[:, :2], sign)) for sign in (1.0, -1.0))
    mesh.y[:] = here
    mesh.moved[:] = mesh.before[:] = 0.5 * (ahead - behind)
    trial, work = copy_state(state), new_work()
    load_meshes(laws.mesh, 0.0, trial.psi, trial.mesh)
    move(laws, trial, work)
    decay = wide(laws.wheels.decay).ravel()
    state.moved[:] = np.where(decay > 0, -0.5 * trial.moved / np.where(decay > 0, decay, 1.0), 0.0)
    decay = wide(ring.decay)
    back = np.stack(_turned(laws, trial.z.reshape(-1, 4, LANES)[:, 2:], -1.0))
    back = np.where(decay > 0, -0.5 * back / np.where(decay > 0, decay, 1.0), 0.0)
    pairs[:, 2], pairs[:, 3] = back
    earlier = _turned(laws, pairs[:, :2] - pairs[:, 2:], -1.0)
    last = _elongation(laws, state, state.x - state.moved, *earlier)
    rate = mesh.moved.copy()
    mesh.moved[:] = here - last
    mesh.before[:] = 3.0 * mesh.moved - 2.0 * rate


def _turned(laws: Laws, pairs: Array, sign: float) -> tuple[Array, Array]:
    """Turn pairs (pairs, 2, LANES) with the ring by one step, or back where sign is -1; real and imaginary part."""
    turn = laws.ring.turn.reshape(-1, 2, LANES)[laws.ring.harmonic]
    cos, sin = turn[:, 0], sign * turn[:, 1]
    return cos * pairs[:, 0] - sin * pairs[:, 1], sin * pairs[:, 0] + cos * pairs[:, 1]


def _elongation(laws: Laws, state: State, x: Array, zr: Array, zi: Array) -> Array:
    """Return y of the meshes, flat (7, LANES), for displacements x and a Z of the ring, (pairs, LANES)."""
    sums, y = np.zeros(3 * LANES), np.zeros(7 * LANES)
    contact_sums(laws.ring, np.ascontiguousarray(zr), np.ascontiguousarray(zi), sums)
    elongate(laws.mesh, x, sums, y, state.mesh.force)
    return y
