"""What the monitor says about stages, bearings, the stream and itself: level, label, reason and values (pure)."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from nw_gear_common import names
from nw_gear_monitor.labelling import StageReport
from nw_gear_monitor.machine import Bearing, Machine
from nw_gear_monitor.pipeline import BearingForce, Hop
from nw_gear_monitor.signals.stream import Continuity
from nw_gear_monitor.stage_state import Evidence

OK, WARN, ERROR, STALE = range(4)
"""Levels of diagnostic_msgs/DiagnosticStatus."""


@dataclass(frozen=True)
class Status:
    """One entry of `/diagnostics`.

    Attributes:
        name: what it is about, for instance `stage II`.
        level: OK, WARN, ERROR or STALE.
        label: state label, "" where the entry is about no state.
        reason: the rest of the message.
        values: further values; keys carry their unit.
    """

    name: str
    level: int
    label: str
    reason: str
    values: dict[str, str] = field(default_factory=dict)

    @property
    def message(self) -> str:
        """`<label>: <reason>`, or the reason alone."""
        return f"{self.label}: {self.reason}" if self.label else self.reason

    @property
    def pairs(self) -> dict[str, str]:
        """The values with the label as `state` first."""
        return {"state": self.label, **self.values} if self.label else self.values


def level_of(label: str) -> int:
    """WARN for motion that separates tooth flanks or repeats irregularly, STALE for silence, else OK."""
    if label == names.STALE:
        return STALE
    return WARN if label == names.CHAOTIC or label in names.PERIODS[1:] else OK


def stage_statuses(hop: Hop, machine: Machine) -> list[Status]:
    """One entry per stage and per bearing."""
    stages = [_stage(stage, report, hop, machine) for stage, report in hop.stages.items()]
    return stages + [_bearing(b, hop.bearings[b.name]) for b in machine.bearings if b.name in hop.bearings]


def stale(statuses: list[Status], silent_seconds: float) -> list[Status]:
    """The same entries after the samples stopped."""
    reason = f"no samples for {silent_seconds:.0f} s"
    return [replace(s, level=STALE, label=names.STALE, reason=reason, values={}) for s in statuses]


def waiting(topic: str, machine: Machine) -> list[Status]:
    """The entries of the stages before the first second."""
    return [Status(f"stage {s}", OK, names.UNKNOWN, f"no whole second of {topic} yet") for s in machine.stage_names]


def stream_status(now: Continuity, before: Continuity) -> Status:
    """The waveform's gaps, restarts and unusable blocks, WARN when there are new ones since `before`; dead channels."""
    news = []
    if now.gaps > before.gaps:
        news.append(now.last_gap)
    if now.restarts > before.restarts:
        news.append(now.last_restart)
    if now.malformed > before.malformed:
        news.append(f"dropped {now.malformed - before.malformed} malformed block(s), the last: {now.last_malformed}")
    if now.repeated > before.repeated or now.disordered > before.disordered:
        news.append(now.last_late)
    if now.constant:
        news.append(f"constant: {', '.join(now.constant)}")
    values = {
        "blocks (1)": str(now.blocks),
        "gaps (1)": str(now.gaps),
        "lost (s)": f"{now.lost_seconds:.6g}",
        "restarts (1)": str(now.restarts),
        "malformed blocks (1)": str(now.malformed),
        "blocks that came twice (1)": str(now.repeated),
        "blocks out of order (1)": str(now.disordered),
        "constant columns": ", ".join(now.constant),
        "last break": now.last_break,
        "last malformed": now.last_malformed,
        "last late": now.last_late,
    }
    return Status("stream", WARN if news else OK, "", "; ".join(news) or "contiguous", values)


def _stage(stage: str, report: StageReport, hop: Hop, machine: Machine) -> Status:
    unit = machine.channel(machine.members[stage][0]).unit
    values = {} if report.evidence is None else _values(report.evidence, unit)
    values["state of this window"] = report.window_state.label
    for channel in machine.members[stage]:
        rms = hop.indicators[channel].column("rms")[0]
        values[f"rms {channel} ({unit})"] = f"{rms:.4g}"
    return Status(f"stage {stage}", level_of(report.state.label), report.state.label, report.state.reason, values)


def _values(e: Evidence, unit: str) -> dict[str, str]:
    found = f"f_{e.subharmonic_stage}/{e.subharmonic_order}" if e.subharmonic_stage else "none"
    return {
        "window (s)": str(e.seconds),
        "rho (1)": f"{e.rho:.4g}",
        "white noise in rho (1)": f"{e.noise:.4g}",
        "r after a common period (1)": f"{e.repetition:.4g}",
        "tau (1)": f"{e.tau:.4g}",
        "K (1)": f"{e.k:.4g}",
        "subharmonic": found,
        "subharmonic order (1)": str(e.subharmonic_order),
        "subharmonic share (1)": f"{e.subharmonic_share:.4g}",
        "strongest unlisted order (1)": f"{e.unlisted_order:.5g}",
        "lines used (1)": str(e.lines),
        "speed spread (1)": f"{e.speed_spread:.4g}",
        "fastest speed change (1/s)": f"{e.speed_rate:.4g}",
        "load spread (1)": f"{e.load_spread:.4g}",
        f"deviation ({unit})": f"{e.deviation:.4g}",
    }


def _bearing(bearing: Bearing, force: BearingForce) -> Status:
    unit = bearing.unit
    numbers = {"mean": force.mean, "rms": force.rms, "peak": force.peak}
    values = {f"{name} ({unit})": f"{number:.6g}" for name, number in numbers.items()}
    level = f"force {force.mean / 1e3:.4g} kN" if unit == "N" else f"rms {force.rms:.4g} {unit}"
    reason = f"{level}; a bearing carries no state of its own"
    return Status(f"bearing {bearing.name}", OK, names.UNKNOWN, reason, values)
