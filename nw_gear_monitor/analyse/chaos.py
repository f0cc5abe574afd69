"""Indicators of chaos of one channel, with settings found from the signal, and the gates before them.

A neighbour-based exponent or the 0-1 test says something only once it is known that the motion neither repeats nor is
drowned in noise: both call a periodic section with a little noise chaotic. So the state comes first; where it forbids a
number, there is a reason instead.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.analyse.findings import Findings
from nw_gear_monitor.analyse.select import Signal
from nw_gear_monitor.indicators.correlation_dimension import correlation_dimension
from nw_gear_monitor.indicators.dispersion_entropy import dispersion_entropy
from nw_gear_monitor.indicators.divergence import Divergence
from nw_gear_monitor.indicators.embedding import correlation_lag, embed, mean_period, strobed
from nw_gear_monitor.indicators.permutation_entropy import permutation_entropy
from nw_gear_monitor.indicators.recurrence import recurrence
from nw_gear_monitor.indicators.rosenstein import rosenstein
from nw_gear_monitor.indicators.sample_entropy import sample_entropy
from nw_gear_monitor.indicators.zero_one import zero_one_test
from nw_gear_monitor.signals.resample import whole_turns
from nw_gear_monitor.states.classifier import Verdict

LEAST_NOISE_DB = 39.0
"""Below 40 dB an exponent has no magnitude worth telling; an estimate may be wrong by one."""
MOST = 65536
"""Samples that pairs are formed of, the first ones of the record."""
MOST_POINTS = 16384
"""Points of the correlation dimension, spread evenly over those."""
MOST_RECURRENCES = 8192
"""Samples whose recurrences are looked at, the first ones."""
MOST_STROBES = 4096
REFERENCES = 4000
MAP_DIMENSION, FLOW_DIMENSION, RECURRENCE_DIMENSION = 2, 5, 3
MAP_HORIZON = 20
PERIODS_AHEAD = 5
"""Mean periods for which neighbours are followed."""
LEAST_STROBED = 400
"""Strobes from which an exponent is taken of the section rather than of the samples."""
RADIUS = 0.2
"""Of a recurrence, in standard deviations."""
LIMITED = {
    "largest_exponent": MOST,
    "sample_entropy": MOST,
    "determinism": MOST_RECURRENCES,
    "correlation_dimension": MOST,
}
STRAIGHT = ("largest_exponent", "exponent_standard_error", "exponent_r_squared")
RECURRENCES = ("determinism", "recurrence_rate", "laminarity", "diagonal_entropy", "trapping_time")


def chaos(signal: Signal, verdict: Verdict, findings: Findings) -> None:
    """Add everything to the findings; signal.x is of the order of 1."""
    x = signal.x[:MOST]
    findings.add(STRAIGHT, lambda: _exponent(signal, x, verdict))
    findings.add(("zero_one_k",), lambda: {"zero_one_k": _zero_one(signal, verdict)})
    findings.add(("sample_entropy",), lambda: {"sample_entropy": sample_entropy(x)})
    findings.add(("permutation_entropy",), lambda: {"permutation_entropy": permutation_entropy(signal.x)})
    findings.add(("dispersion_entropy",), lambda: {"dispersion_entropy": dispersion_entropy(signal.x)})
    findings.add(RECURRENCES, lambda: _recurrences(signal, x[:MOST_RECURRENCES]))
    findings.add(("correlation_dimension",), lambda: _dimension(signal, x))
    for name, most in LIMITED.items():
        if signal.x.size > most and findings.values[name] is not None:
            findings.notes[name] = f"of the first {most} samples"


def _exponent(signal: Signal, x: Array, verdict: Verdict) -> Mapping[str, float]:
    """Exponent (nats per second, or per step of a map) by Rosenstein's method, where the state allows one."""
    if verdict.label in (*names.PERIODS, names.QUASI_PERIODIC, names.TRANSIENT):
        raise InputError("x", "a motion that doesn't repeat and doesn't drift", f"one that is {verdict.label}")
    if verdict.noise_db < LEAST_NOISE_DB:
        raise InputError(
            "x", "noise 40 dB or more below the signal", f"{verdict.noise_db:.0f} dB, or too coarse samples"
        )
    found = _divergence(_points(signal, x))
    if not found.exponential and signal.phase is not None:
        seen = _strobed_points(signal, signal.phase)
        found = found if seen is None else _divergence(seen)
    if not found.exponential:
        got = f"R squared {found.r_squared:.3f} over {found.growth:.2f} nats"
        raise InputError("x", "neighbours that part exponentially", got)
    return dict(zip(STRAIGHT, (found.exponent, found.standard_error, found.r_squared), strict=True))


