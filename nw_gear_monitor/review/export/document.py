"""What the report says, as one JSON object: summary, states, alarms, truth, indicators, provenance."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from nw_gear_common import __version__, names
from nw_gear_common.tables import Table
from nw_gear_monitor.review import summary as summaries
from nw_gear_monitor.review.export.units import unit
from nw_gear_monitor.review.rundata import LEVEL_WORDS, RunData, Span
from nw_gear_monitor.review.summary import Range, StageSummary, Summary


def document(run: RunData) -> dict[str, Any]:
    """The object; numbers in SI units, NaN as null, times in seconds since the start of the run."""
    numbers = summaries.summarise(run)
    found = {
        "nw_gear": __version__,
        "source": str(run.source),
        "complete": run.complete,
        "remarks": list(run.remarks),
        "start": run.start,
        "end": run.end,
        "duration": run.duration,
        "headline": summaries.headline(run, numbers),
        "wind_from": summaries.wind_source(run),
        "configuration": summaries.configuration(run),
        "command": summaries.command(run),
        "versions": dict(summaries.versions(run)),
        "operating_range": _operating(numbers),
        "worst": None if numbers.worst is None else {"stage": numbers.worst[0], **_span(run, numbers.worst[1])},
        "stages": [_stage(run, row) for row in numbers.stages],
        "alarms": [_span(run, span) for span in numbers.alarms],
        "states": {s: [_span(run, span) for span in run.stage_spans(s)] for s in run.stage_names},
        "waveform": _waveform(run),
        "indicators": {m: _indicators("indicators", t) for m, t in run.indicators.items()},
        "bearing_indicators": {b: _indicators("bearing_indicators", t) for b, t in run.bearing_indicators.items()},
        "truth": {"message": run.truth_message, "last": dict(run.truth), "mean": dict(run.truth_means)},
        "topics": {name: {"type": kind, "count": count} for name, (kind, count) in run.topics.items()},
        "provenance": {name: dict(content) for name, content in run.provenance.items()},
    }
    return {key: _plain(value) for key, value in found.items()}


def _operating(numbers: Summary) -> dict[str, Any]:
    return {
        "wind_speed_m_per_s": _range(numbers.wind),
        "input_speed_rad_per_s": _range(numbers.speed),
        "input_torque_n_m": _range(numbers.torque),
        "input_power_w": _range(numbers.power),
    }


def _range(value: Range | None) -> dict[str, float] | None:
    return None if value is None else dataclasses.asdict(value)


def _span(run: RunData, span: Span) -> dict[str, Any]:
    return {
        "name": span.name,
        "start": span.start - run.start,
        "end": span.end - run.start,
        "level": LEVEL_WORDS.get(span.level, str(span.level)),
        "state": span.state,
        "reason": span.reason,
    }


def _stage(run: RunData, row: StageSummary) -> dict[str, Any]:
    return {
        "stage": row.stage,
        "mesh_frequency_hz": _range(row.frequency),
        "rms_m": row.rms,
        "peak_to_peak_m": row.peak_to_peak,
        "open_fraction": row.contact_lost,
        "states": dict(row.shares),
        "worst": None if row.worst is None else _span(run, row.worst),
    }


def _waveform(run: RunData) -> dict[str, Any] | None:
    wave = run.waveform
    if wave is None:
        return None
    meshes = {m: {"rms_m": wave.rms[m], "least_m": wave.lowest[m], "largest_m": wave.highest[m]} for m in names.MESHES}
    gaps = [{"start": gap.start - run.start, "seconds": gap.seconds} for gap in wave.gaps]
    return {"samples": wave.samples, "rate_hz": wave.rate, "gaps": gaps, "meshes": meshes}


def _indicators(kind: str, table: Table) -> dict[str, Any]:
    """Least, mean, largest and last value of every indicator, of the rows that the report keeps."""
    found = {}
    for column in table.columns:
        values = table.column(column)
        values = values[np.isfinite(values)]
        if column != "time" and len(values):
            low, mean, high = float(values.min()), float(values.mean()), float(values.max())
            numbers = {"least": low, "mean": mean, "largest": high, "last": float(values[-1])}
            found[column] = {"unit": unit(kind, column), **numbers}
    return found


def _plain(value: Any) -> Any:
    """The same with null for what JSON has no number for."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value
