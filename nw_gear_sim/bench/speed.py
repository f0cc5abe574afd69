"""Cost of a step and of a right-hand side, in CPU time of one core."""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

from nw_gear_common.benchmarking import cpu_seconds
from nw_gear_common.tables import Array
from nw_gear_sim import model
from nw_gear_sim.bench.cases import Method
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.simulation import Simulation

SAMPLE_RATE = 5120.0
"""Of the waveform, as it is published by default (Hz)."""
TICK = 64
"""Samples integrated at once, as `gear_sim_node` does."""
CALLS = 5000


def cpu_per_second(
    configuration: Configuration, method: Method, seconds: float, repeats: int, *, windy: bool = False
) -> float:
    """Return the CPU time (s) of a simulated second, sampling included: the median of repeats of some seconds.

    Args:
        configuration: of the gearbox; it runs at its fixed operating point.
        method: integrator and step.
        seconds: simulated in each repeat.
        repeats: after a first one that isn't counted.
        windy: let speed and torque change from tick to tick, as under the wind.
    """
    fixed = derive(configuration)
    speed, torque = fixed.ring_speed, fixed.input_torque
    drive = Drive(speed, speed, torque, torque)
    simulation = Simulation(method.applied_to(configuration), drive, sample_rate=SAMPLE_RATE)
    ticks = max(1, round(seconds * SAMPLE_RATE / TICK))

    def swing(k: int) -> float:
        return 1.0 - 0.01 * (1.0 - math.cos(0.1 * k)) if windy else 1.0

    def run() -> None:
        for k in range(ticks):
            a, b = swing(k), swing(k + 1) if k + 1 < ticks else 1.0
            simulation.advance(TICK, Drive(a * speed, b * speed, a * torque, b * torque))

    run()
    return cpu_seconds(run, repeats) / (ticks * TICK / SAMPLE_RATE)


def right_hand_side(configuration: Configuration, repeats: int) -> float:
    """Return the CPU time (s) of one evaluation of the forces on all motions, called from compiled code."""
    gearbox = Gearbox(configuration)
    fixed = derive(configuration)
    gearbox.set_instant(fixed.input_torque, fixed.ring_speed)
    q, v, out = (np.zeros(gearbox.layout.size) for _ in range(3))
    evaluate = evaluation()
    evaluate(gearbox.laws, gearbox.instants, q, v, gearbox.work, out, 1)
    return (
        cpu_seconds(lambda: evaluate(gearbox.laws, gearbox.instants, q, v, gearbox.work, out, CALLS), repeats) / CALLS
    )


def evaluation() -> Any:
    """Compile a loop over the right-hand side."""

    @numba.njit(nogil=True)
    def evaluate(
        laws: model.Laws, instants: model.Instants, q: Array, v: Array, work: model.Work, out: Array, calls: int
    ) -> None:
        for _ in range(calls):
            model.forces(laws, instants, 0, q, v, work, out)

    return evaluate
