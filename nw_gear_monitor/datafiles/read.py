"""Opens a file by its suffix."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from nw_gear_common.errors import InputError
from nw_gear_monitor.datafiles import csvfile, matfile, npyfile, wavfile
from nw_gear_monitor.datafiles.source import Source, printable

READERS: dict[str, Callable[[Path], Source]] = {
    ".csv": csvfile.read,
    ".txt": csvfile.read,
    ".tsv": csvfile.read,
    ".npy": npyfile.read,
    ".wav": wavfile.read,
    ".mat": matfile.read,
}


def read(path: Path) -> Source:
    """Read a file of samples; the kind follows from its suffix.

    Raises:
        InputError: an unknown suffix, or whatever the reader of that kind refuses.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(printable(str(path)), "a file named " + ", ".join(f"*{kind}" for kind in READERS), "another")
    return reader(path)
