"""Short runs in which integrators are held against each other: how they start and what drives them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim import config
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.rotor import Rotor
from nw_gear_sim.simulation import Simulation

RATE = 10240.0
"""Samples per second that are compared; divides all steps used here."""
REFERENCE_STEP = 1.0 / 1024000.0
"""Step of the classical method that is taken for exact, s."""
ACCURATE_STEP, FAST_STEP = 1.0 / 20480.0, 1.0 / 10240.0
"""Steps of the live integrator, s: the default, and twice as long."""
PIECE = 64
"""Samples integrated at once."""


@dataclass(frozen=True)
class Method:
    """An integrator and its step (s)."""

    integrator: str
    step: float

    def applied_to(self, configuration: Configuration) -> Configuration:
        """Return the configuration with this method."""
        return config.with_values({"numerics.integrator": self.integrator, "numerics.step": self.step}, configuration)


REFERENCE = Method("rk4", REFERENCE_STEP)


@dataclass(frozen=True)
class Case:
    """A start in equilibrium under the first drive, then the drives one after the other, PIECE samples each."""

    name: str
    text: str
    start: Drive
    drives: tuple[Drive, ...]

    def run(self, configuration: Configuration, method: Method) -> Array:
        """Return the elongations x_n (m) of the meshes at RATE, (samples, 7)."""
        simulation = Simulation(method.applied_to(configuration), self.start, sample_rate=RATE)
        return np.concatenate([simulation.advance(PIECE, drive).x for drive in self.drives])


def cases(configuration: Configuration, pieces: int) -> tuple[Case, ...]:
    """Return the cases for a gearbox, each of some pieces of PIECE samples.

    Rated load, a tenth of it, a torque that jumps from a half to the whole, a rotor in a gust from 70 % to 110 % of the
    rated wind within the run, and a speed that changes by a fifth, which no rotor does but which tries the phases.
    """
    fixed = derive(configuration)
    speed, torque = fixed.ring_speed, config.with_values({"operation.load": 1.0}, configuration)
    full = derive(torque).input_torque

    def steady(name: str, text: str, before: float, during: float) -> Case:
        start = Drive(speed, speed, before * full, before * full)
        return Case(name, text, start, (Drive(speed, speed, during * full, during * full),) * pieces)

    return (
        steady("rated", "rated torque and speed", 1.0, 1.0),
        steady("light", "10 % of the rated torque", 0.1, 0.1),
        steady("torque_step", "torque from 50 to 100 % at once", 0.5, 1.0),
        _gust(configuration, pieces),
        _speed_ramp(speed, full, pieces),
    )


def _gust(configuration: Configuration, pieces: int) -> Case:
    turbine = configuration.turbine
    winds = turbine.rated_wind * np.linspace(0.7, 1.1, pieces + 1)
    rotor = Rotor(turbine, float(winds[0]))
    start = Drive(rotor.speed, rotor.speed, rotor.torque, rotor.torque)
    drives = tuple(rotor.advance(float(wind), PIECE / RATE) for wind in winds[1:])
    return Case("wind", "wind from 70 to 110 % of its rated speed", start, drives)


def _speed_ramp(speed: float, torque: float, pieces: int) -> Case:
    speeds = speed * np.linspace(0.9, 1.1, pieces + 1)
    drives = tuple(Drive(float(speeds[k]), float(speeds[k + 1]), torque, torque) for k in range(pieces))
    start = Drive(float(speeds[0]), float(speeds[0]), torque, torque)
    return Case("speed_ramp", "speed from 90 to 110 %", start, drives)
