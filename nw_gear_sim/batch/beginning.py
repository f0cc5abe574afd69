"""States from which a block of points starts: at rest in static equilibrium."""

from __future__ import annotations

import math

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.batch.blocks import copy_state, new_state, new_work
from nw_gear_sim.batch.lanes import LANES
from nw_gear_sim.batch.meshes import elongate, load_meshes, look_up_friction
from nw_gear_sim.batch.rest import Rest, find_rest, ring_rows, wide
from nw_gear_sim.batch.ringstep import contact_sums
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
    r, s, rolled, square, load = ring_rows(laws)
    class_1 = (np.arange(len(r)) >= laws.ring.straight).astype(float)
    towards = np.exp(2j * math.pi / 3 * np.outer(class_1, np.arange(3)))
    pushed, slid, rolling = (towards @ part[:3] for part in (rest.force, rest.sliding, rest.rolling))
    force = load - r * pushed + s * slid + 1j * rolled * rolling
    held = square > 0
    z = np.where(held, force / np.where(held, square, 1.0), 0.0)
    free = np.argmin(square + (r.imag == 0) * np.max(square), axis=0)
    z[free, np.arange(LANES)] = 1j * rest.rotation
    return np.stack([z.real, z.imag], axis=1)


def begin(laws: Laws, state: State) -> None:
    """Set up the first step from displacements at rest: x(-h) = x(0) + h^2 a / 2."""
    ring, mesh = laws.ring, state.mesh
    set_phases(laws.psi, 0, state.psi)
    set_phases(laws.cage, 0, state.cage)
    pairs = state.z.reshape(-1, 4, LANES)
    turn = ring.turn.reshape(-1, 2, LANES)
    unit = (turn[:, 0] + 1j * turn[:, 1])[ring.harmonic]
    here, ahead, behind = (_elongation(laws, state, state.x, _complex(pairs) * unit**k) for k in (0, 1, -1))
    mesh.y[:] = here
    mesh.moved[:] = mesh.before[:] = 0.5 * (ahead - behind)
    trial, work = copy_state(state), new_work()
    load_meshes(laws.mesh, 0.0, trial.psi, trial.mesh)
    move(laws, trial, work)
    decay = wide(laws.wheels.decay).ravel()
    state.moved[:] = np.where(decay > 0, -0.5 * trial.moved / np.where(decay > 0, decay, 1.0), 0.0)
    last = trial.z.reshape(-1, 4, LANES)
    decay = wide(ring.decay)
    back = -0.5 * (last[:, 2] + 1j * last[:, 3]) / unit / np.where(decay > 0, decay, 1.0)
    pairs[:, 2], pairs[:, 3] = np.where(decay > 0, back.real, 0.0), np.where(decay > 0, back.imag, 0.0)
    earlier = _elongation(laws, state, state.x - state.moved, (_complex(pairs) - back) / unit)
    rate = mesh.moved.copy()
    mesh.moved[:] = here - earlier
    mesh.before[:] = 3.0 * mesh.moved - 2.0 * rate


def _complex(pairs: Array) -> Array:
    z: Array = pairs[:, 0] + 1j * pairs[:, 1]
    return z


def _elongation(laws: Laws, state: State, x: Array, z: Array) -> Array:
    """Return y of the meshes, flat (7, LANES), for displacements x and a Z of the ring, (pairs, LANES)."""
    sums, y = np.zeros(3 * LANES), np.zeros(7 * LANES)
    contact_sums(laws.ring, np.ascontiguousarray(z.real), np.ascontiguousarray(z.imag), sums)
    elongate(laws.mesh, x, sums, y, state.mesh.force)
    return y
