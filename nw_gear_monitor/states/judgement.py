"""From a record to its state: recurrence, slow change, predictability, and how sure that is."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.states import noise
from nw_gear_monitor.states.confidence import confidence
from nw_gear_monitor.states.cycles import Record
from nw_gear_monitor.states.drift import trend
from nw_gear_monitor.states.prediction import CLOSEST, Predictability, predictability
from nw_gear_monitor.states.recurrence import LONGEST, Recurrence, recurrence, rms

LEAST_STROBES = 128
LEAST_HALF = 250
"""Strobes to a half that is judged by itself."""
RESOLUTION = 2e-3
"""What is left of the cycles counts as nothing below this share of the signal's standard deviation."""
COORDINATES = 5
STRUCTURE = 0.85
NONLINEAR = 0.8
TORUS_FAR = 0.12
TORUS_GROWTH = 2.5
TORUS_MOST = 0.5
MOSTLY = 0.7
"""Rest above which nothing is periodic about a signal."""
LOOKED_AT = 64
MOST_DRIFT, MOST_DRIFT_LONG = 0.5, 0.15
"""Slow change (rms, standard deviations) up to which a motion is periodic: of periods up to FEW, of longer ones."""
FEW = 2
FOLLOWED = 0.35
"""What a slow change may leave, as a share of it, where the rest is called nothing but that change."""
UNSTEADY = 0.5
"""Rest of a periodic motion, if it can be predicted this well, is no noise: the halves are compared."""
SAMPLING, JUMPS = 0.6, 0.15
"""Cycles that differ less than JUMPS, at few of their points, and by the place of their samples, don't differ."""
CONCENTRATED = 0.4
WEAK, NONLINEAR_WEAK = 0.1, 0.5
"""A rest below WEAK must be predicted by neighbours that much better than linearly to be called chaotic."""
SURE = 0.8
QUANTISED = 1.5
"""Rest, in steps of a quantised signal, that may be its rounding."""


