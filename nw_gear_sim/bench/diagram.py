"""Speed of a whole bifurcation diagram against a loop of scipy's solve_ivp over its points, in one run."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import scipy.integrate

from nw_gear_common.benchmarking import Figure
from nw_gear_common.tables import Array
from nw_gear_sim.bench.peers import ATOL_DISPLACEMENT, ATOL_VELOCITY, RTOL
from nw_gear_sim.bench.problem import Problem
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.studies import bifurcation

OVER, FROM, TO = "excitation.omega_e", 0.16, 0.26
"""The axis of the paper's Figs 19-21."""
POINTS = 201
STAGE = "II"


def measure(configuration: Configuration, points: int, scipy_seconds: float) -> tuple[dict[str, Any], list[Figure]]:
    """Return values and lines for the flexible and the rigid ring.

    Args:
        configuration: of the gearbox; points: of the diagram.
        scipy_seconds: simulated with scipy in the middle of the diagram; its cost is scaled to all points.
    """
    values: dict[str, Any] = {"points": points}
    figures = []
    for ring in ("flexible", "rigid"):
        ours = points / cpu_of_diagram(configuration, ring, points)
        theirs = 1.0 / cpu_of_scipy(configuration, ring, scipy_seconds)
        values[ring] = {"points_per_second": ours, "scipy_points_per_second": theirs, "ratio": ours / theirs}
        text = f"{ours:.3g} ({ours / theirs:.3g} x a loop of scipy's RK45, {1.0 / theirs:.3g} s a point)"
        figures.append(Figure(f"bifurcation diagram of {points} points, {ring} ring: points a second", text))
    return values, figures


def cpu_of_diagram(configuration: Configuration, ring: str, points: int) -> float:
    """Return the CPU time (s) of one thread for all points: equilibria, transients, records, sections, periods."""
    plan = bifurcation.Plan(ring=ring, exponent_periods=0)
    axis = np.linspace(FROM, TO, points)

    def draw(part: Array) -> None:
        for piece in bifurcation.blocks(bifurcation.grid(configuration, [(OVER, part)]), plan).values():
            bifurcation.compute(piece)

    draw(axis[:1])
    began = time.process_time()
    draw(axis)
    return time.process_time() - began


def cpu_of_scipy(configuration: Configuration, ring: str, seconds: float) -> float:
    """Return the CPU time (s) of a point by solve_ivp, from some simulated seconds at the middle of the axis."""
    plan = bifurcation.Plan(ring=ring)
    middle = bifurcation.grid(configuration, [(OVER, np.array([0.5 * (FROM + TO)]))])[0]
    problem = Problem(middle, plan.excitation, ring)
    half = np.ones(len(problem.start) // 2)
    atol = np.concatenate([ATOL_DISPLACEMENT * half, ATOL_VELOCITY * half])
    problem.slope(0.0, problem.start)
    began = time.thread_time()
    scipy.integrate.solve_ivp(problem.slope, (0.0, seconds), problem.start, "RK45", rtol=RTOL, atol=atol)
    spent = time.thread_time() - began
    fixed = derive(middle)
    length = (plan.transient + plan.record) / fixed.mesh_frequency_hz(STAGE, fixed.ring_speed)
    return spent * length / seconds
