"""`nw_gear modes`: natural frequencies, shapes, who takes part in them, and the Campbell diagram."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nw_gear_common.errors import InputError
from nw_gear_sim.commands.point import (
    AngleOption,
    ConfigOption,
    JsonOption,
    LoadOption,
    Point,
    SpeedOption,
    read_point,
    remark,
)

if TYPE_CHECKING:
    from nw_gear_sim.campbell import Campbell
    from nw_gear_sim.commands.modes_output import Findings
    from nw_gear_sim.params import Configuration

MOST_FOLLOWED = 0.7
"""Share of all modes that can be followed over the speed; some have to be left to tell them from."""


def modes(
    config: ConfigOption = "",
    load: LoadOption = "1",
    speed: SpeedOption = "",
    angle: AngleOption = "0",
    count: Annotated[int, typer.Option("--count", help="Modes shown, and followed over the speed.", min=1)] = 40,
    campbell: Annotated[bool, typer.Option("--campbell", help="Follow the modes over the speed.")] = False,
    constant_load: Annotated[
        bool, typer.Option("--constant-load", help="Keep the load over the speed, instead of that of the wind.")
    ] = False,
    fastest: Annotated[float, typer.Option("--to-speed", help="Highest speed over rated.", min=1.0, max=3.0)] = 1.3,
    speeds: Annotated[int, typer.Option("--speeds", help="Speeds at which modes are found.", min=3, max=1000)] = 27,
    separation: Annotated[
        float, typer.Option("--separation", help="Distance below which an excitation is near.", min=0.0, max=1.0)
    ] = 0.1,
    with_shapes: Annotated[bool, typer.Option("--shapes", help="Put the shapes into the JSON object.")] = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Folder for modes.json, shapes.npz, shapes.html, campbell.json and .html."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Find natural frequencies, damping, shapes and energies at the equilibrium; Campbell diagram over the speed."""
    from nw_gear_sim import config as configurations  # noqa: PLC0415 - numba and scipy only where they are needed
    from nw_gear_sim.commands import modes_output  # noqa: PLC0415

    configuration = configurations.load(config)
    point = read_point(configuration, load, speed, angle)
    if output is not None:
        _make(output)
    found = _find(configuration, point, count)
    shown = modes_output.as_object(found)
    diagram = None
    if campbell or output is not None:
        diagram = _follow(found, constant_load, speeds, fastest, separation)
    if output is not None:
        try:
            shown["files"] = modes_output.write(output, shown, found, diagram, constant_load)
        except OSError as error:
            raise InputError(f"-o {output}", "files that can be written", error.strerror or str(error)) from None
    if as_json:
        print(json.dumps(modes_output.whole_object(shown, found, diagram, with_shapes)))
    else:
        modes_output.show_modes(shown, found, diagram)


def _make(output: Path) -> None:
    """Make the folder before anything is computed.

    Raises:
        InputError: it can't be made or written to.
    """
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"-o {output}", "a folder that can be made", error.strerror or str(error)) from None
    if not os.access(output, os.W_OK):
        raise InputError(f"-o {output}", "a folder that can be written to", "a read-only one")


def _find(configuration: Configuration, point: Point, count: int) -> Findings:
    from nw_gear_sim.commands.modes_output import Findings  # noqa: PLC0415 - see modes
    from nw_gear_sim.elements import find_elements, rigid_motions  # noqa: PLC0415
    from nw_gear_sim.equilibrium import find_equilibrium  # noqa: PLC0415
    from nw_gear_sim.gearbox import Gearbox  # noqa: PLC0415
    from nw_gear_sim.linear import find_shapes, linearise  # noqa: PLC0415
    from nw_gear_sim.participation import participations  # noqa: PLC0415

    gearbox = Gearbox(configuration)
    said = remark(configuration, gearbox.kinematics)
    q = find_equilibrium(gearbox, point.torque, speed=point.speed, angle=point.angle).q
    every_value, every_shape = find_shapes(linearise(gearbox, q))
    shapes = every_shape.first(count)
    elements, rigid = find_elements(gearbox, q), rigid_motions(gearbox, point.angle)
    taking_part = participations(shapes, gearbox.mass, gearbox.layout, elements, rigid)
    return Findings(configuration, gearbox, point, every_value, shapes, taking_part, said)


def _follow(found: Findings, constant_load: bool, speeds: int, fastest: float, separation: float) -> Campbell:
    import numpy as np  # noqa: PLC0415 - see modes

    from nw_gear_sim.campbell import find_campbell, wind_torque  # noqa: PLC0415

    turbine = found.configuration.turbine
    follows_wind = wind_torque(turbine.rated_torque, turbine.rated_speed)
    try:
        return find_campbell(
            found.gearbox,
            (lambda _speed: found.point.torque) if constant_load else follows_wind,
            rated=turbine.rated_speed,
            speeds=np.linspace(0, fastest * turbine.rated_speed, speeds),
            count=min(len(found.taking_part), int(MOST_FOLLOWED * found.gearbox.layout.size)),
            separation=separation,
            angle=found.point.angle,
            progress=_progress,
        )
    finally:
        _progress(0, 0)


def _progress(done: int, total: int) -> None:
    """Say on standard error how far it is: in place on a terminal, now and then elsewhere; (0, 0) clears the line."""
    if sys.stderr.isatty():
        words = f"speed {done} of {total}" if total else ""
        print(f"\r\x1b[K{words}", end="", file=sys.stderr, flush=True)
    elif total and (done % 10 == 0 or done == total):
        print(f"speed {done} of {total}", file=sys.stderr, flush=True)
