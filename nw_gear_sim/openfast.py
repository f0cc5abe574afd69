"""Reads the output of OpenFAST: text (.out) and binary (.outb).

Text: remarks, a line of channel names that begins with Time, a line of units in parentheses, then rows.
Binary, little-endian (OpenFAST's own reader ReadFASTbinary is the reference): identifier (int16), with identifier 4
the width of names (int16, otherwise 10), channels and rows (int32 each), two doubles (scale and offset of packed times
with identifier 1, otherwise first time and step), unless identifier 3 scales and offsets of the channels (float32),
length and text of the description (int32), names and units (time first), with identifier 1 the times (int32), and the
rows: int16 with value = (stored - offset) / scale, doubles with identifier 3.
"""

from __future__ import annotations

import struct
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.columnfile import EPOCH, Numbers, empty, printable

PACKED_TIMES, STEPPED, DOUBLES, WIDE_NAMES = 1, 2, 3, 4
"""Identifiers of the binary format."""

USUAL_WIDTH = 10
FEWEST_ROWS = 2
LEAST_INT16 = -(2**15)
LONGEST_HEADER = 100
"""Lines of a text in which the channel names must come."""

LONGEST_LINE = 1 << 20


@dataclass(frozen=True)
class TextOutput:
    """A text output, its header read; rows are lines of the file.

    Attributes:
        path, place, titles, units: as in `columnfile.ColumnFile`.
        first: number of the first line of numbers.
    """

    path: str
    place: str
    titles: tuple[str, ...]
    units: tuple[str, ...]
    first: int

    def read(self, time: int, scale: float, columns: Sequence[int]) -> Numbers:
        """Return numbers of some channels.

        Raises:
            InputError: a line has another number of columns than the header, or a cell isn't a number.
        """
        chosen = (time, *columns)
        found, lines = array("d"), array("l")
        with Path(self.path).open(encoding="utf-8", errors="replace") as stream:
            for number, line in enumerate(stream, 1):
                cells = line.split() if number >= self.first else []
                if cells:
                    found.extend(self._row(number, cells, chosen))
                    lines.append(number)
        table = np.array(found).reshape(-1, len(chosen))

        def place(row: int, column: int) -> str:
            return self._cell(lines[row], columns[column])

        return Numbers(table[:, 0] * scale, table[:, 1:], place, EPOCH, np.zeros(len(columns)))

    def _row(self, number: int, cells: Sequence[str], chosen: Sequence[int]) -> list[float]:
        if len(cells) != len(self.titles):
            raise InputError(f"{self.path}: row {number}", f"{len(self.titles)} columns", str(len(cells)))
        return [self._number(number, i, cells[i]) for i in chosen]

    def _number(self, number: int, column: int, text: str) -> float:
        if empty(text) or not text.strip("*"):  # Fortran fills a field with stars where a number is too wide for it
            return np.nan
        try:
            return float(text)
        except ValueError:
            raise InputError(self._cell(number, column), "a number", repr(printable(text))) from None

    def _cell(self, number: int, column: int) -> str:
        return f"{self.path}: row {number}, column {printable(self.titles[column])}"


def text(path: str) -> TextOutput:
    """Open a text output.

    Raises:
        InputError: it can't be read or has no line of channel names followed by as many units.
    """
    try:
        with Path(path).open(encoding="utf-8", errors="replace") as stream:
            head = [stream.readline(LONGEST_LINE) for _ in range(LONGEST_HEADER)]
    except OSError as error:
        raise InputError(path, "a readable output of OpenFAST", error.strerror or str(error)) from None
    for i, line in enumerate(head[:-1]):
        titles = line.split()
        if titles and titles[0].lower() == "time":
            units = head[i + 1].split()
            if len(units) != len(titles) or not all(unit[0] == "(" and unit[-1] == ")" for unit in units):
                expected = f"{len(titles)} units in parentheses below the channel names"
                raise InputError(f"{path}: row {i + 2}", expected, repr(printable(head[i + 1].strip())))
            bare = tuple(unit[1:-1] for unit in units)
            return TextOutput(path, f"{path}: row {i + 1}", tuple(titles), bare, i + 3)
    raise InputError(path, "a line of channel names that begins with Time", "none in an output of OpenFAST")


@dataclass(frozen=True, eq=False)
class BinaryOutput:
    """A binary output, its header read.

    Attributes:
        path, place, titles, units: as in `columnfile.ColumnFile`.
        identifier: of the format, 1 to 4.
        rows: how many.
        clock: scale and offset of packed times, or first time and step (s).
        scales, offsets: shape (channels,), of the packed channels, time excluded.
        start: byte at which times or rows begin.
    """

    path: str
    place: str
    titles: tuple[str, ...]
    units: tuple[str, ...]
    identifier: int
    rows: int
    clock: tuple[float, float]
    scales: Array
    offsets: Array
    start: int

    def read(self, time: int, scale: float, columns: Sequence[int]) -> Numbers:
        """Return numbers of some channels; memory is needed for these channels alone.

        Raises:
            InputError: the time chosen isn't the file's own.
        """
        if time != 0:
            raise InputError(f"{self.path}: column {printable(self.titles[time])}", "Time as the column of time", "it")
        chosen = np.array(columns, dtype=np.intp) - 1
        if np.any(chosen < 0):
            raise InputError(f"{self.path}: column {printable(self.titles[0])}", "speed, torque or power", "time")
        channels, size = len(self.titles) - 1, 8 if self.identifier == DOUBLES else 2
        begin = self.start + (4 * self.rows if self.identifier == PACKED_TIMES else 0)
        kind = "<f8" if self.identifier == DOUBLES else "<i2"
        stored = np.memmap(self.path, dtype=kind, mode="r", offset=begin, shape=(self.rows, channels))
        with np.errstate(all="ignore"):  # what comes out of damaged numbers is checked by the caller
            values = (stored[:, chosen].astype(np.float64) - self.offsets[chosen]) / self.scales[chosen]
            times = self._times() * scale
        packed = 0.0 if self.identifier == DOUBLES else 1.0

        def place(row: int, column: int) -> str:
            byte = begin + (row * channels + int(chosen[column])) * size
            return f"{self.path}: byte {byte}, row {row + 1}, column {printable(self.titles[columns[column]])}"

        return Numbers(times, values, place, EPOCH, packed / np.abs(self.scales[chosen]))

    def _times(self) -> Array:
        first, second = self.clock
        if self.identifier == PACKED_TIMES:
            stored = np.memmap(self.path, dtype="<i4", mode="r", offset=self.start, shape=(self.rows,))
            unpacked: Array = (stored.astype(np.float64) - second) / first
            return unpacked
        return first + second * np.arange(self.rows, dtype=np.float64)


