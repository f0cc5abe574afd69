"""The running gearbox: state, ring angle and time. No clock, no ROS, no threads."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError, NwGearError
from nw_gear_common.tables import Array
from nw_gear_sim import config, kinematics
from nw_gear_sim.dynamics import constants, equilibrium, friction, layout, stepping
from nw_gear_sim.dynamics.model import BEARING, FORCE, V, X
from nw_gear_sim.params import Configuration

from nw_gear_sim.physics.drive import Drive

_LIMIT = 1e-9
"""How far steps per sample may be from a whole number."""
_FRICTION_CHANGE = 1e-3
"""Friction tables are made anew when the speed has changed by this share of the rated speed."""
_FADE_SPEED = 5e-3
"""Share of the rated speed below which tooth friction fades."""


class Divergence(NwGearError):
    """The integration left the finite numbers."""

    def __init__(self, time: float, state: str, value: float, step: float) -> None:
        super().__init__(
            f"integration diverged at {time:.6f} s of simulated time: {state} is {value:g} "
            f"(step {step:.6g} s; a smaller numerics.step may help)"
        )
        self.time, self.state, self.value, self.step = time, state, value, step


@dataclass(frozen=True)
class Block:
    """Samples of one call of `Simulation.advance`; n rows, SI units.

    Attributes:
        time: since the start, (n,).
        phase: unwrapped mesh phases of planet 1, rad, (n, 3).
        x, v, force: meshing displacement (m), its rate (m/s), mesh force (N), (n, 7) in the order of names.MESHES.
        bearing_force: force of the shaft on each bearing, x y z, (n, 10, 3) in the order of names.BEARINGS.
        shaft_angle, shaft_speed, shaft_torque: unwrapped rad, rad/s and N m, (n, 4) in the order of names.SHAFTS; each
            in its own sense of rotation. The torque is what the shaft passes on: input, from the meshes, output.
        open_fraction, back_fraction: share of the block's steps in which a mesh was open, or on its back flank, (7,).
    """

    time: Array
    phase: Array
    x: Array
    v: Array
    force: Array
    bearing_force: Array
    shaft_angle: Array
    shaft_speed: Array
    shaft_torque: Array
    open_fraction: Array
    back_fraction: Array


class Simulation:
    """Integrates the full model with RK4 under a given drive.

    Args:
        configuration: gearbox and step.
        drive: speed and torque at the start.
        start: `equilibrium` at the drive's torque, or `zero` as in the paper.
        excitation: `kinematic` or `tied`; None = as configured.
        sample_rate: samples per second; divides 1/step.

    Raises:
        InputError: the sample rate doesn't divide 1/step.
        equilibrium.NoEquilibrium: there is no state of rest to start from.
    """

    def __init__(
        self,
        configuration: Configuration,
        drive: Drive,
        *,
        start: str = "equilibrium",
        excitation: str | None = None,
        sample_rate: float = 5120.0,
    ) -> None:
        self._step = configuration.numerics.step
        self._per_sample = steps_per_sample(sample_rate, self._step)
        self._sample_rate = sample_rate
        self._configuration = configuration
        self._kinematics = kinematics.derive(configuration)
        self._constants = constants.build(configuration, excitation or configuration.excitation.mode)
        self._angle = 0.0
        self._taken = 0
        self._table_speed = math.nan
        self._tables = self._friction(drive.speed_start)
        self._q = np.zeros(len(self._constants.mass))
        self._rate = np.zeros_like(self._q)
        if start == "equilibrium":
            self._q = equilibrium.find(self._constants, self._tables, self._angle, drive.torque_start).q

    @property
    def time(self) -> float:
        """Seconds since the start; the next sample is taken there."""
        return self._taken / self._sample_rate

    @property
    def angle(self) -> float:
        """Ring angle, the integral of the ring's speed, rad."""
        return self._angle

    def advance(self, samples: int, drive: Drive) -> Block:
        """Integrate over so many sample intervals; speed and torque go linearly between the drive's ends.

        The first sample is the state before the first step, so that sample k of a run stands at k / sample_rate.

        Raises:
            Divergence: a number isn't finite any more.
        """
        duration = samples / self._sample_rate
        spin = (drive.speed_end - drive.speed_start) / duration
        ramp = (drive.torque_end - drive.torque_start) / duration
        self._tables = self._friction(0.5 * (drive.speed_start + drive.speed_end))
        seen = np.empty((samples, BEARING + 3 * len(names.BEARINGS)))
        angle, contact = np.empty(samples), np.zeros((2, len(names.MESHES)))
        state = np.array([self._angle, drive.speed_start, spin, drive.torque_start, ramp])
        lost = stepping.run(
            self._constants, self._tables, self._q, self._rate, state, self._step, self._per_sample, seen, angle, contact
        )
        if lost != stepping.FINISHED:
            raise self._divergence(lost)
        time = (self._taken + np.arange(samples)) / self._sample_rate
        within = np.arange(samples) / self._sample_rate
        self._taken += samples
        self._angle += duration * 0.5 * (drive.speed_start + drive.speed_end)
        share = contact / (samples * self._per_sample)
        speed, torque = drive.speed_start + spin * within, drive.torque_start + ramp * within
        return self._block(time, angle, speed, torque, seen, share)

    def _friction(self, speed: float) -> Array:
        """Friction tables at a ring speed; made anew only when it has changed noticeably."""
        rated = self._configuration.turbine.rated_speed
        if abs(speed - self._table_speed) <= _FRICTION_CHANGE * rated:
            return self._tables
        self._table_speed = speed
        k = self._kinematics
        drivers = ("ring", "planet", "sun")
        return np.array(
            [
                friction.tables(
                    stage.pair,
                    self._configuration.friction,
                    speed * k.shaft_ratio[shaft],
                    _FADE_SPEED * rated * k.shaft_ratio[shaft],
                )
                for stage, shaft in zip(k.stages, drivers, strict=True)
            ]
        )

    def _divergence(self, sample: int) -> Divergence:
        lost = ~np.isfinite(self._q)
        index = int(np.argmax(lost)) if lost.any() else int(np.argmax(np.abs(self._q)))
        state = list(layout.motions(self._kinematics.ring.count))[index]
        return Divergence(self.time + sample / self._sample_rate, state, float(self._q[index]), self._step)

    def _block(self, time: Array, angle: Array, speed: Array, torque: Array, seen: Array, share: Array) -> Block:
        k = self._kinematics
        meshes = len(names.MESHES)
        ratios = np.array([k.shaft_ratio[shaft] for shaft in names.SHAFTS])
        force = np.ascontiguousarray(seen[:, FORCE : FORCE + meshes])
        return Block(
            time=time,
            phase=angle[:, None] * np.array([s.mesh_ratio for s in k.stages]),
            x=np.ascontiguousarray(seen[:, X : X + meshes]),
            v=np.ascontiguousarray(seen[:, V : V + meshes]),
            force=force,
            bearing_force=seen[:, BEARING:].reshape(len(time), len(names.BEARINGS), 3),
            shaft_angle=angle[:, None] * ratios,
            shaft_speed=speed[:, None] * ratios,
            shaft_torque=self._torques(torque, force),
            open_fraction=share[0],
            back_fraction=share[1],
        )

    def _torques(self, torque: Array, force: Array) -> Array:
        """Input torque, and what the mesh forces pass on to one planet (mean of three), the sun and the output shaft."""
        passed = [torque]
        for stage in self._kinematics.stages:
            chosen = [names.MESHES.index(mesh) for mesh in names.MESHES_OF_STAGE[stage.name]]
            arm = stage.pair.driven.base_radius * math.cos(stage.pair.base_helix)
            total = force[:, chosen].sum(axis=1)
            passed.append(arm * (total / len(chosen) if stage.name == "I" else total))
        return np.column_stack(passed)


def steps_per_sample(sample_rate: float, step: float) -> int:
    """Whole number of steps between two samples.

    Raises:
        InputError: it isn't whole.
    """
    ratio = 1.0 / (sample_rate * step)
    if ratio < 1 - _LIMIT or abs(ratio - round(ratio)) > _LIMIT * ratio:
        raise InputError("parameter sample_rate", f"a whole fraction of 1/step = {1 / step:.6g} Hz", f"{sample_rate:g} Hz")
    return round(ratio)


def compile_kernels() -> None:
    """Compile everything, or load it from the cache, by a very short run."""
    configuration = config.load()
    speed = configuration.turbine.rated_speed
    drive = Drive(speed, speed, 0.0, 0.0)
    Simulation(configuration, drive, start="zero").advance(1, drive)
