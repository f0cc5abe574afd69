"""The state of a signal of unknown origin: recurrence first, then structure, then torus against chaos."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked
from nw_gear_monitor.states.cycles import Cycles, dominant_phase, from_points, from_samples
from nw_gear_monitor.states.prediction import predictability
from nw_gear_monitor.states.recurrence import LONGEST, recurrence

LEAST_STROBES = 128
RESOLUTION = 2e-3
"""What is left of the cycles counts as nothing below this share of the signal's standard deviation."""
STATE_COORDINATES = 5
TORUS_FAR = 0.5
STRUCTURE_NEAR = 0.85
NONLINEAR = 0.7


@dataclass(frozen=True)
class Verdict:
    """What a signal's window shows.

    Attributes:
        label: one of names.STATES.
        confidence: probability that the label is right, from 0 to 1, as calibrated on the benchmark.
        period: recurrence period in strobes, None where there is none.
        noise_db: estimated 20 log10(standard deviation of the signal / that of its noise); infinite without noise, NaN
            where it isn't known.
        reason: why, in one sentence.
        values: what was measured.
    """

    label: str
    confidence: float
    period: int | None
    noise_db: float
    reason: str
    values: dict[str, float]


def classify(x: Array, *, rate: float | None = None, strobe: Array | None = None, v: Array | None = None) -> Verdict:
    """State of a signal of unknown origin.

    Args:
        x: (samples,) one channel, any unit; without rate and strobe one point a period (a map, a strobed signal).
        rate: samples per second, Hz. Without `strobe` the strongest line gives the period.
        strobe: (samples,) unwrapped phase, rad; one strobe every 2 pi.
        v: (samples,) a second channel of the same system, such as the derivative of x.

    Raises:
        InputError: values that aren't finite, other lengths, a phase that doesn't grow, a rate that isn't positive.
    """
    x = checked.finite("x", x, 2)
    if v is not None and checked.finite("v", v).size != x.size:
        raise InputError("v", f"one value for each of {x.size} x", str(np.size(v)))
    if rate is not None:
        checked.positive("rate", rate)
    if strobe is not None:
        strobe = checked.phase("strobe", strobe, x.size)
    scale = float(np.max(np.abs(x)))
    if not (scale > 0.0 and float(np.std(x / scale)) > checked.LEAST_SPREAD):
        return _unknown("no vibration: the signal is constant")
    if rate is not None and strobe is None:
        strobe = dominant_phase(x) if x.size >= 64 else None
        if strobe is None:
            return _unknown("no line stands out to be strobed by")
    turns = x.size if strobe is None else int((strobe[-1] - strobe[0]) / (2.0 * np.pi)) - 1
    if turns < LEAST_STROBES:
        return _unknown(f"{max(turns, 0)} of at least {LEAST_STROBES} strobes seen")
    return _judge(from_points(x, v) if strobe is None else from_samples(x, strobe, v))


def _unknown(reason: str, values: dict[str, float] | None = None) -> Verdict:
    return Verdict(names.UNKNOWN, 0.0, None, float("nan"), reason, values or {})


def _judge(cycles: Cycles) -> Verdict:
    found = recurrence(cycles.rows)
    left = found.residual
    spread = float(np.sqrt(np.mean(left**2)))
    noise_db = -20.0 * np.log10(spread) if spread > 0.0 else float("inf")
    values = {"residual": spread, "floor": cycles.floor, "gain": found.gain}
    if spread < max(RESOLUTION, cycles.floor):
        return _periodic(found.period, noise_db, "cycles repeat to the resolution", values)
    states, targets = _coordinates(cycles.rows), _coordinates(left)
    shares = predictability(states, targets)
    values |= {"near": shares.near, "linear": shares.linear, "far": shares.far}
    if shares.far < TORUS_FAR:
        return Verdict(names.QUASI_PERIODIC, 0.9, None, float("nan"), "neighbours stay neighbours", values)
    if shares.near < STRUCTURE_NEAR and shares.near < NONLINEAR * shares.linear:
        return Verdict(names.CHAOTIC, 0.9, None, float("nan"), "predictable for a while only", values)
    if spread < 0.7:
        return _periodic(found.period, noise_db, "what differs between cycles is noise", values)
    return _unknown("nothing repeats and nothing can be predicted: noise", values)


def _periodic(period: int, noise_db: float, reason: str, values: dict[str, float]) -> Verdict:
    if period > LONGEST:
        return Verdict(names.UNKNOWN, 0.5, period, noise_db, f"period {period} is longer than {LONGEST}", values)
    return Verdict(names.PERIODS[period - 1], 0.9, period, noise_db, reason, values)


def _coordinates(rows: Array) -> Array:
    """The leading principal components of cycles, as many as stand out of the rest."""
    centred = rows - rows.mean(axis=0)
    _, singular, axes = np.linalg.svd(centred, full_matrices=False)
    if singular.size <= 2:
        return np.ascontiguousarray(centred)
    power = singular**2
    kept = int(np.sum(power > 4.0 * np.median(power) + 1e-4 * power[0]))
    return np.ascontiguousarray(centred @ axes[: min(max(kept, 1), STATE_COORDINATES)].T)
