"""Where a report or an export goes, checked before any work; files are written as a whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

from nw_gear_common.errors import InputError

RECORDING = "recording"
"""Name of the recording inside the folder of a run."""
FILES = {"html": "report.html", "json": "report.json", "parquet": "data_parquet", "csv": "data_csv"}
"""Name of what is written by default, by format."""
FOLDERS = ("parquet", "csv")
BAGS = ("*.mcap", "*.db3", "*.mcap.zstd", "*.bag")
"""What the folder of a recording has in it; some of them are refused by name when they are opened."""


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
        if (folder / "metadata.yaml").is_file() or any(any(folder.glob(suffix)) for suffix in BAGS):
            return folder
    raise InputError(str(run), "a recording (metadata.yaml, *.mcap), or a run with one in it", "neither")


def name_of(recording: Path) -> str:
    """The run's folder gives it its name; a recording inside it is called just that."""
    recording = recording.resolve()
    return recording.parent.name if recording.name == RECORDING else recording.name


def default_output(recording: Path, kind: str = "html", other: Path | None = None) -> Path:
    """Where the result goes by default: into the folder of the run, else beside the recording, under its name."""
    recording = recording.resolve()
    name = FILES[kind] if other is None else f"comparison_with_{name_of(other)}.{kind}"
    return recording.parent / (name if recording.name == RECORDING else f"{recording.name}_{name}")


def check_output(page: Path) -> None:
    """Make sure that a file can be written, before any work is done.

    Raises:
        InputError: its folder is missing or read-only, or its name is a folder's.
    """
    _check_parent(page, "a file")
    if page.is_dir():
        raise InputError(f"-o {page}", "the name of a file", "a folder")


def check_folder(folder: Path) -> None:
    """Make sure that a folder can be filled, before any work is done.

    Raises:
        InputError: it holds something, or its parent is missing or read-only.
    """
    _check_parent(folder, "a folder")
    if folder.is_file() or (folder.is_dir() and any(folder.iterdir())):
        raise InputError(f"-o {folder}", "a new or empty folder", "one that holds something")


def _check_parent(path: Path, what: str) -> None:
    if not path.parent.is_dir():
        raise InputError(f"-o {path}", f"{what} in a folder that exists", f"no folder {path.parent}")
    if not os.access(path.parent, os.W_OK):
        raise InputError(f"-o {path}", "a folder that can be written to", f"{path.parent} is read-only")


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
