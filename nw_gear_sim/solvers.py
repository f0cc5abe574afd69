"""The equations of motion with an integrator: states that go on over an interval. One class for each integrator."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim import model, stepping
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.integrator import etdrk4, gautschi
from nw_gear_sim.modal import forces as modal_forces
from nw_gear_sim.modal import stepping as modal_stepping
from nw_gear_sim.modal.laws import choose_modes
from nw_gear_sim.params import Configuration

LARGEST_DISPLACEMENT = 0.1
"""A displacement beyond this (m) means that the integration has diverged; vibrations stay below a millimetre."""


SETTLING = 4
"""Evaluations after which the planets' influence on each other through the modes left out has settled."""
DIFFERENCE, RATE_DIFFERENCE = 1e-9, 1.0
"""Steps of difference quotients in displacements (m) and in velocities (m/s; the forces are linear in them)."""


class Solver(Protocol):
    """State of the motions and the way it goes on; `name` as in `numerics.integrator`."""

    @property
    def name(self) -> str:
        """Name of the integrator."""

    @property
    def q(self) -> Array:
        """Displacements as in `layout`, m."""

    @property
    def v(self) -> Array:
        """Velocities as in `layout`, m/s."""

    def advance(
        self, interval: model.Interval, tables: tuple[Array, Array], course: stepping.Course, steps_per_sample: int
    ) -> int:
        """Integrate over an interval between two friction tables and record; return the steps done."""

    def lost(self) -> tuple[str, float] | None:
        """Return the motion that has diverged and its displacement (m), if any."""

    def state(self) -> dict[str, Array]:
        """Return all that the future depends on, as copies."""

    def restore(self, state: Mapping[str, Any]) -> None:
        """Take over what `state` returned."""


class Method(Protocol):
    """What all integrators for oscillators offer, as functions of their modules."""

    def coefficients(self, square: Array, damping: Array, step: float) -> Any:
        """Prepare oscillators for a step."""

    def step_matrix(self, c: Any, stiffness: Array, damping: Array) -> Array:
        """Return the matrix of a step under linear forces."""


def make_solver(
    configuration: Configuration, gearbox: Gearbox, step: float, interval: model.Interval, table: Array, q: Array
) -> Solver:
    """Return the solver that a configuration asks for, at rest at displacements q (m).

    Args:
        configuration: its numerics choose.
        gearbox: the whole model.
        step: of time, s.
        interval: drive at the start; table: friction there.
        q: displacements as in `layout`, m.
    """
    numerics = configuration.numerics
    if numerics.integrator == "rk4":
        return RungeKutta(gearbox, q)
    if numerics.integrator == "etdrk4":
        return Exponential(gearbox, step, rigid=numerics.ring == "rigid", q=q)
    return Gautschi(configuration, gearbox, step, interval, table, q)


class RungeKutta:
    """All motions as they are, by the classical Runge-Kutta method."""

    name = "rk4"

    def __init__(self, gearbox: Gearbox, q: Array) -> None:
        self._gearbox = gearbox
        self.q = q.copy()
        self.v = np.zeros_like(q)

    def advance(
        self, interval: model.Interval, tables: tuple[Array, Array], course: stepping.Course, steps_per_sample: int
    ) -> int:
        """Integrate over an interval."""
        gearbox = self._gearbox
        return int(
            stepping.advance(
                gearbox.laws,
                *tables,
                interval,
                steps_per_sample,
                LARGEST_DISPLACEMENT,
                self.q,
                self.v,
                gearbox.instants,
                gearbox.work,
                course,
            )
        )

    def lost(self) -> tuple[str, float] | None:
        """Return the motion that has diverged."""
        k = int(stepping.out_of_bounds(self.q, LARGEST_DISPLACEMENT))
        return None if k < 0 else (self._gearbox.layout.name(k), float(self.q[k]))

    def state(self) -> dict[str, Array]:
        """Return q and v."""
        return {"q": self.q.copy(), "v": self.v.copy()}

    def restore(self, state: Mapping[str, Any]) -> None:
        """Take over q and v."""
        self.q[:], self.v[:] = state["q"], state["v"]


