"""Lyapunov exponents of the gearbox over a number of its configuration, by the variational equations.

A piece of work is one point: it starts at rest in its equilibrium, settles, and then carries its deviations.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim import config
from nw_gear_sim.params import Configuration
from nw_gear_sim.simulation import Divergence
from nw_gear_sim.studies.store import Store
from nw_gear_sim.tangent.benettin import LEAST, Spectrum, kaplan_yorke, spectrum
from nw_gear_sim.tangent.flow import Flow

STAGE = "II"
"""Whose mesh periods are counted."""
SHRINKING = 12.0
"""Natural logarithm by which deviations may shrink against each other before they are made orthonormal again."""
SIGMAS = 3.0
"""An exponent this many standard errors from 0 has a sign."""
REGULAR = "regular"


@dataclass(frozen=True)
class Plan:
    """What every point of a study does.

    Attributes:
        excitation: kinematic or tied; ring: flexible or rigid.
        count: exponents, the largest ones; 0: all of them.
        transient, record: mesh periods of stage II before and while deviations are carried.
    """

    excitation: str = "tied"
    ring: str = "rigid"
    count: int = 1
    transient: int = 200
    record: int = 1000

    def __post_init__(self) -> None:
        if self.count < 0:
            raise InputError("--count", "1 or more, or 0 for all", str(self.count))
        if self.transient < 0:
            raise InputError("--transient", "0 periods or more", str(self.transient))
        if self.record < LEAST:
            raise InputError("--record", f"at least {LEAST} periods", str(self.record))


@dataclass(frozen=True, eq=False)
class Piece:
    """One point."""

    plan: Plan
    configuration: Configuration


@dataclass(frozen=True, eq=False)
class Row:
    """What was found at a point.

    Attributes:
        values: of the axes.
        rate, error: exponents and their standard errors, 1/s, (count,); NaN where the motion diverged.
        time, history: running means, s and 1/s, (times,) and (times, count).
        divergence: mean of the flow's, 1/s; states: how many exponents there are in all.
        duration: s recorded; period: of the mesh of stage II, s; diverged: s, NaN where it didn't.
    """

    values: tuple[float, ...]
    rate: Array
    error: Array
    time: Array
    history: Array
    divergence: float
    states: int
    duration: float
    period: float
    diverged: float

    @property
    def dimension(self) -> float:
        """Kaplan-Yorke dimension of the section, NaN where it needs more exponents."""
        return kaplan_yorke(self.rate) if np.all(np.isfinite(self.rate)) else math.nan

    @property
    def motion(self) -> str:
        """`chaotic` or `regular` where the largest exponent's sign is sure, `unknown`, or `diverged`."""
        if np.isfinite(self.diverged):
            return "diverged"
        rate, error = float(self.rate[0]), float(self.error[0])
        if abs(rate) <= SIGMAS * error:
            return names.UNKNOWN
        return names.CHAOTIC if rate > 0.0 else REGULAR

    @property
    def complete(self) -> bool:
        """Whether these are all the exponents, so that their sum has to be the divergence."""
        return len(self.rate) == self.states

    def as_object(self, axes: Sequence[str]) -> dict[str, Any]:
        """Return everything but the running means, for JSON; None for what isn't there."""
        numbers = {
            "kaplan_yorke_dimension": self.dimension, "sum": float(np.sum(self.rate)), "divergence": self.divergence,
            "diverged": self.diverged,
        }  # fmt: skip
        return {
            **dict(zip(axes, self.values, strict=True)),
            "motion": self.motion,
            **{name: _numbers(values) for name, values in (("rate", self.rate), ("error", self.error))},
            "rate_per_period": _numbers(self.rate * self.period),
            "error_per_period": _numbers(self.error * self.period),
            **{name: value if math.isfinite(value) else None for name, value in numbers.items()},
            "states": self.states,
            "duration": self.duration,
            "mesh_period": self.period,
        }


def pieces(configurations: Sequence[Configuration], plan: Plan) -> dict[str, Piece]:
    """Return independent pieces, by key."""
    return {f"point-{k:06d}": Piece(plan, configuration) for k, configuration in enumerate(configurations)}


