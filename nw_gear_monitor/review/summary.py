"""The numbers and words at the top of the report, computed from `RunData`."""

from __future__ import annotations

import contextlib
import json
import math
import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.review.rundata import LEVEL_WORDS, OK, TURNING, RunData, Span

RPM = 30.0 / math.pi
SEVERITY = (names.UNKNOWN, names.STALE, "period-1", names.TRANSIENT, "period-n", names.QUASI_PERIODIC, names.CHAOTIC)
"""From least to most: what isn't known isn't worse than what is."""


@dataclass(frozen=True)
class Range:
    """Least, mean and largest value."""

    low: float
    mean: float
    high: float


@dataclass(frozen=True)
class StageSummary:
    """One row of the table of stages.

    Attributes:
        stage: I, II or III.
        frequency: mesh frequency (Hz), None where there is no waveform.
        rms: largest root mean square of its meshes' displacements (m), about the mean.
        peak_to_peak: largest spread of one of its meshes' displacements (m).
        contact_lost: share of the time that one of its meshes was open, the largest; None where the truth isn't known.
        shares: label to share of the time with a label, most first.
        worst: the worst stretch, None where the monitor said nothing.
    """

    stage: str
    frequency: Range | None
    rms: float
    peak_to_peak: float
    contact_lost: float | None
    shares: Mapping[str, float]
    worst: Span | None


@dataclass(frozen=True)
class Summary:
    """What a reader should know before any figure (SI units; None where it wasn't recorded)."""

    wind: Range | None
    speed: Range | None
    torque: Range | None
    power: Range | None
    stages: tuple[StageSummary, ...]
    alarms: tuple[Span, ...]
    turning: bool

    @property
    def worst(self) -> tuple[str, Span] | None:
        """Stage and stretch of the worst state of the run."""
        found = [(row.stage, row.worst) for row in self.stages if row.worst is not None]
        return max(found, key=lambda pair: severity(pair[1]), default=None)


def severity(span: Span) -> tuple[int, int]:
    """Order of states: by label first, then by how long."""
    kind = "period-n" if span.state in names.PERIODS[1:] else span.state
    return (SEVERITY.index(kind) if kind in SEVERITY else 0, round(1e3 * span.duration))


def shares(spans: tuple[Span, ...]) -> dict[str, float]:
    """Share of the labelled time that each label had, most first."""
    time: dict[str, float] = {}
    for span in spans:
        if span.state:
            time[span.state] = time.get(span.state, 0.0) + span.duration
    total = sum(time.values())
    if total == 0.0:
        return {state: 1.0 / len(time) for state in time}
    return dict(sorted(((state, seconds / total) for state, seconds in time.items()), key=lambda pair: -pair[1]))


def summarise(run: RunData) -> Summary:
    """Compute the summary of a run."""
    speed = torque = power = None
    if run.speed is not None and run.torque is not None:
        w, t = run.speed.select(("ring",)), run.torque.select(("ring",))
        speed, torque = _range(w.low, w.mean, w.high), _range(t.low, t.mean, t.high)
        if len(w.time) == len(t.time):
            p = w.mean * t.mean
            power = _range(p, p, p)
    stages = tuple(_stage(run, stage) for stage in names.STAGES)
    frequencies = [row.frequency for row in stages if row.frequency is not None]
    return Summary(
        wind=None if run.wind is None else _range(run.wind.low, run.wind.mean, run.wind.high),
        speed=speed,
        torque=torque,
        power=power,
        stages=stages,
        alarms=alarms(run),
        turning=not frequencies or any(f.high > TURNING for f in frequencies),
    )


def alarms(run: RunData) -> tuple[Span, ...]:
    """Every stretch of a status above OK, in order of time."""
    return tuple(
        sorted((s for own in run.spans.values() for s in own if s.level != OK), key=lambda s: (s.start, s.name))
    )


def _range(low: Array, mean: Array, high: Array) -> Range:
    return Range(float(np.min(low)), float(np.mean(mean)), float(np.max(high)))


