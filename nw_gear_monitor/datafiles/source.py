"""What a reader hands over: named columns of one file, and the sample rate where the file tells it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array

TIME = re.compile(r"(time|t|timestamp|zeit|seconds)\s*(?:[\[(/_,]\s*(\w+)\s*[\])]?)?", re.IGNORECASE)
UNITS = {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "ns": 1e-9, "min": 60.0}
MOST_LISTED = 24
LONGEST_SHOWN = 60


@dataclass(frozen=True, eq=False)
class Source:
    """Numbers of one file.

    Attributes:
        place: the file, for errors.
        columns: (samples,) each, in the order of the file; columns of other lengths may stand beside each other.
        rate: samples per second that the file states, Hz; None where it doesn't.
        time: name of the column of times, where there is one; its values are in s.
        time_resolution: steps in which the times are written, s.
        left_out: columns that hold no numbers, and why.
    """

    place: str
    columns: Mapping[str, Array]
    rate: float | None = None
    time: str | None = None
    time_resolution: float = 0.0
    left_out: Mapping[str, str] = field(default_factory=dict)

    def column(self, name: str, option: str) -> Array:
        """Return a column by name; `option` is what asked for it.

        Raises:
            InputError: there is none of that name, or it holds no numbers.
        """
        if name in self.left_out:
            raise InputError(f"{option} {printable(name)}", f"numbers in {self.place}", self.left_out[name])
        if name not in self.columns:
            raise InputError(f"{option} {printable(name)}", f"a column of {self.place}", listed(list(self.columns)))
        return self.columns[name]


def listed(names: list[str]) -> str:
    """Names in one line, at most MOST_LISTED of them."""
    more = f" and {len(names) - MOST_LISTED} more" if len(names) > MOST_LISTED else ""
    return (", ".join(printable(name) for name in names[:MOST_LISTED]) or "none") + more


def printable(text: str) -> str:
    """A text short and in one line."""
    cut = text if len(text) <= LONGEST_SHOWN else text[:LONGEST_SHOWN] + "..."
    return "".join(c if c.isprintable() else "?" for c in cut)


def content(path: Path, kind: str) -> bytes:
    """Return the bytes of a file.

    Args:
        path: of a plain file (a pipe could make us wait for ever).
        kind: of file, for the error.

    Raises:
        InputError: it isn't there, isn't a plain file, can't be read, or is empty.
    """
    try:
        if not path.is_file():
            raise InputError(str(path), kind, "no such file" if not path.exists() else "a folder or a device")
        found = path.read_bytes()
    except (OSError, ValueError) as error:
        raise InputError(printable(str(path)), kind, getattr(error, "strerror", None) or str(error)) from None
    if not found:
        raise InputError(str(path), kind, "an empty file")
    return found


def time_unit(name: str) -> float | None:
    """Seconds in the unit of a column of times, such as `t`, `Time [ms]`, `time_s`; None for any other name."""
    found = TIME.fullmatch(name.strip())
    return None if found is None else UNITS.get((found.group(2) or "s").lower())


def with_times(columns: dict[str, Array]) -> str | None:
    """Name of the first column of times, now in s; None where there is none."""
    for name, values in columns.items():
        unit = time_unit(name.rpartition(".")[2])
        if unit is not None:
            columns[name] = unit * values
            return name
    return None


def numbered(place: str, array: Array, name: str = "ch") -> dict[str, Array]:
    """Columns of an array without names: its longer side is time.

    Args:
        place: of the array, for the error.
        array: (samples,), (samples, channels) or (channels, samples).
        name: channels are called name1, name2, ..

    Raises:
        InputError: another number of dimensions, or no values.
    """
    if array.ndim == 1:
        array = array[:, None]
    if array.ndim != 2 or array.size == 0:
        raise InputError(place, "samples of one channel, or of channels side by side", f"shape {array.shape}")
    if array.shape[1] > array.shape[0]:
        array = array.T
    return {f"{name}{k + 1}": array[:, k] for k in range(array.shape[1])}
