"""What the same run costs with scipy: solve_ivp(RK45) on a compiled right-hand side, and on one written with NumPy."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.integrate

from nw_gear_common.tables import Array
from nw_gear_sim.bench.accuracy import SETTLED
from nw_gear_sim.bench.cases import RATE
from nw_gear_sim.bench.problem import Problem
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.kinematics import derive
from nw_gear_sim.layout import Layout
from nw_gear_sim.params import Configuration
from nw_gear_sim.reference.arrays import ArrayModel
from nw_gear_sim.reference.model import ReferenceModel

RTOL = 1e-6
ATOL_DISPLACEMENT, ATOL_VELOCITY = 1e-9, 1e-5
"""Absolute tolerances: a thousandth of a micrometre (m), and what belongs to it at 1.6 kHz (m/s)."""


@dataclass(frozen=True)
class Solved:
    """CPU time (s) of a simulated second, calls of the right-hand side in it, largest settled error of x_n (m)."""

    cpu_per_second: float
    calls_per_second: float
    error: float


def compiled(configuration: Configuration, seconds: float, exact: Array) -> Solved:
    """Integrate at the rated point from equilibrium with the compiled right-hand side.

    Args:
        configuration: of the gearbox.
        seconds: simulated.
        exact: elongations x_n of the reference at RATE, (samples, 7).
    """
    problem = Problem(configuration)
    scale = np.ones(len(problem.start) // 2)
    return _solve(problem.slope, problem.elongation, problem.start, scale, seconds, exact)


def with_numpy(configuration: Configuration, seconds: float, exact: Array) -> Solved:
    """Do the same with the reference's equations on arrays."""
    gearbox, start, speed, torque = _at_start(configuration)
    arrays = ArrayModel(ReferenceModel(configuration), speed, torque)
    place, scale = coordinates(arrays.names, gearbox.layout, gearbox.kinematics.bodies.ring.base_radius)
    size = len(start)

    def slope(moment: float, state: Array) -> Array:
        q, v = state[:size], state[size:]
        return np.concatenate([v, arrays.accelerations(moment, q, v)])

    def elongation(moment: float, state: Array) -> Array:
        back = np.empty(size)
        back[place] = state[:size] * scale
        gearbox.set_instant(torque, speed, speed * moment)
        gearbox.forces(back, np.zeros(size))
        return gearbox.contact.x.copy()

    state = np.concatenate([start[place] / scale, np.zeros(size)])
    return _solve(slope, elongation, state, 1.0 / scale, seconds, exact)


def coordinates(names: tuple[str, ...], layout: Layout, base_radius: float) -> tuple[Any, Array]:
    """Return the entry of each of the reference's coordinates in the layout, and what one of its units is there.

    Args:
        names: of the reference's coordinates.
        layout: of the fast model.
        base_radius: of the ring, m; the segments' rotations are counted on it.
    """
    place, scale = np.empty(len(names), dtype=np.int64), np.ones(len(names))
    for k, name in enumerate(names):
        part, motion, *segment = name.split(".")
        if part == "ring":
            place[k] = layout.ring("p" if motion == "psi" else motion).start + int(segment[0])
            scale[k] = base_radius if motion == "psi" else 1.0
        else:
            place[k] = getattr(layout.nodes[part], motion)
    return place, scale


def _at_start(configuration: Configuration) -> tuple[Gearbox, Array, float, float]:
    gearbox, fixed = Gearbox(configuration), derive(configuration)
    start = find_equilibrium(gearbox, fixed.input_torque, speed=fixed.ring_speed).q.copy()
    return gearbox, start, fixed.ring_speed, fixed.input_torque


def _solve(
    slope: Callable[[float, Array], Array],
    elongation: Callable[[float, Array], Array],
    state: Array,
    scale: Array,
    seconds: float,
    exact: Array,
) -> Solved:
    moments = np.arange(SETTLED, min(len(exact), math.floor(seconds * RATE + 1e-9) + 1)) / RATE
    atol = np.concatenate([ATOL_DISPLACEMENT * scale, ATOL_VELOCITY * scale])
    slope(0.0, state)
    began = time.thread_time()
    done = scipy.integrate.solve_ivp(slope, (0.0, seconds), state, "RK45", t_eval=moments, rtol=RTOL, atol=atol)
    spent = time.thread_time() - began
    found = [elongation(moment, there) for moment, there in zip(done.t, done.y.T, strict=True)]
    error = float(np.max(np.abs(np.array(found) - exact[SETTLED : SETTLED + len(found)])))
    return Solved(spent / seconds, done.nfev / seconds, error)