class _Bytes:
    """Takes a binary file apart; every piece is checked against the size of the file before it is read."""

    def __init__(self, path: str, stream: BinaryIO, size: int) -> None:
        self.path, self._stream, self.size, self.at = path, stream, size, 0

    def need(self, count: int, what: str) -> None:
        if self.at + count > self.size:
            place = f"{self.path}: byte {self.size}"
            raise InputError(place, f"{count} bytes of {what} from byte {self.at} on", "the end of the file")

    def take(self, count: int, what: str) -> bytes:
        self.need(count, what)
        self.at += count
        return self._stream.read(count)

    def number(self, form: str, what: str, least: int) -> int:
        place = f"{self.path}: byte {self.at}"
        value: int = struct.unpack("<" + form, self.take(struct.calcsize("<" + form), what))[0]
        if value < least:
            raise InputError(place, f"{what}, at least {least}", str(value))
        return value

    def doubles(self, what: str) -> tuple[float, float]:
        place = f"{self.path}: byte {self.at}"
        first, second = struct.unpack("<2d", self.take(16, what))
        if not np.all(np.isfinite((first, second))):
            raise InputError(place, what, f"{first:g} and {second:g}")
        return first, second

    def floats(self, count: int, what: str, *, nonzero: bool) -> Array:
        begin = self.at
        values = np.frombuffer(self.take(4 * count, what), dtype="<f4").astype(np.float64)
        bad = np.flatnonzero(~np.isfinite(values) | (nonzero & (values == 0.0)))
        if bad.size:
            raise InputError(f"{self.path}: byte {begin + 4 * int(bad[0])}", what, f"{values[bad[0]]:g}")
        return values

    def texts(self, count: int, width: int, what: str) -> tuple[str, ...]:
        block = self.take(count * width, what).decode("latin-1")
        return tuple(block[i : i + width].strip(" \0") for i in range(0, len(block), width))


def binary(path: str) -> BinaryOutput:
    """Open a binary output; nothing larger than the file is ever allocated.

    Raises:
        InputError: it can't be read, isn't of a known identifier, is shorter or longer than its header says, or a
            number of the header is impossible; byte and meaning are named.
    """
    try:
        with Path(path).open("rb") as stream:
            return _binary(_Bytes(path, stream, Path(path).stat().st_size))
    except OSError as error:
        raise InputError(path, "a readable output of OpenFAST", error.strerror or str(error)) from None


def _binary(data: _Bytes) -> BinaryOutput:
    identifier = data.number("h", "identifier of the format", LEAST_INT16)
    if not PACKED_TIMES <= identifier <= WIDE_NAMES:
        raise InputError(f"{data.path}: byte 0", "identifier of the format (1 to 4)", str(identifier))
    width = data.number("h", "width of channel names", 1) if identifier == WIDE_NAMES else USUAL_WIDTH
    channels = data.number("i", "number of channels", 1)
    rows = data.number("i", "number of rows", FEWEST_ROWS)
    packed = identifier == PACKED_TIMES
    place = f"{data.path}: byte {data.at}"
    clock = data.doubles("scale and offset of the times" if packed else "first time and step")
    if (packed and clock[0] == 0.0) or (not packed and clock[1] <= 0.0):
        raise InputError(place, "a scale of the times" if packed else "a step above 0 s", f"{clock[not packed]:g}")
    if identifier == DOUBLES:
        data.need(8 * channels * rows, "channels")
        scales, offsets = np.ones(channels), np.zeros(channels)
    else:
        scales = data.floats(channels, "a scale of a channel", nonzero=True)
        offsets = data.floats(channels, "an offset of a channel", nonzero=False)
    data.take(data.number("i", "length of the description", 0), "description")
    place = f"{data.path}: byte {data.at}"
    titles = data.texts(channels + 1, width, "channel names")
    units = data.texts(channels + 1, width, "units")
    start = data.at
    size = rows * (channels * (8 if identifier == DOUBLES else 2) + (4 if packed else 0))
    data.need(size, "rows")
    end = start + size
    if end != data.size:
        raise InputError(f"{data.path}: byte {end}", f"the end of the file after {rows} rows", f"{data.size} bytes")
    bare = tuple(unit.removeprefix("(").removesuffix(")") for unit in units)
    return BinaryOutput(data.path, place, titles, bare, identifier, rows, clock, scales, offsets, start)
