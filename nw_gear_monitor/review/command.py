"""`nw_gear review`: the report of a recording as one self-contained page, or its data for other programs."""

from __future__ import annotations

import json
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nw_gear_common.errors import InputError
from nw_gear_monitor.review.output import (
    FOLDERS,
    check_folder,
    check_output,
    default_output,
    find_recording,
    name_of,
    write,
)

if TYPE_CHECKING:
    from nw_gear_monitor.review.rundata import RunData


class Format(StrEnum):
    """What can be written."""

    HTML = "html"
    PARQUET = "parquet"
    CSV = "csv"
    JSON = "json"


def review(
    run: Annotated[Path, typer.Argument(help="Folder of a run, or of a recording.", show_default=False)],
    other: Annotated[Path | None, typer.Argument(help="Another run: both side by side.", show_default=False)] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="File (html, json) or new folder (parquet, csv); default in the run's."),
    ] = None,
    kind: Annotated[
        Format, typer.Option("--format", help="html: the report; parquet, csv: all data; json: what the report says.")
    ] = Format.HTML,
    zoom: Annotated[
        list[str] | None,
        typer.Option("--zoom", help="START:STOP, s since start: show every sample there (repeatable)."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Write the report of a recording, compare two, or export the data."""
    folder = find_recording(run)
    second = None if other is None else find_recording(other)
    if second is not None and kind is not Format.HTML:
        raise InputError(f"--format {kind.value}", "html with two runs", kind.value)
    spans = [span(text) for text in zoom or []]
    if spans and kind is not Format.HTML:
        raise InputError("--zoom", "--format html", f"--format {kind.value}")
    goal = output or default_output(folder, kind.value, second)
    (check_folder if kind.value in FOLDERS else check_output)(goal)
    is_folder = kind.value in FOLDERS
    found = _export(folder, goal, kind.value) if is_folder else _report(folder, second, goal, kind, spans)
    _progress("")
    print(json.dumps(found) if as_json else goal)


def span(text: str) -> tuple[float, float]:
    """Begin and end of a stretch of time, s since the start of the run, from `START:STOP`.

    Raises:
        InputError: it isn't two ascending numbers.
    """
    begin, _, end = text.partition(":")
    try:
        found = float(begin), float(end)
    except ValueError:
        raise InputError(f"--zoom {text}", "START:STOP in seconds since the start", "something else") from None
    if not 0.0 <= found[0] < found[1] < float("inf"):
        raise InputError(f"--zoom {text}", "0 <= START < STOP", "another order")
    return found


def _report(
    folder: Path, second: Path | None, goal: Path, kind: Format, spans: list[tuple[float, float]]
) -> dict[str, Any]:
    from nw_gear_monitor.review import read  # noqa: PLC0415 - heavy: bokeh and the readers of recordings

    data = read.read(folder, _progress, spans)
    found = {"report": str(goal), "format": kind.value, **_about(data)}
    if kind is Format.JSON:
        from nw_gear_monitor.review.export.document import document  # noqa: PLC0415 - as above

        write(goal, json.dumps(document(data), allow_nan=False, indent=1) + "\n")
        return found
    from nw_gear_monitor.review import page  # noqa: PLC0415 - as above

    if second is None:
        _progress("drawing")
        write(goal, page.render(data))
        return found
    from nw_gear_monitor.review import comparison  # noqa: PLC0415 - as above

    beside = read.read(second, _progress, spans)
    _progress("drawing")
    write(goal, comparison.render(data, beside, (name_of(folder), name_of(second))))
    return {**found, "other": _about(beside)}


def _about(data: RunData) -> dict[str, Any]:
    from nw_gear_monitor.review import summary  # noqa: PLC0415 - as above

    states = {row.stage: row.shares for row in summary.summarise(data).stages}
    return {"duration": data.duration, "complete": data.complete, "states": states}


def _export(folder: Path, goal: Path, kind: str) -> dict[str, Any]:
    from nw_gear_monitor.review.export.run import export  # noqa: PLC0415 - pyarrow is heavy

    files, remarks = export(folder, goal, kind, _progress)
    _progress("")
    for words in remarks:
        print(words, file=sys.stderr)
    return {"folder": str(goal), "format": kind, "files": files, "remarks": remarks}


def _progress(words: str) -> None:
    """Say on standard error what goes on: in place on a terminal (no words clear the line), a line each elsewhere."""
    if sys.stderr.isatty():
        print(f"\r\x1b[K{words}", end="", file=sys.stderr, flush=True)
    elif words:
        print(words, file=sys.stderr, flush=True)
