"""`nw_gear review`: the report of a recording as one self-contained page."""

from __future__ import annotations

import contextlib
import json
import os
import sys
import tempfile
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from nw_gear_common.errors import InputError

RECORDING = "recording"
"""Name of the recording inside the folder of a run."""


class Format(StrEnum):
    """What can be written."""

    HTML = "html"


def review(
    run: Annotated[Path, typer.Argument(help="Folder of a run, or of a recording.", show_default=False)],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The report (default report.html in the folder of the run).")
    ] = None,
    kind: Annotated[Format, typer.Option("--format", help="What to write.")] = Format.HTML,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Write the report of a recording: wind, load, vibration, spectra, states, indicators, alarms, provenance."""
    folder = find_recording(run)
    page = output or default_output(folder)
    check_output(page)
    from nw_gear_monitor.review import read, summary  # noqa: PLC0415 - heavy: bokeh and the readers of recordings
    from nw_gear_monitor.review.page import render  # noqa: PLC0415

    data = read.read(folder, _progress)
    _progress("drawing")
    write(page, render(data))
    _progress("")
    if as_json:
        states = {row.stage: row.shares for row in summary.summarise(data).stages}
        found = {
            "report": str(page),
            "format": kind.value,
            "duration": data.duration,
            "complete": data.complete,
            "states": states,
        }
        print(json.dumps(found))
    else:
        print(page)


def find_recording(run: Path) -> Path:
    """The recording that a path stands for: the folder itself, or `recording` in the folder of a run.

    Raises:
        InputError: there is no such folder, or nothing of a recording in it.
    """
    if not run.is_dir():
        raise InputError(
            str(run), "the folder of a run or of a recording", "no such folder" if not run.exists() else "a file"
        )
    for folder in (run, run / RECORDING):
        if (folder / "metadata.yaml").is_file() or any(folder.glob("*.mcap")):
            return folder
    raise InputError(str(run), "a recording (metadata.yaml, *.mcap), or a run with one in it", "neither")


def default_output(recording: Path) -> Path:
    """Where the report goes by default: into the folder of the run, else beside the recording, under its name."""
    recording = recording.resolve()
    return recording.parent / ("report.html" if recording.name == RECORDING else f"{recording.name}_report.html")


def check_output(page: Path) -> None:
    """Make sure that the report can be written, before any work is done.

    Raises:
        InputError: its folder is missing or read-only, or its name is a folder's.
    """
    if not page.parent.is_dir():
        raise InputError(f"-o {page}", "a file in a folder that exists", f"no folder {page.parent}")
    if page.is_dir():
        raise InputError(f"-o {page}", "the name of a file", "a folder")
    if not os.access(page.parent, os.W_OK):
        raise InputError(f"-o {page}", "a folder that can be written to", f"{page.parent} is read-only")


def write(page: Path, text: str) -> None:
    """Write a file as a whole or not at all; one that is there is replaced.

    Raises:
        InputError: the file can't be written (no space, no right).
    """
    partial = None
    try:
        with tempfile.NamedTemporaryFile(
            "w", encoding="utf-8", dir=page.parent, prefix=f".{page.name}.", delete=False
        ) as file:
            partial = Path(file.name)
            file.write(text)
        mask = os.umask(0)
        os.umask(mask)
        partial.chmod(0o666 & ~mask)
        partial.replace(page)
        partial = None
    except OSError as error:
        raise InputError(f"-o {page}", "a file that can be written", error.strerror or str(error)) from None
    finally:
        if partial is not None:
            with contextlib.suppress(OSError):
                partial.unlink()


def _progress(words: str) -> None:
    """Say on standard error what goes on: in place on a terminal (no words clear the line), a line each elsewhere."""
    if sys.stderr.isatty():
        print(f"\r\x1b[K{words}", end="", file=sys.stderr, flush=True)
    elif words:
        print(words, file=sys.stderr, flush=True)
