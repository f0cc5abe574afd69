"""The simulator's part of `nw_gear bench`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from nw_gear_common.benchmarking import Figure, Part
from nw_gear_common.tables import Array
from nw_gear_sim import config as configurations
from nw_gear_sim.bench import accuracy, diagram, peers, results, speed, sweep
from nw_gear_sim.bench.cases import ACCURATE_STEP, FAST_STEP, PIECE, RATE, REFERENCE, Case, Method, cases
from nw_gear_sim.bench.results import Measured
from nw_gear_sim.params import Configuration

LIVE = "gautschi"
ACCURATE, FAST = Method(LIVE, ACCURATE_STEP), Method(LIVE, FAST_STEP)
FINER = Method(LIVE, ACCURATE_STEP / 2.0)
CLASSICAL = Method("rk4", 1.0 / 40960.0)
OTHERS = (FINER, Method("etdrk4", ACCURATE_STEP), Method("etdrk4", FAST_STEP), CLASSICAL)
NUDGE = 1e-6


@dataclass(frozen=True)
class Extent:
    """How much is run.

    Attributes:
        cases: names of those in which errors are measured, None for all; pieces: of each.
        others: methods beside the live ones.
        seconds, repeats: of each timing; scipy, rattling: seconds simulated there; sweep: steps; diagram: points.
    """

    cases: tuple[str, ...] | None
    others: tuple[Method, ...]
    pieces: int
    seconds: float
    repeats: int
    scipy: float
    sweep: int
    diagram: int
    rattling: float


FULL = Extent(
    cases=None,
    others=OTHERS,
    pieces=7,
    seconds=0.5,
    repeats=7,
    scipy=0.01,
    sweep=4000,
    diagram=diagram.POINTS,
    rattling=8.0,
)
QUICK = Extent(
    cases=(results.RATED, "torque_step"),
    others=(CLASSICAL,),
    pieces=1,
    seconds=0.05,
    repeats=3,
    scipy=0.003,
    sweep=400,
    diagram=16,
    rattling=0.0,
)


def measure(config: str | None, *, quick: bool, say: Callable[[str], None]) -> Part:
    """Measure the simulator (see `benchmarking.Benchmark`).

    Raises:
        InputError: the configuration can't be used, or the accurate step is beyond the bound of an integrator.
    """
    configuration = configurations.load(config)
    extent = QUICK if quick else FULL
    say("simulator: kernels (compiling them takes a minute where they aren't cached)")
    right_hand_side = speed.right_hand_side(configuration, extent.repeats)
    say(f"simulator: reference, rk4 at {REFERENCE.step:.3g} s")
    compared = tuple(
        case for case in cases(configuration, extent.pieces) if extent.cases is None or case.name in extent.cases
    )
    exact = accuracy.exact_runs(configuration, compared)
    measured = {method: _measure(configuration, method, compared, exact, extent, say) for method in (ACCURATE, FAST)}
    others = [_measure(configuration, method, compared, exact, extent, say) for method in extent.others]
    say("simulator: scipy's RK45")
    same = peers.compiled(configuration, extent.scipy, exact[results.RATED])
    plain = peers.with_numpy(configuration, extent.scipy, exact[results.RATED])
    live = measured[ACCURATE].steady
    accurate, fast = measured[ACCURATE], measured[FAST]
    figures = [
        Figure("right-hand side, 463 motions" if not config else "right-hand side", f"{1e6 * right_hand_side:.3g} us"),
        *accurate.figures(results.ACCURATE_GOALS),
        *fast.figures(results.FAST_GOALS),
        *(line for other in others for line in other.figures(results.NO_GOALS)),
        results.solved_figure("scipy RK45, the same right-hand side", same, live, results.SCIPY_GOAL),
        results.solved_figure("scipy RK45, NumPy right-hand side", plain, live, results.NUMPY_GOAL),
    ]
    values: dict[str, Any] = {
        "right_hand_side_us": 1e6 * right_hand_side,
        **accurate.values(),
        "fast": fast.values(),
        "integrators": [other.values() for other in others],
        "ratio_scipy_same_rhs": same.cpu_per_second / live,
        "ratio_scipy_numpy_rhs": plain.cpu_per_second / live,
        "scipy": {"same_rhs": results.solved_values(same), "numpy_rhs": results.solved_values(plain)},
    }
    say("simulator: sweeps")
    values["sweep"], lines = sweep.measure(configuration, exact[results.RATED], extent.sweep)
    values["sweep_points_per_second"] = values["sweep"]["accurate"]["points_per_second"]
    figures += lines
    say("simulator: bifurcation diagrams")
    values["diagram"], lines = diagram.measure(configuration, extent.diagram, extent.scipy)
    figures += lines
    if extent.rattling:
        say("simulator: rattling")
        lines, values["rattling"] = _rattling(extent.rattling)
        figures += lines
    return Part("Simulator (CPU time of one thread, medians)", tuple(figures), _conditions(extent, compared), values)


def _measure(
    configuration: Configuration,
    method: Method,
    compared: tuple[Case, ...],
    exact: dict[str, Array],
    extent: Extent,
    say: Callable[[str], None],
) -> Measured:
    say(f"simulator: {method.integrator} at 1/{1.0 / method.step:.0f} s")
    return Measured(
        method,
        speed.cpu_per_second(configuration, method, extent.seconds, extent.repeats),
        speed.cpu_per_second(configuration, method, extent.seconds, extent.repeats, windy=True),
        {case.name: accuracy.errors(configuration, case, exact[case.name], method) for case in compared},
    )


def _rattling(seconds: float) -> tuple[list[Figure], dict[str, Any]]:
    """Compare statistics with those of the classical method; another run of that one shows what chance does."""
    classical = accuracy.rattling(CLASSICAL, seconds)
    runs = {
        "accurate": accuracy.rattling(ACCURATE, seconds),
        "fast": accuracy.rattling(FAST, seconds),
        "chance": accuracy.rattling(CLASSICAL, seconds, NUDGE),
    }
    values: dict[str, Any] = {"seconds": seconds}
    figures = []
    for name, run in runs.items():
        deviation, opened = run.against(classical)
        values[name] = {"deviation_ratio": deviation, "open_fraction": opened}
        text = f"{100 * deviation:.2g} % in standard deviations, {opened:.2g} in open fractions"
        label = "rk4, started a little otherwise" if name == "chance" else f"{LIVE}, {name}"
        figures.append(Figure(f"rattling, {label}: largest difference from rk4", text))
    return figures, values


def _conditions(extent: Extent, compared: tuple[Case, ...]) -> tuple[str, ...]:
    length = 1e3 * extent.pieces * PIECE / RATE
    return (
        f"speed: ticks of {speed.TICK} samples at {speed.SAMPLE_RATE:g} Hz, sampling included; median of "
        f"{extent.repeats} runs of {extent.seconds:g} s",
        f"errors: largest |x_n - x_n of rk4 at {REFERENCE.step:.3g} s| over the seven meshes, from "
        f"{1e3 * accuracy.SETTLE:g} to {length:.1f} ms",
        "cases: " + "; ".join(f"{case.name}: {case.text}" for case in compared),
        f"scipy: solve_ivp RK45, rtol {peers.RTOL:g}, atol {peers.ATOL_DISPLACEMENT:g} m and "
        f"{peers.ATOL_VELOCITY:g} m/s, {1e3 * extent.scipy:g} ms at rated load, scaled to a second",
        "sweep: points of different load in the lanes of one thread, points x simulated seconds per CPU second; its "
        "contact between segments is modelled otherwise, which its error includes",
        "bifurcation diagram: excitation.omega_e from 0.16 to 0.26, tied, 100 + 200 mesh periods of stage II, with "
        "equilibria and sections, without exponents; CPU time of all threads; scipy's cost of a point from "
        f"{1e3 * extent.scipy:g} ms in the middle",
        "the NumPy right-hand side works on whole arrays, with sparse matrices and tabulated friction",
    )
