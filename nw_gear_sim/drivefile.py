"""Speed and torque of the rotor shaft over time from a file: OpenFAST's text or binary output, a SCADA system's CSV."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any, Literal

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim import openfast, scada
from nw_gear_sim.columnfile import GAP, ColumnFile, Gap, Numbers, described, gaps_after, rate
from nw_gear_sim.drivecolumns import Choice, DriveColumns, choose, has_drive, parse_columns

__all__ = ["DriveColumns", "DriveSeries", "parse_columns", "read_drive_file", "recognised", "summary"]

TEXT_SUFFIX, BINARY_SUFFIX = ".out", ".outb"
FEWEST_ROWS = 2
LONGEST_TIME = 1e12
"""Times further from 0 than this (s) are taken for damage."""


@dataclass(frozen=True, eq=False)
class DriveSeries:
    """Speed and torque of the rotor shaft, linear between good rows.

    Attributes:
        times: shape (n,), s after the first good row, strictly ascending.
        speed: shape (n,), angular speed of the ring, rad/s, none negative.
        torque: shape (n,), N m, positive where it drives.
        source: file, columns and units, for people.
        gaps: stretches that are bridged; one that begins before 0 or ends after the last time has been left out.
        rate_hz: rows per second; None where rows (outside gaps) don't come regularly.
        origin: time of the first good row in ISO 8601.
        empty_rows: rows with an empty cell.
    """

    times: Array
    speed: Array
    torque: Array
    source: str
    gaps: tuple[Gap, ...] = ()
    rate_hz: float | None = None
    origin: str = ""
    empty_rows: int = 0

    @property
    def duration(self) -> float:
        """Time of the last row, s."""
        return float(self.times[-1])

    def at(self, time: float) -> tuple[float, float]:
        """Return speed (rad/s) and torque (N m) at a time (s), held beyond both ends."""
        k = int(self.times.searchsorted(time, side="right"))
        if k == 0:
            return float(self.speed[0]), float(self.torque[0])
        if k == len(self.times):
            return float(self.speed[-1]), float(self.torque[-1])
        share = (time - float(self.times[k - 1])) / float(self.times[k] - self.times[k - 1])
        return _between(self.speed, k, share), _between(self.torque, k, share)


def read_drive_file(
    path: str | Path,
    *,
    columns: DriveColumns | None = None,
    gaps: Literal["refuse", "bridge"] | str = "refuse",
    longest_gap: float | None = None,
) -> DriveSeries:
    """Read speed and torque of the rotor shaft.

    Args:
        path: OpenFAST's output (.outb or its first bytes: binary; .out: text), otherwise a CSV file.
        columns: which columns, and their units; None = the usual ones.
        gaps: what to do about empty cells, NaN and rows too far apart: refuse, or bridge linearly.
        longest_gap: time between rows that is no gap yet, s; None = 1.5 times the median.

    Raises:
        InputError: names file, row or byte, and column: no such file or column, an unknown unit, a damaged or shortened
            file, a cell that isn't a number, a negative speed, a time that doesn't ascend, a gap where they are
            refused, power without speed, fewer than two good rows.
    """
    if gaps not in ("refuse", "bridge"):
        raise InputError("gaps", "refuse or bridge", repr(gaps))
    if longest_gap is not None and not longest_gap > 0.0:
        raise InputError("longest_gap", "a time above 0 s", f"{longest_gap:g}")
    file = _open(str(path))
    choice = choose(file, columns or DriveColumns())
    numbers = file.read(choice.time, choice.scales[0], (choice.speed, choice.effort))
    _check_times(file, numbers)
    speed, torque = _in_si(file, numbers, choice)
    return _assemble(file, choice, numbers, (speed, torque), gaps == "refuse", longest_gap)


def recognised(path: str | Path) -> bool:
    """Whether a file is one of OpenFAST, or a CSV file with the usual columns of time, speed and torque or power."""
    name = Path(path)
    if name.suffix.lower() in (TEXT_SUFFIX, BINARY_SUFFIX) or _is_binary(name):
        return True
    try:
        return has_drive(scada.table(str(path)).titles)
    except InputError:
        return False


def summary(path: str | Path) -> dict[str, object]:
    """Return what `nw_gear info` says about a drive file: rows, gaps, rate, means in rad/s and N m and more.

    Raises:
        InputError: as `read_drive_file`, gaps excepted.
    """
    series = read_drive_file(path, gaps="bridge")
    return {
        "rows": len(series.times),
        "gaps": described(series.gaps),
        "rate_hz": series.rate_hz,
        "mean_speed": float(series.speed.mean()),
        "mean_torque": float(series.torque.mean()),
        "kind": f"rotor speed and torque: {series.source}",
        "start": series.origin,
        "duration": series.duration,
        "empty_rows": series.empty_rows,
    }


def _open(path: str) -> ColumnFile:
    suffix = Path(path).suffix.lower()
    if suffix == BINARY_SUFFIX or _is_binary(Path(path)):
        return openfast.binary(path)
    return openfast.text(path) if suffix == TEXT_SUFFIX else scada.table(path)


def _is_binary(path: Path) -> bool:
    try:
        with path.open("rb") as stream:
            head = stream.read(2)
    except OSError:
        return False
    return len(head) == 2 and openfast.PACKED_TIMES <= head[0] <= openfast.WIDE_NAMES and head[1] == 0


def _check_times(file: ColumnFile, numbers: Numbers) -> None:
    times = numbers.times
    bad = np.flatnonzero(~(np.abs(times) <= LONGEST_TIME))
    if bad.size:
        raise InputError(_row(file, numbers, bad[0]), "a time", f"{times[bad[0]]:g} s")
    back = np.flatnonzero(np.diff(times) <= 0.0)
    if back.size:
        k = int(back[0]) + 1
        raise InputError(_row(file, numbers, k), f"a time after {times[k - 1]:.9g} s", f"{times[k]:.9g} s")


def _in_si(file: ColumnFile, numbers: Numbers, choice: Choice) -> tuple[Array, Array]:
    """Return speed and torque in SI, NaN where a row is empty."""
    with np.errstate(over="ignore"):  # refused right below
        values = numbers.values * np.array(choice.scales[1:])
    for i, expected in enumerate(("a speed", "power" if choice.by_power else "a torque")):
        _refuse_first(numbers, i, np.isinf(values[:, i]), f"{expected} that is a finite number")
    speed, effort = values.T.copy()
    zero = numbers.resolution[0] * choice.scales[1]  # a shaft at rest, packed, may come out a little below 0
    _refuse_first(numbers, 0, speed < -zero, "a speed of at least 0")
    speed = np.maximum(speed, 0.0)
    if not choice.by_power:
        return speed, effort
    _refuse_first(numbers, 0, (speed <= zero) & ~np.isnan(effort), "a speed above 0, as torque is power over speed")
    with np.errstate(all="ignore"):
        torque = effort / speed
    _refuse_first(numbers, 1, np.isinf(torque), "power of a finite torque")
    return speed, torque


def _refuse_first(numbers: Numbers, column: int, bad: Any, expected: str) -> None:
    found = np.flatnonzero(bad)
    if found.size:
        k = int(found[0])
        raise InputError(numbers.place(k, column), expected, f"{numbers.values[k, column]:g}")


def _assemble(
    file: ColumnFile,
    choice: Choice,
    numbers: Numbers,
    values: tuple[Array, Array],
    refuse: bool,
    longest_gap: float | None,
) -> DriveSeries:
    good = ~np.isnan(values[0]) & ~np.isnan(values[1])
    kept = np.flatnonzero(good)
    if refuse and len(kept) < len(good):
        row = int(np.flatnonzero(~good)[0])
        place = numbers.place(row, int(not np.isnan(values[0][row])))
        raise InputError(place, "a number (or gaps set to bridge)", "an empty cell or NaN")
    if len(kept) < FEWEST_ROWS:
        raise InputError(file.path, f"at least {FEWEST_ROWS} rows with time, speed and torque", str(len(kept)))
    every = numbers.times
    interval = round(float(np.median(np.diff(every))), 9) or float(np.median(np.diff(every)))
    limit = GAP * interval if longest_gap is None else longest_gap
    times = every[kept]
    broken = gaps_after(times, kept, limit)
    found = [(times[i], times[i + 1]) for i in np.flatnonzero(broken)]
    if refuse and found:
        place = _row(file, numbers, kept[int(np.flatnonzero(broken)[0]) + 1])
        expected = f"at most {limit:g} s after the row before (or gaps set to bridge)"
        raise InputError(place, expected, f"{found[0][1] - found[0][0]:g} s, the first of {len(found)} gaps")
    steps = np.diff(times)[~broken]
    ends = [(every[0], times[0])] * bool(kept[0] > 0), [(times[-1], every[-1])] * bool(kept[-1] < len(every) - 1)
    stretches = [*ends[0], *found, *ends[1]]
    return DriveSeries(
        times=times - times[0],
        speed=np.ascontiguousarray(values[0][kept]),
        torque=np.ascontiguousarray(values[1][kept]),
        source=f"{file.path}: {choice.text}",
        gaps=tuple(Gap(float(a - times[0]), float(b - a), _label(numbers.origin, a)) for a, b in stretches),
        rate_hz=rate(steps, float(steps.mean()) if steps.size else interval),
        origin=_label(numbers.origin, times[0]),
        empty_rows=len(good) - len(kept),
    )


def _row(file: ColumnFile, numbers: Numbers, row: Any) -> str:
    """Return the place of a row, its column left out."""
    return numbers.place(int(row), 0).rpartition(", column ")[0] or file.path


def _label(origin: datetime, seconds: Any) -> str:
    try:
        return (origin + timedelta(seconds=float(seconds))).isoformat()
    except OverflowError:
        return f"{seconds:g} s"


def _between(values: Array, k: int, share: float) -> float:
    before = float(values[k - 1])
    return before + share * (float(values[k]) - before)
