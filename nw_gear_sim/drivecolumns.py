"""Which columns of a file are time, speed, torque and power of the rotor shaft, and in which units."""

from __future__ import annotations

import re
from dataclasses import dataclass

from nw_gear_common import units
from nw_gear_common.errors import InputError
from nw_gear_sim.columnfile import TIME_COLUMNS, ColumnFile, column, find, printable

SPEED_COLUMNS = ("rotspeed", "lsstipvxa", "speed", "rotor_speed", "rotor speed")
TORQUE_COLUMNS = (
    *("rottorq", "lsshfttq", "lsstipmxa", "lsstipmxs", "lsshftmxa", "lsshftmxs"),  # six names of one output of OpenFAST
    *("torque", "rotor_torque", "rotor torque"),
)
POWER_COLUMNS = ("rotpwr", "lsshftpwr", "power", "rotor_power", "rotor power")

SPELLINGS = {
    "time": {"s": "s", "sec": "s", "seconds": "s", "ms": "ms", "us": "us", "min": "min"},
    "speed": {"rad/s": "rad/s", "Hz": "Hz"} | dict.fromkeys(("r/min", "rpm", "RPM", "rev/min", "1/min"), "r/min"),
    "torque": {"Nm": "N m", "kNm": "kN m", "MNm": "MN m"},
    "power": {"W": "W", "kW": "kW", "MW": "MW"},
}
"""Units by what is measured, as they are written without blanks, points and hyphens, and their names in `units`."""

SI = {"time": "s", "speed": "rad/s", "torque": "N m", "power": "W"}

_FILLERS = re.compile(r"[\s\-*.()\[\]·⋅\ufffd]")  # the last one: a point that wasn't written in UTF-8
_TITLE = re.compile(r"(.*?)\s*[(\[]([^()\[\]]*)[)\]]", re.DOTALL)


@dataclass(frozen=True)
class DriveColumns:
    """Columns chosen by hand; "" = the usual ones.

    Attributes:
        time, speed, torque, power: names of columns. Torque is power over speed where only `power` is given.
        time_unit, speed_unit, torque_unit, power_unit: units; "" = as the file says, or SI where it says nothing.
    """

    time: str = ""
    speed: str = ""
    torque: str = ""
    power: str = ""
    time_unit: str = ""
    speed_unit: str = ""
    torque_unit: str = ""
    power_unit: str = ""


@dataclass(frozen=True)
class Choice:
    """Columns of a file, found.

    Attributes:
        time, speed, effort: positions; effort is torque, or power where `by_power`.
        scales: what time, speed and effort are multiplied by to be in SI.
        by_power: torque is power over speed.
        text: names and units, for people.
    """

    time: int
    speed: int
    effort: int
    scales: tuple[float, float, float]
    by_power: bool
    text: str


def parse_columns(text: str) -> DriveColumns:
    """Return columns given as `time=Time s, speed=RotSpeed r/min, torque=RotTorq kN m`; units may be left out.

    Raises:
        InputError: a part isn't name = column, or a name is unknown or comes twice.
    """
    values: dict[str, str] = {}
    for part in text.split(","):
        what, sign, rest = (piece.strip() for piece in part.partition("="))
        if not sign or not rest or what not in SI or what in values:
            expected = "each of time, speed, torque, power once, as speed=NAME UNIT"
            raise InputError("columns of the drive file", expected, repr(printable(part.strip())))
        words = rest.split()
        known = (k for k in range(1, len(words)) if _spelling(" ".join(words[k:])) in SPELLINGS[what])
        cut = next(known, len(words))
        values[what] = rest if cut == len(words) else " ".join(words[:cut])
        values[f"{what}_unit"] = " ".join(words[cut:])
    return DriveColumns(**values)


def split_title(title: str) -> tuple[str, str]:
    """Return name and unit of a title such as `speed (r/min)` or `speed [r/min]`; no unit is ""."""
    match = _TITLE.fullmatch(title)
    return (match[1], match[2].strip()) if match and match[1] else (title, "")


def known_unit(text: str) -> bool:
    """Whether a text is a unit of anything that is read."""
    return any(_spelling(text) in spellings for spellings in SPELLINGS.values())


def choose(file: ColumnFile, wanted: DriveColumns) -> Choice:
    """Find the columns of a file.

    Raises:
        InputError: a column isn't there, or its unit is unknown.
    """
    time = _column(file, wanted.time, TIME_COLUMNS, "a time column")
    speed = _column(file, wanted.speed, SPEED_COLUMNS, "a column of the rotor's speed")
    by_power = not wanted.torque and (bool(wanted.power) or find(file.titles, "", TORQUE_COLUMNS) is None)
    if by_power and not wanted.power and find(file.titles, "", POWER_COLUMNS) is None:
        _column(file, "", TORQUE_COLUMNS + POWER_COLUMNS, "a column of torque or power")
    what, usual = ("power", POWER_COLUMNS) if by_power else ("torque", TORQUE_COLUMNS)
    effort = _column(file, getattr(wanted, what), usual, f"a column of the rotor's {what}")
    chosen = (("time", time), ("speed", speed), (what, effort))
    names = [_unit(file, position, role, getattr(wanted, f"{role}_unit")) for role, position in chosen]
    scales = [_scale(name, SI[role]) for (role, _), name in zip(chosen, names, strict=True)]
    said = [f"{role} {printable(file.titles[i])} ({name})" for (role, i), name in zip(chosen, names, strict=True)][1:]
    return Choice(time, speed, effort, (scales[0], scales[1], scales[2]), by_power, " and ".join(said))


def has_drive(titles: tuple[str, ...]) -> bool:
    """Whether a file with these titles has all usual columns."""
    efforts = TORQUE_COLUMNS + POWER_COLUMNS
    return all(find(titles, "", usual) is not None for usual in (TIME_COLUMNS, SPEED_COLUMNS, efforts))


def _column(file: ColumnFile, name: str, usual: tuple[str, ...], what: str) -> int:
    bare = split_title(name)[0]  # a title may be given with its unit
    position = column(file.place, file.titles, name if name in file.titles else bare, usual, what)
    title = file.titles[position]
    if file.titles.count(title) > 1:
        raise InputError(file.place, f"one column {printable(title)}", f"{file.titles.count(title)} of them")
    return position


def _unit(file: ColumnFile, position: int, role: str, wanted: str) -> str:
    given = wanted or file.units[position]
    name = SPELLINGS[role].get(_spelling(given), "") if given else SI[role]
    if not name:
        place = f"{file.place}, column {printable(file.titles[position])}"
        accepted = ", ".join(dict.fromkeys(SPELLINGS[role].values()))
        raise InputError(place, f"a unit of {role} ({accepted})", repr(printable(given)))
    return name


def _spelling(unit: str) -> str:
    return _FILLERS.sub("", unit)


def _scale(name: str, si: str) -> float:
    return units.to_si(1.0, name, si)
