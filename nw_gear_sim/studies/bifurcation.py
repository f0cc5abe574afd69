"""Bifurcation diagrams of the whole gearbox: Poincare sections, period, exponent over numbers of a configuration.

A piece of work is one block of the batch, LANES points side by side. Without carrying on, every point starts from its
own equilibrium and pieces are independent. Sweeps carry the state from point to point, up and down: then a piece is one
point of both sweeps, it begins where the last one ended, and the branches show hysteresis.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim import config
from nw_gear_sim.batch.batch import Batch
from nw_gear_sim.batch.lanes import LANES
from nw_gear_sim.batch.results import End, Span
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.studies.exponents import largest_exponents
from nw_gear_sim.studies.store import Store

LONGEST_PERIOD = 16
SPREAD = 0.02
"""A section that scatters by less than this share of the signal's standard deviation is one point."""
EXPLAINED = 0.8
"""A motion has period n where the means over every nth point of the record's first half predict more than this share
of the variance of its second half. What is left is lines of rollers and of other stages; where the frequency of such a
line is close to a fraction of the section's, the points of both halves differ."""
SETTLED = 0.02
"""Mean and scatter of a section may differ between both halves of the record by this share of the signal's."""
SIGMAS = 3.0
"""An exponent this many standard errors above 0 is positive."""
EXPONENT_INTERVALS = 24
SAMPLES_PER_PERIOD = 16
END = "end."


@dataclass(frozen=True)
class Plan:
    """What every point of a study does.

    Attributes:
        excitation: kinematic or tied; ring: flexible or rigid; step: s.
        stage: whose mesh periods are counted; transient, record: periods of it.
        exponent_periods: periods between two pulls of the twins; 0: no exponents.
    """

    excitation: str = "tied"
    ring: str = "flexible"
    step: float = 1 / 20480
    stage: str = "II"
    transient: int = 100
    record: int = 200
    exponent_periods: int = 5

    def __post_init__(self) -> None:
        if self.transient < 0:
            raise InputError("--transient", "0 periods or more", str(self.transient))
        if self.record < 2 * LONGEST_PERIOD:
            raise InputError("--record", f"at least {2 * LONGEST_PERIOD} periods", str(self.record))
        if self.exponent_periods < 0:
            raise InputError("--exponent-periods", "0 or more", str(self.exponent_periods))


@dataclass(frozen=True, eq=False)
class Piece:
    """Points that are computed together: their configurations, and where they begin (None: at rest)."""

    plan: Plan
    configurations: tuple[Configuration, ...]
    start: End | None = None


def grid(base: Configuration, axes: Sequence[tuple[str, Array]]) -> list[Configuration]:
    """Return the configurations of all points; the last axis runs fastest.

    Raises:
        InputError: unknown key or value out of range, named with the point.
    """
    fixed = config.with_values({"operation.drive": "fixed"}, base)
    points = itertools.product(*(values.tolist() for _, values in axes))
    return [config.with_values(dict(zip((n for n, _ in axes), point, strict=True)), fixed) for point in points]


def blocks(configurations: Sequence[Configuration], plan: Plan) -> dict[str, Piece]:
    """Return independent pieces, by key."""
    count = len(configurations)
    return {f"points-{k:06d}": Piece(plan, tuple(configurations[k : k + LANES])) for k in range(0, count, LANES)}


def compute(piece: Piece) -> dict[str, Array]:
    """Compute the points of a piece.

    Returns:
        arrays with the points first: `x`, `v` (points, 7, n) sections, NaN beyond the last; `deviation` (points, 7) of
        the signals, m; `period` (points, 7), 0 for none; `settled` (points, 7); `rate`, `error` of the exponent, 1/s;
        `open`, `back` shares (points, 7); `diverged`, s, NaN for none; and the state at the end.
    """
    plan = piece.plan
    points = list(piece.configurations)
    batch = begin(piece)
    if plan.transient:
        batch.advance(periods=plan.transient, stage=plan.stage)
    span = batch.advance(periods=plan.record, stage=plan.stage)
    return {**readings(span), **exponents(batch, points, plan), **_as_parts(batch.end())}


def carried(arrays: Mapping[str, Array], plan: Plan) -> End:
    """Return where a computed piece ended, for the next one."""
    parts = {name.removeprefix(END): value for name, value in arrays.items() if name.startswith(END)}
    angle, pairs = parts.pop("angle"), parts.pop("pairs")
    keys = tuple((int(a), int(b), int(c), int(d)) for a, b, c, d in pairs)
    return End(parts, angle, keys, plan.step)


def sweep(configurations: Sequence[Configuration], plan: Plan, store: Store, say: Callable[[int, int], None]) -> None:
    """Go through the points upwards and downwards side by side, each point beginning where the last one ended.

    Piece k holds point k of the upward sweep and point k of the downward one, which is counted from the other end.

    Args:
        configurations: in ascending order of the axis; plan: what every point does.
        store: takes the pieces; those that it has are not computed again.
        say: told how many pieces are done, of how many.
    """
    done, start = store.done(), None
    for k in range(len(configurations)):
        key = f"sweep-{k:06d}"
        if key not in done:
            store.put(key, compute(Piece(plan, (configurations[k], configurations[-1 - k]), start)))
        start = carried(store.get(key), plan)
        say(k + 1, len(configurations))