@dataclass(frozen=True, eq=False)
class Points:
    """Points of the phase space, Theiler window, steps to follow, and steps per second (1 for a map)."""

    points: Array
    theiler: int
    horizon: int
    rate: float


def _divergence(given: Points) -> Divergence:
    return rosenstein(
        given.points, theiler=given.theiler, horizon=given.horizon, rate=given.rate, references=REFERENCES
    )


def _points(signal: Signal, x: Array) -> Points:
    """Those of a map, or delay vectors of samples."""
    period = mean_period(x)
    if signal.rate is None:
        points = embed(x, MAP_DIMENSION) if signal.v is None else strobed(x, signal.v[: x.size])
        return Points(points, period, MAP_HORIZON, 1.0)
    points = embed(x, FLOW_DIMENSION, max(correlation_lag(x) // 2, 1))
    return Points(points, period, min(PERIODS_AHEAD * period, x.size // 4), signal.rate)


def _strobed_points(signal: Signal, phase: Array) -> Points | None:
    """Those of the section, where both coordinates are known and strobes are many: for the few samples a period."""
    turns = float(phase[-1] - phase[0]) / (2.0 * np.pi)
    if signal.v is None or signal.rate is None or turns < LEAST_STROBED:
        return None
    points = strobed(section(phase, signal.x), section(phase, signal.v))[:MOST]
    return Points(points, mean_period(points[:, 0]), MAP_HORIZON, turns * signal.rate / (signal.x.size - 1))


def section(phase: Array, x: Array) -> Array:
    """One value, (turns,), each time the phase (samples,) passes a multiple of 2 pi (spline of degree 5)."""
    return np.ascontiguousarray(whole_turns(phase, x).values[:, 0])


def _zero_one(signal: Signal, verdict: Verdict) -> float:
    if verdict.label == names.PERIODS[0]:
        raise InputError("x", "a section that is more than one point and its noise", verdict.label)
    if verdict.label in names.PERIODS and verdict.noise_db < LEAST_NOISE_DB:
        raise InputError("x", f"a {verdict.label} with less noise", f"{verdict.noise_db:.0f} dB")
    if signal.rate is None:
        series = signal.x
    elif signal.phase is not None:
        series = section(signal.phase, signal.x)
    else:  # samples as they are would read as regular: one value each mean period doesn't
        series = signal.x[:: mean_period(signal.x)]
    return zero_one_test(series[:MOST_STROBES]).k


def _recurrences(signal: Signal, x: Array) -> Mapping[str, float]:
    flow = signal.rate is not None
    points = embed(x, RECURRENCE_DIMENSION if flow else 1, correlation_lag(x) if flow else 1)
    found = recurrence(points, radius=RADIUS * float(np.std(x)), theiler=mean_period(x) if flow else 0)
    numbers = (found.determinism, found.rate, found.laminarity, found.entropy, found.trapping_time)
    return dict(zip(RECURRENCES, numbers, strict=True))


def _dimension(signal: Signal, x: Array) -> Mapping[str, float]:
    if signal.rate is None:
        given = _points(signal, x)
        points, theiler = given.points, given.theiler
    else:
        points, theiler = embed(x, RECURRENCE_DIMENSION, correlation_lag(x)), mean_period(x)
    thin = max(math.ceil(len(points) / MOST_POINTS), 1)
    return {"correlation_dimension": correlation_dimension(points[::thin], theiler=max(theiler // thin, 1)).dimension}
