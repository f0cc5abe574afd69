"""Errors of integrators in short runs against a fine classical one, and statistics where motions part: rattling."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim import config
from nw_gear_sim.bench.cases import RATE, REFERENCE, Case, Method
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.simulation import Simulation

SETTLE = 0.002
"""Seconds at the start that are told apart: there the jump into the run is followed."""
SETTLED = math.ceil(SETTLE * RATE)
"""The first sample after it."""
SKIPPED = 0.2
"""Share of a rattling run left out at its start."""


@dataclass(frozen=True)
class Errors:
    """Largest |x_n - x_n of the reference| over the meshes (m): after SETTLE, and before."""

    later: float
    first: float


def errors(configuration: Configuration, case: Case, exact: Array, method: Method) -> Errors:
    """Return the errors of a method in a case whose exact elongations are known, (samples, 7)."""
    error = np.max(np.abs(case.run(configuration, method) - exact), axis=1)
    return Errors(later=float(np.max(error[SETTLED:])), first=float(np.max(error[:SETTLED])))


def exact_runs(configuration: Configuration, cases: Sequence[Case]) -> dict[str, Array]:
    """Return the elongations of the reference in each case."""
    return {case.name: case.run(configuration, REFERENCE) for case in cases}


@dataclass(frozen=True, eq=False)
class Statistics:
    """Standard deviations of x_n (m) and open fractions (1) of the meshes, each (7,)."""

    deviation: Array
    opened: Array

    def against(self, other: Statistics) -> tuple[float, float]:
        """Return the largest relative difference of the deviations and the largest difference of open fractions."""
        deviation = np.max(np.abs(self.deviation / other.deviation - 1.0))
        return float(deviation), float(np.max(np.abs(self.opened - other.opened)))


def rattling(method: Method, seconds: float, nudge: float = 0.0) -> Statistics:
    """Return the statistics of the rattling preset.

    Args:
        method: integrator and step.
        seconds: length of the run; its first part is left out.
        nudge: relative change of the torque at the start, which makes another run of the same chaos.
    """
    configuration = config.load("rattling")
    fixed = derive(configuration)
    speed, torque = fixed.ring_speed, fixed.input_torque
    start = Drive(speed, speed, torque * (1.0 + nudge), torque * (1.0 + nudge))
    simulation = Simulation(method.applied_to(configuration), start, sample_rate=RATE)
    drive = Drive(speed, speed, torque, torque)
    simulation.advance(round(SKIPPED * seconds * RATE), drive)
    block = simulation.advance(round((1.0 - SKIPPED) * seconds * RATE), drive)
    return Statistics(block.x.std(axis=0), block.open_fraction)
