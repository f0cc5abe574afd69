"""Reads measured wind from CSV files: a time series, or means and standard deviations of intervals.

Rows are counted as in a spreadsheet: the header is row 1. An empty cell (nothing, NaN, NA, null) counts as a missing
row. Lines that start with # before the header are skipped; columns that aren't asked for are ignored.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import pairwise
from pathlib import Path

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim import columnfile
from nw_gear_sim.columnfile import GAP, TIME_COLUMNS, Gap

SPEED_COLUMNS = ("wind_speed", "wind_speed_mean")
DEVIATION_COLUMNS = ("wind_speed_std",)
FASTEST_WIND = 150.0
"""Largest wind speed taken for one (m/s): above every wind measured at the ground, below the usual error codes."""

FEWEST_ROWS = 2
_REGULAR = 0.01


@dataclass(frozen=True, eq=False)
class WindFile:
    """The good rows of a wind file.

    Attributes:
        path: where it was read.
        times: shape (n,), s after the first good row, strictly ascending. With deviations: begin of each interval.
        speeds: shape (n,), m/s; means where there are deviations.
        deviations: shape (n,), standard deviations in m/s; None for a time series.
        gaps: where rows are missing or a cell is empty.
        empty_rows: number of rows with an empty cell, those at both ends included.
        interval: median time between rows, s.
        rate_hz: rows per second; None where rows (outside gaps) don't come regularly.
        origin: time of the first good row in ISO 8601.
    """

    path: str
    times: Array
    speeds: Array
    deviations: Array | None
    gaps: tuple[Gap, ...]
    empty_rows: int
    interval: float
    rate_hz: float | None
    origin: str

    def regular(self) -> tuple[Array, Array]:
        """Return means and deviations of consecutive intervals, those of missing ones interpolated linearly.

        Raises:
            InputError: no deviations, or the times aren't multiples of one interval.
        """
        if self.deviations is None:
            raise InputError(self.path, "a column of standard deviations", "none")
        steps = self.times / self.interval
        numbers = np.round(steps)
        off = np.flatnonzero(np.abs(steps - numbers) > _REGULAR)
        if off.size:
            place = f"{self.path}: {self.times[off[0]]:g} s after the first row"
            expected = f"intervals that begin at multiples of {self.interval:g} s"
            raise InputError(place, expected, f"{steps[off[0]]:.3f} of them")
        every = np.arange(int(numbers[-1]) + 1, dtype=np.float64)
        return np.interp(every, numbers, self.speeds), np.interp(every, numbers, self.deviations)


@dataclass(frozen=True, slots=True)
class _Row:
    number: int
    moment: datetime
    values: tuple[float, ...]


def read(path: str | Path, time_column: str = "", speed_column: str = "", deviation_column: str = "") -> WindFile:
    """Read a wind file.

    Args:
        path: CSV file (comma, semicolon or tab) with a header. Times are ISO 8601 or seconds.
        time_column: its name; "" = the first there is of time, timestamp, datetime, date_time (in any case).
        speed_column: its name; "" = wind_speed or wind_speed_mean.
        deviation_column: its name; "" = wind_speed_std beside wind_speed_mean, otherwise none (a time series).

    Raises:
        InputError: names file and row: no such file or column, a cell that isn't a number, a negative or impossible
            wind, a time that isn't one or doesn't ascend, fewer than two good rows.
    """
    file = str(path)
    _, cells = columnfile.rows(file)
    header_row, header = next(cells, (1, []))
    place = f"{file}: row {header_row}"
    time = columnfile.column(place, header, time_column, TIME_COLUMNS, "a time column")
    columns = [columnfile.column(place, header, speed_column, SPEED_COLUMNS, "a wind speed column")]
    if deviation_column or header[columns[0]].lower() == SPEED_COLUMNS[1]:
        columns.append(
            columnfile.column(place, header, deviation_column, DEVIATION_COLUMNS, "a column of standard deviations")
        )
    rows = [_row(file, number, header, row, time, columns) for number, row in cells]
    return _assemble(file, rows)


def summary(path: str | Path) -> dict[str, object]:
    """Return what `nw_gear info` says about a wind file: rows, gaps, mean, rate_hz and more.

    Raises:
        InputError: as `read`.
    """
    file = read(path)
    return {
        "rows": len(file.times),
        "gaps": columnfile.described(file.gaps),
        "mean": float(file.speeds.mean()),
        "rate_hz": file.rate_hz,
        "kind": "time series" if file.deviations is None else "means and standard deviations",
        "start": file.origin,
        "duration": float(file.times[-1]),
        "empty_rows": file.empty_rows,
    }


def _row(
    file: str, number: int, header: Sequence[str], cells: Sequence[str], time: int, columns: Sequence[int]
) -> _Row:
    place = f"{file}: row {number}"
    if len(cells) != len(header):
        raise InputError(place, f"{len(header)} cells as in the header", str(len(cells)))
    moment = columnfile.moment(f"{place}, column {header[time]}", cells[time])
    values = [_speed(f"{place}, column {header[i]}", cells[i]) for i in columns]
    good = [value for value in values if value is not None]
    return _Row(number, moment, tuple(good) if len(good) == len(values) else ())


def _speed(place: str, text: str) -> float | None:
    if columnfile.empty(text):
        return None
    expected = f"a wind speed from 0 to {FASTEST_WIND:g} m/s or an empty cell"
    try:
        value = float(text)
    except ValueError:
        raise InputError(place, expected, repr(text)) from None
    if not 0.0 <= value <= FASTEST_WIND:
        raise InputError(place, expected, text)
    return value


def _assemble(file: str, rows: Sequence[_Row]) -> WindFile:
    for earlier, later in pairwise(rows):
        place = f"{file}: row {later.number}"
        columnfile.same_zone(place, earlier.moment, later.moment)
        if later.moment <= earlier.moment:
            raise InputError(place, f"a time after {earlier.moment.isoformat()}", later.moment.isoformat())
    kept = [i for i, row in enumerate(rows) if row.values]
    if len(kept) < FEWEST_ROWS:
        raise InputError(file, f"at least {FEWEST_ROWS} rows with time and wind speed", str(len(kept)))
    good = [rows[i] for i in kept]
    start = good[0].moment
    times = np.array([(row.moment - start).total_seconds() for row in good])
    values = np.array([row.values for row in good])
    interval = round(float(np.median(np.diff([(row.moment - start).total_seconds() for row in rows]))), 6)
    steps = np.diff(times)
    missing = columnfile.gaps_after(times, np.array(kept), GAP * interval)
    return WindFile(
        path=file,
        times=times,
        speeds=np.ascontiguousarray(values[:, 0]),
        deviations=np.ascontiguousarray(values[:, 1]) if values.shape[1] > 1 else None,
        gaps=tuple(Gap(float(times[i]), float(steps[i]), good[i].moment.isoformat()) for i in np.flatnonzero(missing)),
        empty_rows=len(rows) - len(good),
        interval=interval,
        rate_hz=columnfile.rate(steps[~missing], interval),
        origin=start.isoformat(),
    )