def _stage(run: RunData, stage: str) -> StageSummary:
    spans = run.stage_spans(stage)
    worst = max((s for s in spans if s.state), key=severity, default=None)
    wave = run.waveform
    contact = max((c for m in names.MESHES_OF_STAGE[stage] if (c := run.contact("open", m)) is not None), default=None)
    if wave is None:
        return StageSummary(stage, None, math.nan, math.nan, contact, shares(spans), worst)
    f = wave.mesh_frequency.select((stage,))
    meshes = names.MESHES_OF_STAGE[stage]
    return StageSummary(
        stage=stage,
        frequency=_range(np.abs(f.low), np.abs(f.mean), np.abs(f.high)),
        rms=max(wave.rms[m] for m in meshes),
        peak_to_peak=max(wave.highest[m] - wave.lowest[m] for m in meshes),
        contact_lost=contact,
        shares=shares(spans),
        worst=worst,
    )


# --- words ------------------------------------------------------------------------------------------------------------


def in_words(value: Range | None, scale: float, unit: str, digits: int = 2) -> str:
    """`mean (low to high) unit`."""
    if value is None:
        return "not recorded"
    low, mean, high = (f"{scale * v:.{digits}f}" for v in (value.low, value.mean, value.high))
    return f"{mean} {unit}" if low == high else f"{mean} {unit} ({low} to {high})"


def when(run: RunData) -> str:
    """Begin of the run in words."""
    created = run.provenance.get("nw_gear.run", {}).get("created", "")
    if run.wall_time:
        return datetime.fromtimestamp(run.start, UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
    with contextlib.suppress(ValueError):
        created = datetime.fromisoformat(created).astimezone(UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
    return f"{created or 'date not recorded'} (simulated time from {run.start:.1f} s)"


def parameters(run: RunData, node: str) -> Mapping[str, str]:
    """Parameters of a node as they were recorded, empty where they weren't."""
    return run.provenance.get(f"nw_gear.node.{node}", {})


def wind_source(run: RunData) -> str:
    """Where the wind came from, in words."""
    said = run.spans.get("wind_node: wind", ())
    if said:
        return said[-1].reason
    values = parameters(run, "wind_node")
    if not values:
        return "not recorded"
    parts = [values.get("source", "unknown source")]
    if values.get("source") == "file":
        parts.append(values.get("file", ""))
    if "seed" in values:
        parts.append(f"seed {values['seed']}")
    return ", ".join(part for part in parts if part)


def command(run: RunData) -> str:
    """The command that started the run: what the starter gave as provenance, else the recorder's own command line."""
    found = run.provenance.get("nw_gear.run", {})
    try:
        given = json.loads(found.get("provenance", "")).get("command_line")
    except (ValueError, AttributeError):
        given = None
    if isinstance(given, list):
        return shlex.join([Path(str(given[0])).name, *map(str, given[1:])]) if given else "not recorded"
    return given if isinstance(given, str) else found.get("command_line", "not recorded")


def configuration(run: RunData) -> str:
    """Which configuration ran, in words."""
    values = parameters(run, "gear_sim_node")
    if not values:
        return "not recorded"
    extra = [f"{key} {values[key]}" for key in ("excitation", "start", "real_time_factor") if values.get(key)]
    return ", ".join([values.get("config") or "default gearbox", *(part.replace("_", " ") for part in extra)])


def versions(run: RunData) -> Mapping[str, str]:
    """Versions of the software that made the recording."""
    text = run.provenance.get("nw_gear.run", {}).get("versions", "")
    try:
        found = json.loads(text) if text else {}
    except ValueError:
        return {"versions": text}
    return {str(k): str(v) for k, v in found.items()} if isinstance(found, dict) else {"versions": text}


def headline(run: RunData, summary: Summary) -> str:
    """One sentence about the worst that happened."""
    if not run.monitored:
        return "No monitor was recorded: the states of the stages are not known."
    if not summary.turning:
        return "The gearbox stood still: there is no state to tell."
    if summary.worst is None:
        return "The monitor published no state."
    _stage_name, span = summary.worst
    if span.state in (names.UNKNOWN, names.STALE):
        return f"No stage got a label: {span.reason}"
    found = [(row.stage, row.shares.get(span.state, 0.0)) for row in summary.stages]
    where = ", ".join(f"stage {stage} {100 * share:.0f} %" for stage, share in found if share > 0.0)
    if span.state == names.PERIODS[0]:
        return f"No stage was worse than {span.state} ({where} of the time watched)"
    reason = f": {span.reason}" if span.reason else ""
    return f"Worst state: {span.state} ({where} of the time watched){reason}"


def level_words(level: int) -> str:
    """Level of a diagnostic status in words."""
    return LEVEL_WORDS.get(level, f"level {level}")
