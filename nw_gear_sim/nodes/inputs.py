"""What drives the simulator node: the source that its parameters choose, and speed and torque from a message."""

from __future__ import annotations

import math
from collections.abc import Sequence

from nw_gear_common.errors import InputError
from nw_gear_sim.drivefile import parse_columns, read_drive_file
from nw_gear_sim.drives import SPEED, TORQUE, FixedPoint, Followed, Recorded, Source, WindDriven
from nw_gear_sim.loadcase import LoadCase
from nw_gear_sim.nodes.sim_settings import Settings
from nw_gear_sim.params import Configuration

RING = "ring"
"""Joint of the topic `drive`."""


def make_source(settings: Settings, configuration: Configuration) -> Source:
    """Return what drives the gearbox.

    Raises:
        InputError: parameters that don't go together, or a file that can't be used.
    """
    drive = settings.drive or ("file" if settings.drive_file else configuration.operation.drive)
    if settings.drive_file and drive != "file":
        raise InputError("parameter drive_file", "nothing where drive isn't file", settings.drive_file)
    if settings.scenario:
        if drive not in ("wind", "fixed"):
            raise InputError("parameter scenario", "nothing, or a drive by the wind or fixed", f"drive {drive}")
        return LoadCase(configuration, settings.scenario, settings.scenario_time, windy=drive == "wind")
    if drive == "wind":
        return WindDriven(configuration)
    if drive == "fixed":
        return FixedPoint(configuration)
    if drive == "topic":
        return Followed()
    if not settings.drive_file:
        raise InputError("parameter drive_file", "a file, as drive is file", "nothing")
    columns = parse_columns(settings.drive_columns) if settings.drive_columns else None
    series = read_drive_file(settings.drive_file, columns=columns, gaps=settings.drive_gaps)
    return Recorded(series, hold=settings.drive_end == "hold")


def ring_sample(names: Sequence[str], velocity: Sequence[float], effort: Sequence[float]) -> dict[str, float] | None:
    """Return speed (rad/s) and torque (N m) of the ring in a message, None where there is nothing to go by."""
    if RING not in names:
        return None
    k = list(names).index(RING)
    if k >= len(velocity) or k >= len(effort):
        return None
    speed, torque = float(velocity[k]), float(effort[k])
    sample = {SPEED: speed, TORQUE: torque}
    return sample if math.isfinite(speed) and math.isfinite(torque) and speed >= 0.0 else None
