"""Everything about one channel: state, indicators, lines of its envelope."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.analyse import lines
from nw_gear_monitor.analyse.chaos import chaos
from nw_gear_monitor.analyse.findings import Findings
from nw_gear_monitor.analyse.noise import noise_db
from nw_gear_monitor.analyse.options import Options
from nw_gear_monitor.analyse.select import Signal
from nw_gear_monitor.indicators.crest_factor import crest_factor
from nw_gear_monitor.indicators.kurtosis import kurtosis
from nw_gear_monitor.indicators.peak_to_peak import peak_to_peak
from nw_gear_monitor.indicators.rms import rms
from nw_gear_monitor.signals.kurtogram import Band, kurtogram, most_impulsive
from nw_gear_monitor.states.classifier import Verdict, classify

LEAST_SCORE = 5.0
"""Of the most impulsive band; below it is chance."""


@dataclass(frozen=True, eq=False)
class Envelope:
    """Envelope spectrum of a band and its lines.

    Attributes:
        band: Hz; chosen: whether by the kurtogram, as none was given.
        spectrum: of the envelope; peaks: its lines, strongest first; bearing: those at the orders asked for.
    """

    band: tuple[float, float]
    chosen: bool
    spectrum: lines.Spectrum
    peaks: tuple[lines.Line, ...]
    bearing: tuple[lines.Line, ...]


@dataclass(frozen=True, eq=False)
class Result:
    """What was found out about a channel.

    Attributes:
        signal: the channel; verdict: its state; findings: numbers, and reasons where there are none.
        impulsive: the most impulsive band; None where it isn't more than chance, or for a map.
        envelope: where a band or bearing orders were asked for; shaft: lines at multiples of the shaft's speed.
    """

    signal: Signal
    verdict: Verdict
    findings: Findings
    impulsive: Band | None
    envelope: Envelope | None
    shaft: tuple[lines.Line, ...]


def measure(signal: Signal, options: Options) -> Result:
    """Find out everything about one channel; errors name it.

    Raises:
        InputError: a band beyond half the sample rate or without vibration, a record too short for it, too few samples
            for each strobe.
    """
    try:
        return _measured(signal, options)
    except InputError as error:
        raise InputError(f"{signal.name}: {error.place}", error.expected, error.got) from None


def _measured(signal: Signal, options: Options) -> Result:
    exponent = int(np.frexp(np.max(np.abs(signal.x)))[1])
    unit = replace(signal, x=np.ldexp(signal.x, -exponent), v=_unit(signal.v))
    impulsive = None if signal.rate is None else _impulsive(unit.x, signal.rate)
    envelope, shaft = _envelope(signal, options, impulsive), tuple[lines.Line, ...]()
    if signal.rate is not None and options.shaft_rate is not None:
        shaft = lines.shaft_lines(signal.x, signal.rate, options.shaft_rate)
    verdict = _verdict(unit)
    findings = Findings()
    _shape(unit.x, exponent, findings)
    chaos(unit, verdict, findings)
    return Result(signal, verdict, findings, impulsive, envelope, shaft)


def _unit(v: Array | None) -> Array | None:
    return None if v is None else np.asarray(np.ldexp(v, -int(np.frexp(np.max(np.abs(v)))[1])))


def _verdict(signal: Signal) -> Verdict:
    """State of a signal; one whose strongest line is too fast to be strobed by is unknown, a strobe too fast wrong.

    Where the motion doesn't repeat, the noise that the classifier can't predict and that in the differences are both
    too large, if anything: the smaller one counts.
    """
    try:
        verdict = classify(signal.x, rate=signal.rate, strobe=signal.phase, v=signal.v)
        if signal.rate is None or verdict.label in names.PERIODS:
            return verdict
        return replace(verdict, noise_db=float(np.fmax(verdict.noise_db, noise_db(signal.x))))
    except InputError as error:
        if signal.phase is not None:
            raise
        reason = f"{error.place}: expected {error.expected}, got {error.got}"
        return Verdict(names.UNKNOWN, 0.0, None, math.nan, reason, {})


def _shape(x: Array, exponent: int, findings: Findings) -> None:
    """Moments; x is the signal over 2^exponent."""
    for name, value in (("mean", float(np.mean(x))), ("rms", rms(x)), ("peak_to_peak", peak_to_peak(x))):
        with np.errstate(over="ignore"):
            findings.put(name, float(np.ldexp(value, exponent)))
    findings.put("crest_factor", crest_factor(x))
    findings.put("kurtosis", kurtosis(x))


def _impulsive(x: Array, rate: float) -> Band | None:
    try:
        band = most_impulsive(kurtogram(x, rate))
    except InputError:
        return None
    return band if band.score >= LEAST_SCORE else None


def _envelope(signal: Signal, options: Options, impulsive: Band | None) -> Envelope | None:
    if signal.rate is None or (options.envelope is None and not options.bearing_orders):
        return None
    band = options.envelope
    if band is None:
        if impulsive is None:
            raise InputError("--bearing-orders", "--envelope LOW:HIGH", "none, and no band is impulsive")
        band = impulsive.low, impulsive.high
    spectrum = lines.envelope_spectrum(signal.x, signal.rate, band)
    bearing = lines.bearing_lines(spectrum, options.shaft_rate or 0.0, options.bearing_orders)
    return Envelope(band, options.envelope is None, spectrum, lines.peaks(spectrum), bearing)


def as_object(result: Result) -> dict[str, Any]:
    """What `--json` says about a channel."""
    verdict = result.verdict
    found: dict[str, Any] = {
        "state": verdict.label,
        "confidence": _finite(verdict.confidence),
        "period": verdict.period,
        "noise_db": _finite(verdict.noise_db),
        "reason": verdict.reason,
        "indicators": dict(result.findings.values),
        "notes": dict(result.findings.notes),
    }
    if result.impulsive is not None:
        band = result.impulsive
        found["impulsive_band"] = {
            "low_hz": band.low,
            "high_hz": band.high,
            "kurtosis": band.kurtosis,
            "score": band.score,
        }
    if result.envelope is not None:
        envelope = result.envelope
        found["envelope_band_hz"] = list(envelope.band)
        found["envelope_band_from"] = "kurtogram" if envelope.chosen else "option"
        found["envelope_peaks_hz"] = [line.hz for line in envelope.peaks]
        found["envelope_peaks"] = [_line(line) for line in envelope.peaks]
        if envelope.bearing:
            found["bearing_lines"] = [_line(line) for line in envelope.bearing]
    if result.shaft:
        found["shaft_lines"] = [_line(line) for line in result.shaft]
    return found


def _finite(number: float) -> float | None:
    return float(number) if math.isfinite(number) else None


def _line(line: lines.Line) -> Mapping[str, float]:
    values = {"order": line.order, "hz": line.hz, "amplitude": line.amplitude, "prominence": line.prominence}
    return {name: value for name, value in values.items() if value is not None and math.isfinite(value)}
