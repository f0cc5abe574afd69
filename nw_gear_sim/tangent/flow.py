"""A gearbox at a fixed operating point with deviations from its motion, carried by the variational equations."""

from __future__ import annotations

import math

import numpy as np
import scipy.linalg

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim import config, model, stepping
from nw_gear_sim.bounds import check_step
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.frictiontables import FrictionTables
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.friction import empty_table
from nw_gear_sim.simulation import EXCITATIONS, Divergence
from nw_gear_sim.solvers import LARGEST_DISPLACEMENT, Exponential
from nw_gear_sim.tangent import kernels
from nw_gear_sim.tangent.slope import new_slope, repeated

RINGS = ("flexible", "rigid")
CHUNK = 4096
"""Steps between looks at the state while it settles."""


class Flow:
    """Motion and deviations, by the exponential Runge-Kutta method with every mode of the ring.

    A deviation is a column of displacements and velocities, each times the root of its mass, the displacements also
    times the rate of the mesh of stage II, so that its square is an energy; (2 n, count). Speed and torque are
    constant; the phase of the excitation isn't part of the state.

    Args:
        configuration: of the gearbox; speed and load are its operating point, faults it has none.
        count: deviations.
        excitation: `kinematic` or `tied`; ring: `flexible` or `rigid`.
        step: of time, s; None: that of the integrator.

    Raises:
        InputError: a wrong word or number, or a step beyond the integrator's bound.
        NoEquilibrium: no static equilibrium was found.
    """

    def __init__(
        self,
        configuration: Configuration,
        count: int,
        *,
        excitation: str = "kinematic",
        ring: str = "rigid",
        step: float | None = None,
    ) -> None:
        for place, value, known in (("excitation", excitation, EXCITATIONS), ("ring", ring, RINGS)):
            if value not in known:
                raise InputError(place, " or ".join(known), value)
        changed = {"numerics.integrator": "etdrk4", "numerics.ring": ring, "numerics.step": step}
        self.step = config.with_values(changed, configuration).numerics.time_step
        self._gearbox = Gearbox(configuration, excitation)
        kinematics = self._gearbox.kinematics
        self.speed, torque = kinematics.ring_speed, kinematics.input_torque
        self._interval = model.Interval(0.0, self.speed, self.speed, torque, torque, self.step)
        q = find_equilibrium(self._gearbox, torque, speed=self.speed).q
        self._solver = Exponential(self._gearbox, self.step, rigid=ring == "rigid", q=q)
        largest = max(torque, configuration.turbine.rated_torque)
        check_step(self._solver, self._gearbox, self.step, largest, configuration.turbine.rated_speed)
        laws = self._solver.laws
        self._laws = laws._replace(first=np.ascontiguousarray(laws.first), second=np.ascontiguousarray(laws.second))
        self._rest = q
        self._table = empty_table()
        FrictionTables(laws.friction).fill(self.speed, self._table)
        self._steps = 0
        size = len(laws.weight)
        if not 1 <= count <= 2 * size:
            raise InputError("count", f"1 to {2 * size}", str(count))
        self.rate = 2 * math.pi * self.mesh_frequency("II") if self.speed > 0.0 else 1.0
        weight = 1 / np.sqrt(laws.inverse_mass)
        self._weight = np.stack([self.rate * weight, weight])[:, :, None]
        self._slope = new_slope(laws, count)
        own = self._solver.oscillators
        self._oscillators = (own, repeated(own, count))

    @property
    def count(self) -> int:
        """Deviations carried."""
        return int(self._slope.reach.shape[1])

    @property
    def size(self) -> int:
        """Displacements and velocities: 2 n, those that only fill up the modes not counted."""
        return 2 * int(np.count_nonzero(self._alive()))

    @property
    def time(self) -> float:
        """Seconds since the start."""
        return self._steps * self.step

    @property
    def state(self) -> tuple[Array, Array]:
        """Coordinates of the motions, ring modes first, and their rates; copies."""
        return self._solver.state()["x"], self._solver.state()["v"]

    def mesh_frequency(self, stage: str) -> float:
        """Return the mesh frequency of a stage, Hz."""
        return float(self._gearbox.kinematics.mesh_frequency_hz(stage, self.speed))

    def beginning(self, seed: int = 0) -> Array:
        """Return random orthonormal deviations, (2 n, count); modes that only fill up don't take part."""
        random = np.random.default_rng(seed).standard_normal((2 * len(self._laws.weight), self.count))
        random[np.tile(np.logical_not(self._alive()), 2)] = 0.0
        return np.asarray(np.linalg.qr(random)[0])

    def settle(self, seconds: float) -> None:
        """Integrate the motion alone over a time, s, rounded to whole steps.

        Raises:
            Divergence: a motion left the bounds or isn't a number.
        """
        left = round(seconds / self.step)
        tables = (self._table, self._table)
        while left > 0:
            steps = min(left, CHUNK)
            course = stepping.new_course(self._gearbox.laws, 1)
            self._solver.advance(self._over(steps), tables, course, steps)
            self._went_on(steps)
            left -= steps

    def carry(self, deviations: Array, steps: int) -> tuple[Array, float]:
        """Integrate motion and deviations over some steps.

        Returns:
            the deviations at the end, (2 n, count), and the mean divergence of the flow on the way, 1/s.

        Raises:
            Divergence: a motion left the bounds or isn't a number.
        """
        slope, state = self._slope, self._solver.state()
        slope.here[:] = deviations.reshape(slope.here.shape) / self._weight
        slope.divergence[0] = 0.0
        kernels.advance(
            self._laws, self._oscillators, self._table, self._over(steps), steps, LARGEST_DISPLACEMENT,
            state["x"], state["v"], self._solver.instants, self._solver.work, slope,
        )  # fmt: skip
        self._solver.restore(state)
        self._went_on(steps)
        return (slope.here * self._weight).reshape(deviations.shape), float(slope.divergence[0]) / steps

    def slowest(self) -> Array:
        """Return the real parts of the eigenvalues of the gearbox at rest with its stiffest meshes, descending, 1/s."""
        stiffness, damping = self._solver.stiffest_tangent(self._rest)
        one, none = np.eye(len(stiffness)), np.zeros_like(stiffness)
        stiffness += np.diag(self._laws.square)
        damping += np.diag(self._laws.damping)
        system = np.block([[none, self.rate * one], [-stiffness / self.rate, -damping]])
        found = scipy.linalg.eigvals(system, check_finite=False, overwrite_a=True).real
        return np.asarray(np.sort(found)[::-1])

    def _alive(self) -> Array:
        alive = np.ones(len(self._laws.weight), dtype=bool)
        alive[: len(self._laws.turn)] = np.any(self._laws.table.normal != 0.0, axis=0)
        return alive

    def _over(self, steps: int) -> model.Interval:
        angle = self.speed * self.time
        return self._interval._replace(angle=angle, duration=steps * self.step)

    def _went_on(self, steps: int) -> None:
        lost = self._solver.lost()
        if lost is not None:
            raise Divergence(self.time, *lost, self._steps)
        self._steps += steps
