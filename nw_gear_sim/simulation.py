"""The gearbox in time: from a configuration and drives to sampled motions and forces. No clock, no ROS, no threads."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from nw_gear_common.errors import InputError, NwGearError
from nw_gear_common.tables import Array
from nw_gear_sim import config, model, stepping
from nw_gear_sim.bounds import check_step
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.faults.injection import Injection
from nw_gear_sim.frictiontables import FrictionTables
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.params import Configuration, Numerics
from nw_gear_sim.params.faults import FaultSettings
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.friction import empty_table
from nw_gear_sim.readings import Block, Readings
from nw_gear_sim.solvers import make_solver

STARTS = ("equilibrium", "zero")
EXCITATIONS = ("kinematic", "tied")
INTEGRATORS = ("gautschi", "etdrk4", "rk4")
CHECKPOINT_VERSION = 2
FAULT = "fault."


class Divergence(NwGearError):
    """The integration diverged.

    Attributes:
        time: seconds since the start; state: name of the motion (see `layout`); value: its displacement (m), possibly
            nan or inf; step: number of the time step since the start.
    """

    def __init__(self, time: float, state: str, value: float, step: int) -> None:
        super().__init__(
            f"integration diverged at {time:.6f} s (step {step}): {state} is {value:g} m; "
            "a smaller numerics.step may help"
        )
        self.time = time
        self.state = state
        self.value = value
        self.step = step


class Simulation:
    """Integrates the gearbox with steps of `numerics.step` by the method of `numerics.integrator`.

    Args:
        configuration: of the gearbox.
        drive: at the beginning: speed_start and torque_start count.
        start: `equilibrium`: at rest (besides the rotation) in static equilibrium; `zero`: all displacements and
            velocities zero, as in the paper.
        excitation: `kinematic`: each stage has its own mesh frequency; `tied`: stiffness, errors and friction of all
            meshes run at that of stage II.
        sample_rate: samples per second; a whole number of steps lies between samples.

    Raises:
        InputError: wrong start or excitation, the sample rate doesn't fit the step, or the step is beyond the
            integrator's bound.
        NoEquilibrium: no static equilibrium was found.
    """

    def __init__(
        self,
        configuration: Configuration,
        drive: Drive,
        *,
        start: str = "equilibrium",
        excitation: str = "kinematic",
        sample_rate: float = 5120.0,
    ) -> None:
        if start not in STARTS:
            raise InputError("start", " or ".join(STARTS), start)
        self._prepare(configuration, drive.speed_start, excitation, sample_rate)
        size = self.gearbox.layout.size
        if start == "equilibrium":
            q = find_equilibrium(self.gearbox, drive.torque_start, speed=drive.speed_start).q
        else:
            q = np.zeros(size)
        interval = model.Interval(
            0.0, drive.speed_start, drive.speed_start, drive.torque_start, drive.torque_start, 1 / sample_rate
        )
        self._solver = make_solver(configuration, self.gearbox, self._step, interval, self._table, q)
        most = max(drive.torque_start, configuration.turbine.rated_torque)
        check_step(self._solver, self.gearbox, self._step, most, configuration.turbine.rated_speed)

    @classmethod
    def resume(
        cls,
        configuration: Configuration,
        checkpoint: Mapping[str, Any],
        *,
        excitation: str = "kinematic",
        sample_rate: float = 5120.0,
    ) -> Simulation:
        """Go on from a checkpoint, bit for bit as the simulation that made it would have (on the same machine).

        Args:
            configuration, excitation, sample_rate: as they were.
            checkpoint: of `checkpoint`.

        Raises:
            InputError: the checkpoint is of another kind of simulation; the first difference is named.
        """
        simulation = cls.__new__(cls)
        simulation._prepare(configuration, float(checkpoint["speed"]), excitation, sample_rate)
        simulation._angle = float(checkpoint["angle"])
        simulation._samples = int(checkpoint["samples"])
        rest = np.zeros(simulation.gearbox.layout.size)
        interval = model.Interval(simulation._angle, 0.0, 0.0, 0.0, 0.0, 1 / sample_rate)
        simulation._solver = make_solver(
            configuration, simulation.gearbox, simulation._step, interval, simulation._table, rest
        )
        for name, here in simulation._identity().items():
            if name not in checkpoint or checkpoint[name] != here:
                raise InputError(f"checkpoint: {name}", str(here), str(checkpoint.get(name, "nothing")))
        state = {name.removeprefix("state."): value for name, value in checkpoint.items() if name.startswith("state.")}
        simulation._solver.restore(state)
        faults = {name.removeprefix(FAULT): value for name, value in checkpoint.items() if name.startswith(FAULT)}
        simulation._injection.restore(faults, simulation.time)
        return simulation

    def checkpoint(self) -> dict[str, Any]:
        """Return all that the future depends on: arrays (float64) and plain numbers and texts."""
        state = {f"state.{name}": value for name, value in self._solver.state().items()}
        faults = {FAULT + name: value for name, value in self._injection.state().items()}
        here = {"angle": self._angle, "samples": self._samples, "speed": self._table_speed}
        return {**self._identity(), **here, **state, **faults}

    def _identity(self) -> dict[str, Any]:
        return {
            "version": CHECKPOINT_VERSION,
            "integrator": self._solver.name,
            "step": self._step,
            "sample_rate": self.sample_rate,
            "excitation": self._excitation,
            "degrees_of_freedom": self.gearbox.layout.size,
        }

    def _prepare(self, configuration: Configuration, speed: float, excitation: str, sample_rate: float) -> None:
        if excitation not in EXCITATIONS:
            raise InputError("excitation", " or ".join(EXCITATIONS), excitation)
        self._steps_per_sample = steps_per_sample(configuration.numerics, sample_rate)
        self._step = 1 / (sample_rate * self._steps_per_sample)
        self._excitation = excitation
        self.sample_rate = sample_rate
        self.gearbox = Gearbox(configuration, excitation)
        self._injection = Injection(self.gearbox)
        self._angle = 0.0
        self._samples = 0
        self._readings = Readings(configuration, self.gearbox, sample_rate)
        self._table, self._next_table = empty_table(), empty_table()
        self._table_speed = speed
        self._friction = FrictionTables(self.gearbox.laws.friction)
        self._friction.fill(speed, self._table)

    def state(self) -> dict[str, Array]:
        """Return all that the integrator carries on, as copies: displacements `x` or `q`, and more (see `solvers`)."""
        return self._solver.state()

    def take(self, state: Mapping[str, Array]) -> None:
        """Go on from such a state, of this simulation or of one with the same configuration and drive."""
        self._solver.restore(state)

    @property
    def q(self) -> Array:
        """Displacements now, as in `layout`, m; where the ring is reduced, those of the modes kept."""
        return self._solver.q

    @property
    def v(self) -> Array:
        """Velocities now, as in `layout`, m/s."""
        return self._solver.v

    @property
    def time(self) -> float:
        """Seconds simulated since the start."""
        return self._samples / self.sample_rate

    def inject(self, faults: FaultSettings) -> None:
        """Put faults in from now on; severities go to their new values along a ramp of `fault_ramp` seconds.

        They are brought up to date at the start of every interval.

        Raises:
            InputError: a gear hasn't so many teeth.
        """
        self._injection.change(faults, self.time)

    @property
    def faults(self) -> FaultSettings:
        """What was asked for last."""
        return self._injection.settings

    def fault_names(self) -> list[str]:
        """The kinds of faults that are there now, in words."""
        return self._injection.present(self.time)

    def truth(self) -> dict[str, str]:
        """Return every fault that is there now: where, how much, since when; empty for a sound gearbox."""
        return self._injection.truth(self.time)

    def advance(self, samples: int, drive: Drive) -> Block:
        """Integrate over `samples` samples and return them; the state before the first step is the first of them.

        Speed and torque run linearly over the interval, and the mesh phases are the integral of the speed. Friction is
        interpolated linearly between the speeds at both ends.

        Args:
            samples: at least 1.
            drive: of this interval.

        Raises:
            InputError: less than one sample.
            Divergence: a motion left +-LARGEST_DISPLACEMENT or isn't a number; the simulation is of no use any more.
        """
        if samples < 1:
            raise InputError("samples", "at least 1", str(samples))
        self._fill_tables(drive)
        self._injection.apply(self.time)
        interval = model.Interval(
            self._angle,
            drive.speed_start,
            drive.speed_end,
            drive.torque_start,
            drive.torque_end,
            samples / self.sample_rate,
        )
        course = stepping.new_course(self.gearbox.laws, samples)
        done = self._solver.advance(interval, (self._table, self._next_table), course, self._steps_per_sample)
        lost = self._solver.lost()
        if lost is not None:
            raise self._divergence(done, *lost)
        block = self._readings.block(self._samples, interval, course, self._steps_per_sample)
        self._angle += 0.5 * (drive.speed_start + drive.speed_end) * interval.duration
        self._samples += samples
        self._table, self._next_table = self._next_table, self._table
        self._table_speed = drive.speed_end
        return block

    def _fill_tables(self, drive: Drive) -> None:
        if drive.speed_start != self._table_speed:
            self._friction.fill(drive.speed_start, self._table)
        if drive.speed_end == drive.speed_start:
            self._next_table[:] = self._table
        else:
            self._friction.fill(drive.speed_end, self._next_table)

    def _divergence(self, done: int, state: str, value: float) -> Divergence:
        step = self._samples * self._steps_per_sample + done
        return Divergence(step * self._step, state, value, step)


def steps_per_sample(numerics: Numerics, sample_rate: float) -> int:
    """Return how many steps lie between samples (`sample_rate` Hz).

    A rate that is a multiple of that of the integrator's own steps makes the steps shorter; steps that are given aren't
    changed.

    Raises:
        InputError: not a whole number of them.
    """
    if not (math.isfinite(sample_rate) and sample_rate > 0):
        raise InputError("sample_rate", "a rate above 0 Hz", f"{sample_rate:g} Hz")
    step = numerics.time_step
    ratio = 1.0 / (step * sample_rate)
    if numerics.step is None and ratio < 1.0 and _whole(1.0 / ratio):
        return 1
    if round(ratio) < 1 or not _whole(ratio):
        raise InputError("sample_rate", f"1 / ({step:g} s) divided by a whole number", f"{sample_rate:g} Hz")
    return round(ratio)


def _whole(ratio: float) -> bool:
    return abs(ratio - round(ratio)) <= 1e-9 * ratio


def compile_kernels(*integrators: str) -> None:
    """Compile everything that `Simulation` calls, or load it from numba's cache, so that later calls don't wait.

    Args:
        integrators: those that will be used; all if none is named.
    """
    drive = Drive(1.8, 1.8, 4e6, 4e6)
    for integrator in integrators or INTEGRATORS:
        configuration = config.with_values({"numerics.integrator": integrator}, config.load())
        simulation = Simulation(configuration, drive, start="zero")
        simulation.advance(1, drive)
    simulation.gearbox.set_instant(drive.torque_start, drive.speed_start)
    simulation.gearbox.forces(simulation.q, simulation.v)
    simulation.gearbox.stiffness(simulation.q)
