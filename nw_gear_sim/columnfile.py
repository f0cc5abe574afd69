"""What files of columns have in common: CSV rows, columns by name, times, empty cells and gaps.

Rows are counted as in a spreadsheet: the header is row 1. Lines that start with # before the header are skipped.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array

TIME_COLUMNS = ("time", "timestamp", "datetime", "date_time")
EPOCH = datetime(1970, 1, 1)
"""What times given in seconds count from, so that they too have a form in ISO 8601."""

GAP = 1.5
"""Rows further apart than this many median intervals have a gap between them."""

MOST_LISTED = 24
"""Columns that an error names; a file may have thousands."""

LONGEST_SHOWN = 60

_EMPTY = frozenset({"", "nan", "na", "n/a", "null", "none"})
_REGULAR = 0.01
_DELIMITERS = (",", ";", "\t")


@dataclass(frozen=True)
class Gap:
    """Time without good rows.

    Attributes:
        start: time of the last good row, s after the first one.
        seconds: from there to the next good row.
        label: time of the last good row in ISO 8601.
    """

    start: float
    seconds: float
    label: str


@dataclass(frozen=True, eq=False)
class Numbers:
    """Numbers of some columns of a file.

    Attributes:
        times: shape (n,), s after `origin`.
        values: shape (n, columns), in the units of the file; NaN where a cell is empty.
        place: where a row (from 0) and column (from 0) are met in the file, for an error.
        origin: what the times count from; `EPOCH` where the file doesn't say.
        resolution: shape (columns,), steps in which the file stores its values; 0 where they aren't rounded.
    """

    times: Array
    values: Array
    place: Callable[[int, int], str]
    origin: datetime
    resolution: Array


class ColumnFile(Protocol):
    """A file of columns, its header read.

    Attributes:
        path: where it is.
        place: of its titles, for an error.
        titles: names of its columns, without units.
        units: of its columns; "" where the file doesn't say.
    """

    @property
    def path(self) -> str: ...  # noqa: D102 - described above
    @property
    def place(self) -> str: ...  # noqa: D102
    @property
    def titles(self) -> tuple[str, ...]: ...  # noqa: D102
    @property
    def units(self) -> tuple[str, ...]: ...  # noqa: D102

    def read(self, time: int, scale: float, columns: Sequence[int]) -> Numbers:
        """Return numbers of some columns; times given as numbers are multiplied by `scale` (s)."""


def rows(file: str) -> tuple[str, Iterator[tuple[int, list[str]]]]:
    """Return the delimiter of a CSV file, and row number and stripped cells of every line that isn't blank.

    Raises:
        InputError: the file can't be read, isn't text in UTF-8 (at once) or not comma separated (while it is read).
    """
    try:
        lines = Path(file).read_bytes().decode("utf-8-sig").splitlines()
    except OSError as error:
        raise InputError(file, "a readable CSV file", error.strerror or str(error)) from None
    except UnicodeDecodeError as error:
        raise InputError(file, "a text in UTF-8", f"something else at byte {error.start}") from None
    head = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    delimiter = max(_DELIMITERS, key=head.count)
    return delimiter, _cells(file, lines, delimiter)


def _cells(file: str, lines: Sequence[str], delimiter: str) -> Iterator[tuple[int, list[str]]]:
    reader = csv.reader(lines, delimiter=delimiter)
    started = False
    try:
        for row in reader:
            if not any(cell.strip() for cell in row) or (not started and row[0].startswith("#")):
                continue
            started = True
            yield reader.line_num, [cell.strip() for cell in row]
    except csv.Error as error:
        raise InputError(f"{file}: row {reader.line_num}", "comma separated values", str(error)) from None


def column(place: str, header: Sequence[str], name: str, usual: Sequence[str], what: str) -> int:
    """Return the position of the column called `name`, or where that is "" of the first that has a usual name.

    Raises:
        InputError: there is none.
    """
    found = find(header, name, usual)
    if found is None:
        expected = f"{what} named {name}" if name else f"{what} ({', '.join(usual)})"
        raise InputError(place, expected, f"columns {listed(header)}" if header else "an empty file")
    return found


def find(header: Sequence[str], name: str, usual: Sequence[str]) -> int | None:
    """Return the position of a column, as `column` does; None where there is none. Usual names are lower case."""
    for wanted in (name,) if name else usual:
        for i, title in enumerate(header):
            if title == wanted or (not name and title.lower() == wanted):
                return i
    return None


def listed(names: Sequence[str]) -> str:
    """Return names in one line, at most `MOST_LISTED` of them."""
    more = f" and {len(names) - MOST_LISTED} more" if len(names) > MOST_LISTED else ""
    return ", ".join(printable(name) for name in names[:MOST_LISTED]) + more


def printable(text: str) -> str:
    """Return a text short and in one line."""
    cut = text if len(text) <= LONGEST_SHOWN else text[:LONGEST_SHOWN] + "..."
    return "".join(c if c.isprintable() else "?" for c in cut)


def empty(text: str) -> bool:
    """Whether a cell holds nothing (empty, NaN, NA, null)."""
    return text.lower() in _EMPTY


def moment(place: str, text: str) -> datetime:
    """Return a time given in ISO 8601 or in seconds.

    Raises:
        InputError: it is neither.
    """
    try:
        seconds = float(text)
    except ValueError:
        try:
            return datetime.fromisoformat(text)
        except ValueError:
            raise InputError(place, "a date and time in ISO 8601 or seconds", repr(text)) from None
    try:
        return EPOCH + timedelta(seconds=seconds)
    except (OverflowError, ValueError):
        raise InputError(place, "a date and time in ISO 8601 or seconds", repr(text)) from None


def same_zone(place: str, earlier: datetime, later: datetime) -> None:
    """Check that both times have a time zone or none of them.

    Raises:
        InputError: they don't.
    """
    if (earlier.tzinfo is None) != (later.tzinfo is None):
        raise InputError(place, "a time like those before, all with a time zone or none", later.isoformat())


def gaps_after(times: Array, kept: npt.NDArray[np.int64], longest: float) -> npt.NDArray[np.bool_]:
    """Return after which good row there is a gap, shape (n - 1,).

    Args:
        times: of the good rows, s, shape (n,).
        kept: which rows of the file they are, shape (n,); where others lie between, there is a gap.
        longest: time between rows that is no gap yet, s.
    """
    found: npt.NDArray[np.bool_] = (np.diff(times) > longest) | (np.diff(kept) > 1)
    return found


def rate(steps: Array, interval: float) -> float | None:
    """Return rows per second where all steps (s) are the interval (s), to 1 %; None otherwise."""
    return 1.0 / interval if bool(np.all(np.abs(steps - interval) <= _REGULAR * interval)) else None


def described(gaps: Sequence[Gap]) -> list[dict[str, Any]]:
    """Return gaps as `nw_gear info` prints them."""
    return [{"start": gap.label, "seconds": gap.seconds} for gap in gaps]
