"""The compiled right-hand side as an initial value problem of the first order, as scipy wants it."""

from __future__ import annotations

import functools
from typing import Any

import numba
import numba.typed
import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim import model
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.kinematics import derive
from nw_gear_sim.modal.ring import rigid_ring_modes
from nw_gear_sim.model import Interval
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.friction import empty_table, fill_table


class Problem:
    """A gearbox at constant speed and torque, from its static equilibrium on.

    The state is (z, dz/dt). With a flexible ring z is the displacements as in `layout`, m; with a rigid one the first
    four are its motions, sqrt(kg) m, and the forces of the whole model are projected on them.

    Args:
        configuration: of the gearbox at its fixed operating point.
        excitation: `kinematic` or `tied`; ring: `flexible` or `rigid`.

    Attributes:
        start: state at the beginning.
    """

    def __init__(self, configuration: Configuration, excitation: str = "kinematic", ring: str = "flexible") -> None:
        gearbox, fixed = Gearbox(configuration, excitation), derive(configuration)
        laws, size, count = gearbox.laws, gearbox.layout.size, 4 * gearbox.layout.segments
        q = find_equilibrium(gearbox, fixed.input_torque, speed=fixed.ring_speed).q
        shapes = np.zeros((count, 0))
        self._inverse_mass = laws.inverse_mass
        z = q
        if ring == "rigid":
            mass, engagement = gearbox.mass[:count], laws.engagement
            shapes = rigid_ring_modes(laws.ring, mass, engagement.radius, engagement.base_radius).shapes
            z = np.concatenate([shapes.T @ (mass * q[:count]), q[count:]])
            self._inverse_mass = np.concatenate([np.ones(4), laws.inverse_mass[count:]])
        table = empty_table()
        fill_table(laws.friction, fixed.ring_speed, table)
        interval = Interval(0.0, fixed.ring_speed, fixed.ring_speed, fixed.input_torque, fixed.input_torque, 1.0)
        # A list of one tuple: handed over as an argument, its hundred arrays would cost more than the call.
        parts = (laws, table, interval, gearbox.instants, gearbox.work, shapes, np.zeros((3, size)), self._inverse_mass)
        self._box = numba.typed.List([parts])
        self._evaluate, self._out = _compiled(), np.zeros(2 * len(z))
        self._gearbox = gearbox
        self.start = np.concatenate([z, np.zeros(len(z))])

    def slope(self, moment: float, state: Array) -> Array:
        """Return the time derivative of a state at a moment (s)."""
        self._evaluate(self._box, moment, state, self._out)
        return self._out.copy()

    def elongation(self, moment: float, state: Array) -> Array:
        """Return x_n of the seven meshes, m."""
        self._evaluate(self._box, moment, state, self._out)
        return self._gearbox.contact.x.copy()


@functools.cache
def _compiled() -> Any:
    @numba.njit(nogil=True)
    def evaluate(box: Any, moment: float, state: Array, out: Array) -> None:
        laws, table, interval, instants, work, shapes, whole, inverse_mass = box[0]
        size, (count, kept) = len(inverse_mass), shapes.shape
        model.set_slot(laws, table, table, interval, moment, instants, 0)
        if kept == 0:
            model.forces(laws, instants, 0, state[:size], state[size:], work, out[size:])
        else:
            q, v, force = whole[0], whole[1], whole[2]
            for i in range(count):
                q[i] = v[i] = 0.0
                for k in range(kept):
                    q[i] += shapes[i, k] * state[k]
                    v[i] += shapes[i, k] * state[size + k]
            q[count:] = state[kept:size]
            v[count:] = state[size + kept :]
            model.forces(laws, instants, 0, q, v, work, force)
            for k in range(kept):
                out[size + k] = 0.0
                for i in range(count):
                    out[size + k] += shapes[i, k] * force[i]
            out[size + kept :] = force[count:]
        for i in range(size):
            out[i] = state[size + i]
            out[size + i] *= inverse_mass[i]

    return evaluate
