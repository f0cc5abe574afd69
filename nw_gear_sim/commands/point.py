"""The operating point of a command: load, speed and angle as a user writes them."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

from nw_gear_common.errors import InputError
from nw_gear_common.quantities import Quantity, check_value

if TYPE_CHECKING:
    from nw_gear_sim.kinematics import Kinematics
    from nw_gear_sim.params import Configuration

ConfigOption = Annotated[
    str, typer.Option("--config", help="Configuration file or preset laid over the default one.", show_default=False)
]
LoadOption = Annotated[str, typer.Option("--load", help="Torque over rated torque, such as 0.5 or '50 %'.")]
SpeedOption = Annotated[
    str,
    typer.Option(
        "--speed", help="Speed of the ring, rad/s or such as '17.3 r/min' (default rated).", show_default=False
    ),
]
AngleOption = Annotated[str, typer.Option("--angle", help="Angle of the ring, rad or such as '30 deg'.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")]

LOAD = Quantity("load", "", minimum=-10.0, maximum=10.0)
SPEED = Quantity("speed", "rad/s", minimum=0.0, maximum=1e3)
ANGLE = Quantity("angle", "rad", minimum=-1e6, maximum=1e6)


@dataclass(frozen=True)
class Point:
    """Torque on the ring (N m), its speed (rad/s) and angle (rad)."""

    torque: float
    speed: float
    angle: float


def read_point(configuration: Configuration, load: str, speed: str, angle: str) -> Point:
    """Turn the options into a point; an empty speed is the rated one.

    Raises:
        InputError: no number, a wrong unit, or out of range.
    """
    turbine = configuration.turbine
    return Point(
        torque=number("--load", load, LOAD) * turbine.rated_torque,
        speed=number("--speed", speed, SPEED) if speed.strip() else turbine.rated_speed,
        angle=number("--angle", angle, ANGLE),
    )


def number(place: str, text: str, description: Quantity) -> float:
    """Read a number, in SI or with one of the units that a configuration file may use there.

    Raises:
        InputError: no number, a wrong unit, or out of range.
    """
    from nw_gear_common import units  # noqa: PLC0415 - only where a command runs

    value, unit = text, description.unit
    parts = units.split(text)
    if parts is not None and parts[1] in units.accepted(description.unit):
        value, unit = str(parts[0]), parts[1]
    try:
        found = float(value)
    except ValueError:
        choices = ", ".join(u for u in units.accepted(description.unit) if u != "1")
        raise InputError(place, f"{description.expected(float)}, or with a unit ({choices})", repr(text)) from None
    checked = check_value(place, units.to_si(found, unit, description.unit), float, description)
    return float(checked)


def remark(configuration: Configuration, kinematics: Kinematics) -> list[str]:
    """Say on standard error what is odd about a configuration, and return it."""
    from nw_gear_sim.remarks import remarks  # noqa: PLC0415

    found = remarks(configuration, kinematics)
    for sentence in found:
        print(f"nw_gear: {sentence}", file=sys.stderr)
    return found
