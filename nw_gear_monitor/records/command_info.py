"""`nw_gear info`: what is in a recording, in a wind file or in a file of rotor speed and torque."""

from __future__ import annotations

import json
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nw_gear_common.plain import one_line

if TYPE_CHECKING:
    from nw_gear_monitor.records.reader import Recording

RECORDING_SUFFIXES = (".mcap", ".damaged", ".db3")
WIND_SUFFIX = ".csv"
SHORT = 100
"""Longest text of one line of provenance; longer values are cut, `--json` has them whole."""

WALL_TIME = 1e9
"""Stamps above this are times of day (s since 1970); simulated time starts at 0."""


def info(
    path: Annotated[
        Path, typer.Argument(help="Folder of a recording, MCAP file, wind or drive file.", show_default=False)
    ],
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Say what is in a recording (topics, duration, provenance) or in a wind or drive file (rows, gaps, means)."""
    suffix = path.suffix.lower()
    if (suffix == WIND_SUFFIX and not path.is_dir()) or (path.is_file() and suffix not in RECORDING_SUFFIXES):
        from nw_gear_sim import drivefile, windfile  # noqa: PLC0415 - only where it is asked for

        found = drivefile.summary(path) if drivefile.recognised(path) else windfile.summary(path)
        typer.echo(json.dumps(found) if as_json else "\n".join(_column_lines(found)))
        return
    from nw_gear_monitor.records.reader import Recording  # noqa: PLC0415 - the readers of recordings are heavy

    with Recording.open(path, repair=True) as recording:
        lines = (one_line(line) for line in _recording_lines(recording))
        typer.echo(json.dumps(_as_object(recording)) if as_json else "\n".join(lines))


def _as_object(recording: Recording) -> dict[str, Any]:
    return {
        "duration": recording.duration,
        "complete": recording.complete,
        "topics": {name: {"type": t.type, "count": t.messages} for name, t in recording.topics.items()},
        "provenance": recording.provenance,
        "damage": recording.damage,
        "start": recording.start,
        "end": recording.end,
        "messages": recording.message_count,
    }


def _recording_lines(recording: Recording) -> list[str]:
    state = "complete" if recording.complete else f"damaged: {recording.damage}"
    lines = [
        f"recording  {recording.path}",
        f"state      {state}",
        f"start      {_moment(recording.start)}",
        f"duration   {recording.duration:.3f} s",
        f"messages   {recording.message_count}",
        "",
    ]
    width = max((len(name) for name in recording.topics), default=0)
    lines += [f"{name:<{width}}  {t.messages:>9}  {t.type}" for name, t in recording.topics.items()]
    for name, content in sorted(recording.provenance.items()):
        lines += ["", name, *(f"  {key} = {_short(value)}" for key, value in content.items())]
    return lines


def _moment(seconds: float) -> str:
    if seconds < WALL_TIME:
        return f"{seconds:.3f} s (simulated time)"
    return datetime.fromtimestamp(seconds, tz=UTC).isoformat(timespec="milliseconds")


def _short(value: str) -> str:
    first, *more = value.splitlines() or [""]
    if more:
        return f"{first[:SHORT]} ... ({len(more) + 1} lines)"
    return value if len(value) <= SHORT else f"{value[:SHORT]} ... ({len(value)} characters)"


def _column_lines(found: Mapping[str, Any]) -> list[str]:
    gaps = found["gaps"]
    lines = [f"{key:<13}{value}" for key, value in found.items() if key != "gaps"]
    lines.append(f"{'gaps':<13}{len(gaps)}")
    return lines + [f"  after {gap['start']}: {gap['seconds']:g} s to the next good row" for gap in gaps]