@dataclass(frozen=True)
class Verdict:
    """What a signal's window shows.

    Attributes:
        label: one of names.STATES.
        confidence: least share of such labels that was right on the benchmark, from 0 to 1.
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


def unknown(reason: str) -> Verdict:
    """Nothing can be said."""
    return Verdict(names.UNKNOWN, 0.0, None, math.nan, reason, {})


def judge(signal: Record) -> Verdict:
    """State of a record.

    Args:
        signal: a record with at least two different values.
    """
    if signal.count < LEAST_STROBES:
        return unknown(f"{max(signal.count, 0)} of at least {LEAST_STROBES} strobes seen")
    verdict = _whole(signal)
    settled = (names.TRANSIENT, names.UNKNOWN, names.QUASI_PERIODIC)
    if verdict.label in settled or signal.count < 2 * LEAST_HALF:
        return verdict
    if verdict.period is not None and verdict.values.get("near", 1.0) > UNSTEADY:
        return verdict
    first, second = (_whole(half) for half in signal.halves())
    if _differ(first, second):
        reason = f"{first.label} in the first half, {second.label} in the second"
        return replace(verdict, label=names.TRANSIENT, period=None, reason=reason)
    return verdict


def _differ(first: Verdict, second: Verdict) -> bool:
    """Whether halves are surely in different states; a torus close to period n looks like that period for a while."""
    if first.label == second.label or min(first.confidence, second.confidence) < SURE:
        return False
    periods = [half.period for half in (first, second) if half.period is not None]
    return names.QUASI_PERIODIC not in (first.label, second.label) or min(periods, default=1) <= FEW


def _whole(signal: Record) -> Verdict:
    steps = [] if signal.phase is None else [noise.step(channel) for channel in signal.channels]
    resolution = max([RESOLUTION, *(QUANTISED * step for step in steps)])
    found = recurrence(signal, resolution)
    verdict = _of_rest(signal, found, np.zeros_like(found.rest), resolution)
    if verdict.period is not None:
        return verdict
    slow = trend(found.rest, found.period)
    moved, left = rms(slow), rms(found.rest - slow)
    few = found.period <= FEW
    if 0.0 < moved < (MOST_DRIFT if few else MOST_DRIFT_LONG):
        followed = _of_rest(signal, found, slow, resolution)
        if followed.period is not None:
            return followed
    if few and left < FOLLOWED * moved:  # nothing but a slow change
        values = verdict.values | {"drift": moved, "rest": left}
        if moved < MOST_DRIFT:
            return _periodic(signal, found, values, "what differs between cycles changes slowly")
        return replace(verdict, label=names.TRANSIENT, period=None, reason="the waveform moves too far", values=values)
    return verdict


def _of_rest(signal: Record, found: Recurrence, slow: Array, resolution: float) -> Verdict:
    """State from what the periodic part and a slow change leave."""
    rest, first = found.rest - slow, found.first - slow
    values = {"n": float(found.period), "rest": rms(rest), "drift": rms(slow)}
    values |= {"strength": found.strength, "refused": found.refused}
    if rms(rest) <= resolution:
        return _periodic(signal, found, values, "cycles repeat to the resolution")
    if _from_sampling(signal, rest, found.period):
        return _periodic(signal, found, values, "cycles differ by where they are sampled")
    axes = _axes(rest)
    shares = predictability(_coordinates(first), first @ axes, rest @ axes)
    values |= {"near": shares.near, "linear": shares.linear, "far": shares.far}
    growth = shares.far / max(shares.near, 1e-12)
    if shares.far < TORUS_FAR or (shares.far < TORUS_MOST and growth < TORUS_GROWTH):
        return _torus(signal, first, values)
    if shares.near < STRUCTURE and shares.near < _nonlinear(rms(rest)) * shares.linear:
        level = _noise(signal, shares, rms(rest))
        return _verdict(names.CHAOTIC, None, level, "predictable for some cycles, not for many", values)
    if rms(rest) < MOSTLY:
        return _periodic(signal, found, values, "what differs between cycles is noise")
    return Verdict(names.UNKNOWN, 0.0, None, math.nan, "nothing repeats and nothing can be predicted: noise", values)


def _nonlinear(left: float) -> float:
    return NONLINEAR_WEAK if left < WEAK else NONLINEAR


def _from_sampling(signal: Record, rest: Array, period: int) -> bool:
    """Whether cycles differ because a jump falls before a sample or after it."""
    energy = np.sum(rest**2, axis=0)
    points = float(np.sum(energy) ** 2 / np.sum(energy**2)) / energy.size
    return rms(rest) < JUMPS and points < CONCENTRATED and signal.sampling(rest, period) < SAMPLING


def _periodic(signal: Record, found: Recurrence, values: dict[str, float], reason: str) -> Verdict:
    if signal.phase is None:
        level = values["rest"]
    else:
        level = float(np.mean([noise.scatter(c, signal.phase, found.period) for c in signal.channels]))
        level = min(level, values["rest"] * 1.3) if values["drift"] > 0.0 else level
    return _verdict(names.PERIODS[found.period - 1], found.period, level, reason, values)


def _torus(signal: Record, first: Array, values: dict[str, float]) -> Verdict:
    """Quasi-periodic, unless a period longer than LONGEST explains all but the noise."""
    share = min(values["near"], values["linear"], values["far"]) / (1.0 + 1.0 / CLOSEST)
    level = _noise(signal, None, math.sqrt(share) * values["rest"])
    size = len(first)
    for n in range(LONGEST + 1, min(LOOKED_AT, size // 8) + 1):
        left = math.sqrt(sum(float(np.sum((first[g::n] - first[g::n].mean(axis=0)) ** 2)) for g in range(n)))
        if left / math.sqrt((size - n) * first.shape[1]) < max(1.05 * level, RESOLUTION):
            reason = f"period {n}, longer than {LONGEST}, or a torus close to it"
            return Verdict(names.UNKNOWN, 0.0, n, noise.decibels(level), reason, values)
    return _verdict(names.QUASI_PERIODIC, None, level, "neighbours stay neighbours for ever", values)


def _noise(signal: Record, shares: Predictability | None, error: float) -> float:
    """Noise of a motion that isn't periodic, in standard deviations of the signal."""
    if signal.phase is not None:
        return float(np.mean([noise.floor(channel) for channel in signal.channels]))
    if shares is None:
        return error
    return error * math.sqrt(shares.near / (1.0 + shares.expansion))


def _verdict(label: str, period: int | None, level: float, reason: str, values: dict[str, float]) -> Verdict:
    return Verdict(label, confidence(label, values), period, noise.decibels(level), reason, values)


def _axes(rows: Array) -> Array:
    """The leading principal directions of cycles, (points, directions), as many as stand out of the rest."""
    power, axes = np.linalg.eigh(rows.T @ rows)
    if power.size <= 2:
        return np.eye(power.size)
    kept = int(np.sum(power > 4.0 * np.median(power) + 1e-4 * power[-1]))
    return np.asarray(axes[:, -min(max(kept, 1), COORDINATES) :])


def _coordinates(rows: Array) -> Array:
    return np.ascontiguousarray(rows @ _axes(rows))
