"""A gearbox ready to be evaluated: its laws, their memory, and forces at a chosen time. Studies and tests use this."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim import model
from nw_gear_sim.assembly import assemble, masses
from nw_gear_sim.kinematics import derive
from nw_gear_sim.model import Interval
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.friction import empty_table, fill_table
from nw_gear_sim.physics.mesh import Contact

DIFFERENCE = 1e-9
"""Step of difference quotients, m."""


class Gearbox:
    """The right-hand side with its memory.

    Args:
        configuration: of the gearbox.
        excitation: `kinematic` or `tied`.
    """

    def __init__(self, configuration: Configuration, excitation: str = "kinematic") -> None:
        self.kinematics = derive(configuration)
        self.bearings = configuration.bearings
        self.laws, self.layout = assemble(configuration, excitation)
        self.mass = masses(configuration, self.kinematics, self.layout)
        self.instants = model.new_instants(self.laws)
        self.work = model.new_work(self.laws)
        self._table = empty_table()

    def set_instant(self, torque: float, speed: float, angle: float = 0.0, *, static: bool = False) -> None:
        """Set the time at which forces are evaluated.

        Args:
            torque: input torque, N m.
            speed, angle: of the ring, rad/s and rad.
            static: keep phases and friction, but leave out everything that moves with the speed.
        """
        fill_table(self.laws.friction, speed, self._table)
        interval = Interval(angle, speed, speed, torque, torque, 1.0)
        model.set_slot(self.laws, self._table, self._table, interval, 0.0, self.instants, 0)
        if static:
            self.instants.excitation[0, :, 2] = 0.0
            self.instants.rows[0].drift[:] = 0.0

    def forces(self, q: Array, v: Array) -> Array:
        """Return the generalised forces (N) at displacements q (m) and velocities v (m/s), shape (dof,)."""
        out = np.empty(self.layout.size)
        model.forces(self.laws, self.instants, 0, q, v, self.work, out)
        return out

    def stiffness(self, q: Array, step: float = DIFFERENCE) -> Array:
        """Return the stiffness matrix -d(forces)/dq (N/m) at q (m), at rest, by central differences of `step` (m)."""
        return self._difference(q, np.zeros_like(q), step, False)

    def damping(self, q: Array, step: float = 1.0) -> Array:
        """Return the damping matrix -d(forces)/dv (N s/m) at q (m), at rest, by differences of `step` (m/s)."""
        return self._difference(q, np.zeros_like(q), step, True)

    def _difference(self, q: Array, v: Array, step: float, by_velocity: bool) -> Array:
        matrix = np.empty((len(q), len(q)))
        model.difference(self.laws, self.instants, 0, q.copy(), v, self.work, step, by_velocity, matrix)
        return matrix

    @property
    def contact(self) -> Contact:
        """The meshes as the last call of `forces` found them; the arrays are overwritten by the next."""
        return self.work.contact

    @property
    def housing(self) -> Array:
        """Forces on the bearings' housings (N), (bearings, 3), as the last call of `forces` found them."""
        return self.work.housing