def label(period: int, rate: float, error: float, diverged: float) -> str:
    """Return a state in the vocabulary of the monitor for one mesh of a point; `diverged` beside it.

    `unknown` where the exponent is above 0 by less than its error allows to say, and where there are too few periods.
    """
    if np.isfinite(diverged):
        return "diverged"
    if rate > SIGMAS * error:
        return names.CHAOTIC
    return names.PERIODS[period - 1] if period and rate <= 0.0 else names.UNKNOWN


def describe(base: Configuration, axes: Sequence[tuple[str, Array]], plan: Plan, carries: bool) -> dict[str, Any]:
    """Return what a store has to know to tell this study from another."""
    return {
        "study": "bifurcation",
        "configuration": config.to_yaml(base),
        "axes": {name: values.tolist() for name, values in axes},
        "plan": asdict(plan),
        "sweep": carries,
    }


def period_of(x: Array, v: Array, scale: tuple[float, float]) -> int:
    """Return the period n, up to LONGEST_PERIOD, of a motion that is known not to be chaotic.

    Args:
        x, v: (points,) of the section; scale: standard deviations of both signals.

    Returns:
        the smallest n whose means explain a section that scatters; else 1. 0 where there is too little to tell.
    """
    if min(scale) <= 0.0 or len(x) < 2 * LONGEST_PERIOD:
        return 0
    points = np.stack([(x - x.mean()) / scale[0], (v - v.mean()) / scale[1]])
    if np.sqrt(np.mean(points**2)) < SPREAD:
        return 1
    for n in range(2, LONGEST_PERIOD + 1):
        rows = points.shape[1] // (2 * n)
        first, second = points[:, : 2 * rows * n].reshape(2, 2, rows, n).swapaxes(0, 1)
        left = np.mean((second - first.mean(axis=1, keepdims=True)) ** 2)
        if left < (1.0 - EXPLAINED) * np.mean(second**2):
            return n
    return 1


def begin(piece: Piece, sample_rate: float | None = None) -> Batch:
    """Return the points of a piece before their transient.

    Args:
        sample_rate: of the waveform, Hz; None: SAMPLES_PER_PERIOD of the highest mesh frequency.
    """
    plan, points = piece.plan, list(piece.configurations)
    if sample_rate is None:
        sample_rate = 1.0 / plan.step / max(1, round(1.0 / plan.step / (SAMPLES_PER_PERIOD * _fastest(points))))
    return Batch(
        points,
        excitation=plan.excitation,
        ring=plan.ring,
        step=plan.step,
        sample_rate=sample_rate,
        section=plan.stage if plan.excitation == "tied" else "own",
        start="equilibrium" if piece.start is None else piece.start,
        threads=1,
    )


def _fastest(points: list[Configuration]) -> float:
    """Return the highest mesh frequency of stage III in the points, Hz."""
    return max(derive(c).mesh_frequency_hz("III", derive(c).ring_speed) for c in points)


def exponents(batch: Batch, points: list[Configuration], plan: Plan) -> dict[str, Array]:
    """Return `rate` and `error` (points,) of the largest exponents from where a batch is, 1/s; NaN if not asked for."""
    if not plan.exponent_periods:
        return {name: np.full(len(points), np.nan) for name in ("rate", "error")}
    interval = plan.exponent_periods * float(np.max(batch.period(plan.stage)))
    found = largest_exponents(
        points, batch.end(), excitation=plan.excitation, ring=plan.ring, step=plan.step,
        interval=interval, intervals=EXPONENT_INTERVALS,
    )  # fmt: skip
    return {"rate": found.rate, "error": found.error}


def readings(span: Span) -> dict[str, Array]:
    """Return what `compute` gives of a record: sections, deviations, periods, shares."""
    points = span.section_x.shape[0]
    deviation = np.std(span.x, axis=1)
    interval = float(span.time[1] - span.time[0])
    swing = np.std(np.gradient(span.x, interval, axis=1), axis=1)
    period, settled = np.zeros((points, 7)), np.zeros((points, 7))
    for point, mesh in itertools.product(range(points), range(7)):
        section = span.section(point, names.MESHES[mesh])
        scale = (float(deviation[point, mesh]), float(swing[point, mesh]))
        period[point, mesh] = period_of(section.x, section.v, scale)
        settled[point, mesh] = _settled(section.x, scale[0])
    return {
        "x": span.section_x, "v": span.section_v, "deviation": deviation, "period": period, "settled": settled,
        "open": span.open_fraction, "back": span.back_fraction, "diverged": span.diverged,
    }  # fmt: skip


def _settled(x: Array, scale: float) -> bool:
    half = len(x) // 2
    if half < LONGEST_PERIOD or not scale > 0.0:
        return False
    first, second = x[:half], x[half : 2 * half]
    return bool(max(abs(first.mean() - second.mean()), abs(first.std() - second.std())) < SETTLED * scale)


def _as_parts(end: End) -> dict[str, Array]:
    parts: dict[str, Any] = {**end.parts, "angle": end.angle, "pairs": np.array(end.pairs, dtype=np.int64)}
    return {END + name: part for name, part in parts.items()}
