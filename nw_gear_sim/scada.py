"""Reads CSV files of SCADA systems: comma, semicolon or tab, times in ISO 8601 or seconds, decimal points or commas.

Decimal commas are taken where nothing else can be meant: with another delimiter than the comma, no point in any number
that is read, and at least one number whose comma can't separate thousands.
"""

from __future__ import annotations

import math
import re
from array import array
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from functools import partial

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_sim.columnfile import EPOCH, Numbers, empty, moment, printable, rows, same_zone
from nw_gear_sim.drivecolumns import known_unit, split_title

_COMMA = re.compile(r"[-+]?(\d*),(\d+)(?:[eE][-+]?\d+)?")


@dataclass
class _Decimals:
    """Reads numbers and remembers how decimals are written.

    Attributes:
        path: of the file; delimiter: between its cells.
        points, commas: a number with one has been read.
        comma_at: first cell with a comma.
        sure: a comma has been read that can't separate thousands.
    """

    path: str
    delimiter: str
    points: bool = False
    commas: bool = False
    comma_at: str = ""
    sure: bool = False

    def number(self, place: Callable[[], str], text: str) -> float:
        plain = text
        if "," in text and self.delimiter != ",":
            match = _COMMA.fullmatch(text)
            if match is None or self.points:
                self._refuse(place, text)
            else:
                plain = text.replace(",", ".")
                self.sure = self.sure or len(match[2]) != 3 or match[1] in ("", "0") or len(match[1]) > 3
            self.comma_at = self.comma_at or place()
            self.commas = True
        elif "." in text:
            self.points = True
            if self.commas:
                self._refuse(place, text)
        try:
            return float(plain)
        except ValueError:
            raise InputError(place(), "a number or an empty cell", repr(printable(text))) from None

    def finish(self) -> None:
        if self.commas and not self.sure:
            expected = "numbers with a decimal point"
            raise InputError(self.comma_at, expected, "commas that may be decimal or separate thousands")

    def _refuse(self, place: Callable[[], str], text: str) -> None:
        raise InputError(place(), "either decimal points or decimal commas throughout", repr(printable(text)))


@dataclass(frozen=True, eq=False)
class ScadaFile:
    """A CSV file, its header read; its rows are read once.

    Attributes:
        path, place, titles, units: as in `columnfile.ColumnFile`.
        delimiter: between cells.
    """

    path: str
    place: str
    titles: tuple[str, ...]
    units: tuple[str, ...]
    delimiter: str
    _header: tuple[str, ...] = field(repr=False)
    _cells: Iterator[tuple[int, list[str]]] = field(repr=False)

    def read(self, time: int, scale: float, columns: Sequence[int]) -> Numbers:
        """Return numbers of some columns.

        Raises:
            InputError: a row has another number of cells than the header, or a cell isn't a number or time.
        """
        decimals = _Decimals(self.path, self.delimiter)
        clock = _Clock(decimals, scale)
        times, values, numbers = array("d"), array("d"), array("l")
        for number, cells in self._cells:
            if len(cells) != len(self.titles):
                expected = f"{len(self.titles)} cells as in the header"
                raise InputError(f"{self.path}: row {number}", expected, str(len(cells)))
            times.append(clock.read(partial(self._cell, number, time), cells[time]))
            values.extend(self._value(decimals, number, i, cells[i]) for i in columns)
            numbers.append(number)
        decimals.finish()

        def place(row: int, column: int) -> str:
            return self._cell(numbers[row], columns[column])

        table = np.array(values, dtype=np.float64).reshape(-1, len(columns))
        return Numbers(np.array(times), table, place, clock.origin or EPOCH, np.zeros(len(columns)))

    def _value(self, decimals: _Decimals, number: int, i: int, text: str) -> float:
        return np.nan if empty(text) else decimals.number(partial(self._cell, number, i), text)

    def _cell(self, number: int, column: int) -> str:
        return f"{self.path}: row {number}, column {printable(self._header[column])}"


class _Clock:
    """Reads times: all in ISO 8601, or all numbers."""

    def __init__(self, decimals: _Decimals, scale: float) -> None:
        self.origin: datetime | None = None
        self._decimals, self._scale = decimals, scale
        self._started = False

    def read(self, place: Callable[[], str], text: str) -> float:
        """Return seconds after the first time, or the number in seconds."""
        if not self._started:
            self._started = True
            self.origin = None if _numeric(text) else moment(place(), text)
        if self.origin is None:
            if not _numeric(text):
                raise InputError(place(), "a number, as the times before", repr(printable(text)))
            return self._decimals.number(place, text) * self._scale
        if _numeric(text):
            raise InputError(place(), "a date and time in ISO 8601, as those before", repr(printable(text)))
        later = moment(place(), text)
        same_zone(place(), self.origin, later)
        return (later - self.origin).total_seconds()


def _numeric(text: str) -> bool:
    try:
        return math.isfinite(float(text.replace(",", ".")))
    except ValueError:
        return False


def table(path: str) -> ScadaFile:
    """Open a CSV file; where several titles differ by what is in parentheses alone, they stay whole.

    Raises:
        InputError: it can't be read, or isn't text in UTF-8.
    """
    delimiter, cells = rows(path)
    number, header = next(cells, (1, []))
    parts = [split_title(title) for title in header]
    times_named = Counter(name for name, _ in parts)
    alone = [times_named[name] == 1 for name, _ in parts]
    titles = tuple(name if one else title for title, (name, _), one in zip(header, parts, alone, strict=True))
    units = tuple(unit if one or known_unit(unit) else "" for (_, unit), one in zip(parts, alone, strict=True))
    return ScadaFile(path, f"{path}: row {number}", titles, units, delimiter, tuple(header), cells)
