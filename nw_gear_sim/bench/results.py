"""Results of the measurements: as values for JSON and as lines for people, with the goals beside them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from nw_gear_common.benchmarking import Figure
from nw_gear_sim.bench.accuracy import Errors
from nw_gear_sim.bench.cases import Method
from nw_gear_sim.bench.peers import Solved

RATED = "rated"


@dataclass(frozen=True)
class Goals:
    """Least real-time factor, and largest error after the settling time at rated load (m); None: no goal."""

    factor: float | None = None
    error: float | None = None


ACCURATE_GOALS = Goals(25.0, 0.15e-6)
FAST_GOALS = Goals(45.0)
NO_GOALS = Goals()
SCIPY_GOAL, NUMPY_GOAL = 300.0, 7000.0


@dataclass(frozen=True)
class Measured:
    """One method: CPU time (s) of a simulated second at constant and at changing speed; errors by case."""

    method: Method
    steady: float
    windy: float
    errors: dict[str, Errors]

    def values(self) -> dict[str, Any]:
        """Return the values for JSON."""
        return {
            "integrator": self.method.integrator,
            "step": self.method.step,
            "step_us": 1e6 * self.steady * self.method.step,
            "real_time_factor": 1.0 / self.steady,
            "wind_real_time_factor": 1.0 / self.windy,
            "error_um": 1e6 * self.errors[RATED].later,
            "errors_um": {case: 1e6 * error.later for case, error in self.errors.items()},
            "first_errors_um": {case: 1e6 * error.first for case, error in self.errors.items()},
        }

    def figures(self, goals: Goals) -> list[Figure]:
        """Return the lines for people."""
        name = f"{self.method.integrator}, step 1/{1.0 / self.method.step:.0f} s"
        others = ", ".join(f"{case} {1e6 * e.later:.3g}" for case, e in self.errors.items() if case != RATED)
        jumped = max(error.first for error in self.errors.values())
        return [
            factor_figure(f"{name}: times real time", 1.0 / self.steady, goals.factor),
            factor_figure(f"{name}: the same, speed changing", 1.0 / self.windy, goals.factor),
            Figure(f"{name}: step", f"{1e6 * self.steady * self.method.step:.3g} us"),
            error_figure(f"{name}: error at rated load", self.errors[RATED].later, goals.error),
            Figure(f"{name}: errors in the other cases", f"{others} um"),
            Figure(f"{name}: largest error in the first 2 ms", f"{1e6 * jumped:.3g} um"),
        ]


def factor_figure(name: str, factor: float, goal: float | None) -> Figure:
    """Return a line with a ratio that should be large."""
    if goal is None:
        return Figure(name, f"{factor:.3g}")
    return Figure(name, f"{factor:.3g}", f">= {goal:g}", factor >= goal)


def error_figure(name: str, error: float, goal: float | None) -> Figure:
    """Return a line with an error (m) that should be small."""
    if goal is None:
        return Figure(name, f"{1e6 * error:.3g} um")
    return Figure(name, f"{1e6 * error:.3g} um", f"<= {1e6 * goal:g} um", error <= goal)


def solved_values(solved: Solved) -> dict[str, float]:
    """Return the values of a run of scipy."""
    return {
        "cpu_s_per_s": solved.cpu_per_second,
        "calls_per_s": solved.calls_per_second,
        "error_um": 1e6 * solved.error,
    }


def solved_figure(name: str, solved: Solved, live: float, goal: float) -> Figure:
    """Return a line that compares a run of scipy with the CPU time (s) of a simulated second of the live integrator."""
    ratio = solved.cpu_per_second / live
    call = 1e6 * solved.cpu_per_second / solved.calls_per_second
    value = f"{ratio:.4g} ({solved.cpu_per_second:.3g} s a second, {call:.3g} us a call)"
    return Figure(f"{name}: its CPU time over ours", value, f">= {goal:g}", ratio >= goal)
