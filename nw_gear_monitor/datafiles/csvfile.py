"""Text with columns (.csv, .txt, .tsv): a header, then numbers; commas, semicolons or tabs; decimal point or comma."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.datafiles.source import Source, content, listed, printable, time_unit

KIND = "a text with columns (CSV)"
DELIMITERS = (";", "\t", ",")
CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f]")
LONGEST_NUMBER = 40


def read(path: Path) -> Source:
    """Read the columns of numbers of a text; a column named time, t, timestamp (with a unit or not) is time.

    Lines before the header that start with # are skipped. A column without a single number is
    left out; one with numbers and something else isn't accepted.

    Raises:
        InputError: not a text, no header, names given twice, rows of different length, a cell that isn't a number.
    """
    place = str(path)
    rows = _rows(place, _text(place, content(path, KIND)))
    if not rows:
        raise InputError(place, "a header and rows of numbers", "nothing but blank lines")
    (_, header), body = rows[0], rows[1:]
    names = _names(place, header)
    if not body:
        raise InputError(place, "rows of numbers under the header", "none")
    for number, row in body:
        if len(row) != len(names):
            raise InputError(f"{place}: row {number}", f"{len(names)} cells, as in the header", str(len(row)))
    columns: dict[str, Array] = {}
    left_out: dict[str, str] = {}
    time, resolution = None, 0.0
    for k, name in enumerate(names):
        cells = [row[k] for _, row in body]
        unit = time_unit(name)
        if time is None and unit is not None:
            time = name
            columns[name], resolution = _times(place, name, unit, cells, rows)
        elif any(_number(cell) is not None for cell in cells):
            columns[name] = _numbers(place, name, cells, rows)
        else:
            left_out[name] = f"text such as {printable(cells[0])!r}"
    if not columns:
        raise InputError(place, "columns of numbers", f"text in {listed(names)}")
    return Source(place, columns, time=time, time_resolution=resolution, left_out=left_out)


def _text(place: str, data: bytes) -> str:
    coding = "utf-16" if data.startswith((b"\xff\xfe", b"\xfe\xff")) else "utf-8-sig"
    try:
        text = data.decode(coding)
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    found = CONTROL.search(text)
    if found:
        raise InputError(place, KIND, f"binary data (character {ord(found.group())} at {found.start()})")
    return text


def _rows(place: str, text: str) -> list[tuple[int, list[str]]]:
    """Row numbers as in a spreadsheet, and stripped cells; lines may be blank before the numbers and at the end."""
    lines = text.splitlines()
    head = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    reader = csv.reader(lines, delimiter=max(DELIMITERS, key=head.count))
    rows: list[tuple[int, list[str]]] = []
    blank = 0
    try:
        for row in reader:
            if not any(cell.strip() for cell in row):
                blank = blank or reader.line_num
            elif rows or not row[0].startswith("#"):
                if len(rows) > 1 and blank:
                    raise InputError(f"{place}: row {blank}", "a row of numbers", "a blank one")
                rows.append((reader.line_num, [cell.strip() for cell in row]))
                blank = 0
    except csv.Error as error:
        raise InputError(f"{place}: row {reader.line_num}", KIND, str(error)) from None
    return rows


def _names(place: str, header: Sequence[str]) -> list[str]:
    if all(_number(cell) is not None for cell in header):
        raise InputError(f"{place}: first row", "the names of the columns", f"numbers ({listed(list(header))})")
    names = [name or f"column {k + 1}" for k, name in enumerate(header)]
    twice = sorted({name for name in names if names.count(name) > 1}) if len(set(names)) < len(names) else []
    if twice:
        raise InputError(f"{place}: header", "each name once", f"twice: {listed(twice)}")
    return names


def _number(cell: str) -> float | None:
    """A number with a decimal point or comma; None for anything else (1_000 among it)."""
    if "_" in cell or len(cell) > LONGEST_NUMBER:
        return None
    try:
        return float(cell)
    except ValueError:
        try:
            return float(cell.replace(",", ".", 1)) if "." not in cell else None
        except ValueError:
            return None


def _numbers(place: str, name: str, cells: Sequence[str], rows: Sequence[tuple[int, list[str]]]) -> Array:
    try:
        if not any("_" in cell for cell in cells):  # Python's own numbers may have it
            return np.array(cells, dtype=np.float64)
    except ValueError:
        pass
    values = np.empty(len(cells))
    for k, cell in enumerate(cells):
        value = _number(cell)
        if value is None:
            raise InputError(
                f"{place}: row {rows[k + 1][0]}, column {printable(name)}", "a number", repr(printable(cell))
            )
        values[k] = value
    return values


def _times(
    place: str, name: str, unit: float, cells: Sequence[str], rows: Sequence[tuple[int, list[str]]]
) -> tuple[Array, float]:
    """Times in s, and the step in which they are written, s."""
    if _number(cells[0]) is not None:
        decimals = max(_decimals(cell) for cell in cells[:1000])
        return unit * _numbers(place, name, cells, rows), unit * 10.0**-decimals
    moments = np.empty(len(cells))
    first: datetime | None = None
    for k, cell in enumerate(cells):
        moment = _moment(f"{place}: row {rows[k + 1][0]}, column {printable(name)}", cell)
        first = moment if first is None else first
        moments[k] = (moment - first).total_seconds()
    return moments, 10.0 ** -max(_decimals(cell) for cell in cells[:1000])


def _moment(place: str, cell: str) -> datetime:
    try:
        moment = datetime.fromisoformat(cell)
    except ValueError:
        raise InputError(place, "a number or a time in ISO 8601", repr(printable(cell))) from None
    return moment if moment.tzinfo is not None else moment.replace(tzinfo=UTC)


def _decimals(cell: str) -> int:
    """Digits behind the decimal sign, the exponent taken into account; 12 at most."""
    mantissa, _, exponent = cell.lower().partition("e")
    digits = len(re.split("[.,]", mantissa, maxsplit=1)[-1].partition("+")[0]) if re.search("[.,]", mantissa) else 0
    shift = int(exponent) if re.fullmatch(r"[+-]?\d{1,3}", exponent) else 0
    return min(max(digits - shift, 0), 12)