def compute(piece: Piece) -> dict[str, Array]:
    """Compute one point; arrays by the names in `Row`."""
    plan = piece.plan
    count = plan.count or states(piece.configuration, plan)
    flow = Flow(piece.configuration, count, excitation=plan.excitation, ring=plan.ring)
    if flow.speed <= 0.0:
        raise InputError("operation.ring_speed", "above 0, since mesh periods are counted", f"{flow.speed:g} rad/s")
    period = 1.0 / flow.mesh_frequency(STAGE)
    result, diverged = None, math.nan
    try:
        flow.settle(plan.transient * period)
        steps = steps_between(flow, period)
        interval = steps * flow.step
        intervals = max(LEAST, math.ceil(plan.record * period / interval))
        result = spectrum(lambda deviations: flow.carry(deviations, steps), flow.beginning(), interval, intervals)
    except Divergence as error:
        diverged = error.time
    return {**_arrays(result, count), "states": np.array(flow.size), "period": np.array(period),
            "diverged": np.array(diverged)}  # fmt: skip


def states(configuration: Configuration, plan: Plan) -> int:
    """Return how many exponents a gearbox has: two for every motion."""
    return Flow(configuration, 1, excitation=plan.excitation, ring=plan.ring).size


def steps_between(flow: Flow, period: float) -> int:
    """Return the steps after which deviations have to be made orthonormal: before SHRINKING, and in a mesh period."""
    most = max(1, round(period / flow.step))
    if flow.count == 1:
        return most
    decay = flow.slowest()
    return max(1, min(most, int(SHRINKING / max(float(decay[0] - decay[flow.count - 1]), 1.0) / flow.step)))


def rows(store: Store, points: Sequence[tuple[float, ...]]) -> list[Row]:
    """Return the rows of all finished points; `points` are the values of the axes."""
    found = []
    for key in sorted(store.done()):
        arrays = store.get(key)
        found.append(
            Row(
                values=points[int(key.split("-")[1])],
                rate=arrays["rate"], error=arrays["error"], time=arrays["time"], history=arrays["history"],
                divergence=float(arrays["divergence"]), states=int(arrays["states"]),
                duration=float(arrays["duration"]), period=float(arrays["period"]), diverged=float(arrays["diverged"]),
            )
        )  # fmt: skip
    return found


def exponents_table(found: Sequence[Row], axes: Sequence[str]) -> dict[str, Any]:
    """Return name -> values, one row for every point and exponent; rates in 1/s."""
    return {
        **_repeated(found, axes, [len(row.rate) for row in found]),
        "exponent": [k + 1 for row in found for k in range(len(row.rate))],
        "rate": np.concatenate([row.rate for row in found]),
        "error": np.concatenate([row.error for row in found]),
        "rate_per_period": np.concatenate([row.rate * row.period for row in found]),
        "motion": [row.motion for row in found for _ in row.rate],
        "divergence": [row.divergence for row in found for _ in row.rate],
        "kaplan_yorke_dimension": [row.dimension for row in found for _ in row.rate],
    }


def convergence_table(found: Sequence[Row], axes: Sequence[str]) -> dict[str, Any]:
    """Return name -> values, one row for every point, time (s) and exponent: means (1/s) up to that time."""
    return {
        **_repeated(found, axes, [row.history.size for row in found]),
        "time": np.concatenate([np.repeat(row.time, row.history.shape[1]) for row in found]),
        "exponent": np.concatenate([np.tile(np.arange(len(row.rate)) + 1, len(row.time)) for row in found]),
        "mean": np.concatenate([row.history.ravel() for row in found]),
    }


def describe(base: Configuration, axes: Sequence[tuple[str, Array]], plan: Plan) -> dict[str, Any]:
    """Return what a store has to know to tell this study from another."""
    return {
        "study": "lyapunov",
        "configuration": config.to_yaml(base),
        "axes": {name: values.tolist() for name, values in axes},
        "plan": asdict(plan),
    }


def _arrays(result: Spectrum | None, count: int) -> dict[str, Array]:
    if result is None:
        nothing, none = np.full(count, np.nan), np.array(np.nan)
        return {"rate": nothing, "error": nothing, "time": np.zeros(0), "history": np.zeros((0, count)),
                "divergence": none, "duration": np.array(0.0)}  # fmt: skip
    order = np.argsort(-result.rate, kind="stable")  # neighbours that are equal within their errors may swap
    return {
        "rate": result.rate[order], "error": result.error[order], "time": result.time,
        "history": result.history[:, order], "divergence": np.array(result.divergence),
        "duration": np.array(result.duration),
    }  # fmt: skip


def _repeated(found: Sequence[Row], axes: Sequence[str], lengths: Sequence[int]) -> dict[str, Any]:
    return {name: np.repeat([row.values[k] for row in found], lengths) for k, name in enumerate(axes)}


def _numbers(values: Array) -> list[float | None]:
    return [float(value) if math.isfinite(value) else None for value in values]
