"""The largest Lyapunov exponent of a running simulation, by a twin trajectory (Benettin et al. 1980).

A copy of the simulation starts DISTANCE away and gets the same drive. After every interval it is pulled back to that
distance along the separation reached; the mean of the logarithms of the growth is the exponent. All that a solver
carries on is linear in displacements and velocities to first order of so small a separation, and is pulled back
together. Speed and load may change: the exponent is then that of the motion under this very drive.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.readings import Block
from nw_gear_sim.simulation import Simulation

DISTANCE = 1e-9
"""Root of the sum of squares of the differences in a solver's coordinates; of the order of nanometres."""
SETTLING = 0.2
"""Share of the intervals in which the separation turns into the fastest growing direction; they don't count."""


@dataclass(frozen=True, eq=False)
class Exponent:
    """A largest exponent.

    Attributes:
        rate: 1/s; error: its standard error from the scatter between intervals, 1/s.
        growth: of each interval, 1/s, (intervals,), the ones that settle included.
    """

    rate: float
    error: float
    growth: Array


def largest_exponent(
    simulation: Simulation,
    drives: Iterable[tuple[int, Drive]],
    *,
    seed: int = 0,
    seen: Callable[[Block], None] = lambda _: None,
) -> Exponent:
    """Run a simulation with a twin beside it.

    Args:
        simulation: on its attractor; it goes on.
        drives: samples and drive of each interval between two pulls; some tenths of a second each, at least 8.
        seed: of the direction of the first separation.
        seen: is given the blocks of the simulation.

    Raises:
        InputError: too few intervals.
    """
    twin = copy.deepcopy(simulation)
    state = simulation.state()
    name = "x" if "x" in state else "q"
    apart = {key: np.zeros_like(part) for key, part in state.items()}
    moving = np.where(state[name] != 0.0, np.random.default_rng(seed).standard_normal(state[name].shape), 0.0)
    apart[name] = moving * (DISTANCE / float(np.linalg.norm(moving)))  # what only fills the vectors never moves
    twin.take(_sum(state, apart))
    growth = []
    for samples, drive in drives:
        seen(simulation.advance(samples, drive))
        twin.advance(samples, drive)
        here, there = simulation.state(), twin.state()
        apart = {key: there[key] - here[key] for key in here}
        distance = float(np.linalg.norm(apart[name]))
        growth.append(np.log(distance / DISTANCE) * simulation.sample_rate / samples)
        twin.take(_sum(here, {key: part * (DISTANCE / distance) for key, part in apart.items()}))
    return _result(np.array(growth))


def _sum(state: dict[str, Array], apart: dict[str, Array]) -> dict[str, Array]:
    return {name: part + apart[name] for name, part in state.items()}


def _result(growth: Array) -> Exponent:
    if len(growth) < 8:
        raise InputError("intervals of the exponent", "at least 8", str(len(growth)))
    counted = growth[int(SETTLING * len(growth)) :]
    error = float(counted.std(ddof=1) / np.sqrt(len(counted)))
    return Exponent(float(counted.mean()), error, growth)