class Modal:
    """What the solvers with the ring in modes have in common: coordinates x of the modes and the other motions.

    Attributes:
        laws: of the gearbox; instants, work: memory.
        method: the integrator's module, with `coefficients` and `step_matrix`.
    """

    method: Method

    def __init__(self, gearbox: Gearbox, bandwidth: float, *, rigid: bool, coupled: bool, q: Array) -> None:
        self._gearbox = gearbox
        self.laws, self._ring = choose_modes(gearbox, bandwidth, rigid=rigid, coupled=coupled)
        self._count = 4 * gearbox.layout.segments
        self.instants = modal_forces.new_instants(self.laws)
        self.work = modal_forces.new_work(self.laws)
        self.x = self._reduced(q)

    def _reduced(self, q: Array) -> Array:
        modes = self._ring.shapes.T @ (self._gearbox.mass[: self._count] * q[: self._count])
        return np.concatenate([modes, q[self._count :]])

    def _whole(self, x: Array) -> Array:
        modes = len(self._ring.square)
        return np.concatenate([self._ring.shapes @ x[:modes], x[modes:]])

    @property
    def q(self) -> Array:
        """Displacements, of the ring by the modes kept."""
        return self._whole(self.x)

    def lost(self) -> tuple[str, float] | None:
        """Return the motion that has diverged."""
        k = int(modal_stepping.lost(self.laws.reach, self.x, LARGEST_DISPLACEMENT))
        if k < 0:
            return None
        modes = len(self._ring.square)
        if k >= modes:
            return self._gearbox.layout.name(k - modes + self._count), float(self.x[k])
        frequency = math.sqrt(self._ring.square[k]) / (2 * math.pi)
        return f"ring mode {k} ({frequency:.0f} Hz)", float(self.x[k] / self.laws.reach[k])

    def stiffest_tangent(self, q: Array) -> tuple[Array, Array]:
        """Return -d(forces per mass)/dx (1/s^2) and /dv (1/s) about q (m) with the stiffest meshes, each (n, n)."""
        instants, law = modal_forces.new_instants(self.laws), self.laws.mesh
        instants.excitation[0, :, 0] = law.stiffness + np.hypot(law.stiffness_cos, law.stiffness_sin)
        instants.soft[0, :, 0] = 1 / (1 + instants.excitation[0, :3, 0] * self.laws.table.flexibility[0].mean())
        instants.turn[0, 0] = 1.0
        instants.cage[0, :, 0] = 1.0
        x = self._reduced(q)
        matrices = np.empty((2, len(x), len(x)))
        gain = DIFFERENCE * self.laws.reach
        work = modal_forces.new_work(self.laws)
        modal_stepping.difference(self.laws, instants, x, np.zeros_like(x), work, gain, RATE_DIFFERENCE, matrices)
        return matrices[0], matrices[1]


class Gautschi(Modal):
    """Ring modes up to a bandwidth, by the method of Gautschi."""

    name = "gautschi"
    method = gautschi

    def __init__(
        self,
        configuration: Configuration,
        gearbox: Gearbox,
        step: float,
        interval: model.Interval,
        table: Array,
        q: Array,
    ) -> None:
        numerics = configuration.numerics
        super().__init__(gearbox, numerics.ring_bandwidth, rigid=numerics.ring == "rigid", coupled=False, q=q)
        self.oscillators = gautschi.coefficients(self.laws.square, self.laws.damping, step)
        rest, pushed = np.zeros_like(self.x), np.zeros_like(self.x)
        for _ in range(SETTLING):
            modal_stepping.evaluate(self.laws, table, table, interval, self.x, rest, self.instants, self.work, pushed)
        self._torque = interval.torque_start
        self.u, self.before = np.zeros_like(self.x), np.zeros_like(self.x)
        gautschi.start(self.x, rest, pushed - self.laws.square * self.x, step, self.u, self.before)

    @property
    def v(self) -> Array:
        """Velocities, extrapolated from the steps before."""
        return self._whole(1.5 * self.u - 0.5 * self.before)

    def advance(
        self, interval: model.Interval, tables: tuple[Array, Array], course: stepping.Course, steps_per_sample: int
    ) -> int:
        """Integrate over an interval."""
        before, self._torque = self._torque, interval.torque_end
        return int(
            modal_stepping.advance_gautschi(
                self.laws,
                self.oscillators,
                *tables,
                interval,
                before,
                steps_per_sample,
                LARGEST_DISPLACEMENT,
                self.x,
                self.u,
                self.before,
                self.instants,
                self.work,
                course,
            )
        )

    def state(self) -> dict[str, Array]:
        """Return coordinates, last two differences and torque, and the forces by which planets feel each other."""
        return {
            "x": self.x.copy(),
            "u": self.u.copy(),
            "before": self.before.copy(),
            "torque": np.array(self._torque),
            "force": self.work.contact.force.copy(),
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Take over what `state` returned."""
        self.x[:], self.u[:], self.before[:] = state["x"], state["u"], state["before"]
        self._torque = float(state["torque"])
        self.work.contact.force[:] = state["force"]


class Exponential(Modal):
    """All ring modes, by the exponential Runge-Kutta method."""

    name = "etdrk4"
    method = etdrk4

    def __init__(self, gearbox: Gearbox, step: float, *, rigid: bool, q: Array) -> None:
        super().__init__(gearbox, math.inf, rigid=rigid, coupled=True, q=q)
        self.oscillators = etdrk4.coefficients(self.laws.square, self.laws.damping, step)
        self._speed = np.zeros_like(self.x)

    @property
    def v(self) -> Array:
        """Velocities."""
        return self._whole(self._speed)

    def advance(
        self, interval: model.Interval, tables: tuple[Array, Array], course: stepping.Course, steps_per_sample: int
    ) -> int:
        """Integrate over an interval."""
        return int(
            modal_stepping.advance_etdrk4(
                self.laws,
                self.oscillators,
                *tables,
                interval,
                steps_per_sample,
                LARGEST_DISPLACEMENT,
                self.x,
                self._speed,
                self.instants,
                self.work,
                course,
            )
        )

    def state(self) -> dict[str, Array]:
        """Return coordinates and velocities."""
        return {"x": self.x.copy(), "v": self._speed.copy()}

    def restore(self, state: Mapping[str, Any]) -> None:
        """Take over what `state` returned."""
        self.x[:], self._speed[:] = state["x"], state["v"]
