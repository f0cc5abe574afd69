"""`nw_gear modes`: natural frequencies, shapes, who takes part in them, and the Campbell diagram."""

from __future__ import annotations

import dataclasses
import json
import math
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nw_gear_common.errors import InputError
from nw_gear_sim.commands.point import (
    AngleOption,
    ConfigOption,
    JsonOption,
    LoadOption,
    Point,
    SpeedOption,
    prepare,
    read_point,
    remark,
)

if TYPE_CHECKING:
    from nw_gear_sim.campbell import Campbell
    from nw_gear_sim.gearbox import Gearbox
    from nw_gear_sim.linear import Modes, Shapes
    from nw_gear_sim.params import Configuration
    from nw_gear_sim.participation import Participation

MOST_FOLLOWED = 0.7
"""Share of all modes that can be followed over the speed; some have to be left to tell them from."""
METHOD = "all eigenvalues of the first-order system [0 1; -K/M -C/M] at the equilibrium, dense QR algorithm"


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
    prepare()
    from nw_gear_sim import config as configurations  # noqa: PLC0415 - numba and scipy only where they are needed
    from nw_gear_sim.elements import find_elements, rigid_motions  # noqa: PLC0415
    from nw_gear_sim.equilibrium import find_equilibrium  # noqa: PLC0415
    from nw_gear_sim.gearbox import Gearbox  # noqa: PLC0415
    from nw_gear_sim.linear import find_shapes, linearise  # noqa: PLC0415
    from nw_gear_sim.participation import participations  # noqa: PLC0415

    configuration = configurations.load(config)
    point = read_point(configuration, load, speed, angle)
    if output is not None:
        _prepare(output)
    gearbox = Gearbox(configuration)
    said = remark(configuration, gearbox.kinematics)
    q = find_equilibrium(gearbox, point.torque, speed=point.speed, angle=point.angle).q
    found, every = find_shapes(linearise(gearbox, q))
    shapes = every.first(count)
    elements, rigid = find_elements(gearbox, q), rigid_motions(gearbox, point.angle)
    taking_part = participations(shapes, gearbox.mass, gearbox.layout, elements, rigid)
    shown = _object(configuration, gearbox, point, found, shapes, taking_part) | {"remarks": said}
    diagram = None
    if campbell or output is not None:
        torque = point.torque if constant_load else None
        diagram = _follow(configuration, gearbox, torque, point.angle, (count, speeds, fastest, separation))
    if output is not None:
        words = _conditions(configuration, point)
        try:
            shown["files"] = _write(output, shown, gearbox, shapes, taking_part, diagram, point, words, constant_load)
        except OSError as error:
            raise InputError(f"-o {output}", "files that can be written", error.strerror or str(error)) from None
    if with_shapes:
        shown["shapes"] = _shapes_object(gearbox, shapes)
    if as_json:
        if diagram is not None:
            from nw_gear_sim.campbell import as_object  # noqa: PLC0415

            shown["campbell"] = as_object(diagram)
        print(json.dumps(shown))
    else:
        _print(configuration, point, shown, shapes, taking_part, diagram)


def _prepare(output: Path) -> None:
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


def _object(
    configuration: Configuration,
    gearbox: Gearbox,
    point: Point,
    found: Modes,
    shapes: Shapes,
    taking_part: list[Participation],
) -> dict[str, Any]:
    from nw_gear_sim.participation import complexity  # noqa: PLC0415

    out_of_phase = complexity(shapes, gearbox.mass)
    return {
        "degrees_of_freedom": gearbox.layout.size,
        "frequencies_hz": found.frequencies_hz.tolist(),
        "damping_ratio": found.damping_ratio.tolist(),
        "largest_eigenvalue": found.largest_eigenvalue,
        "largest_stable_step": found.largest_stable_step if math.isfinite(found.largest_stable_step) else None,
        "method": METHOD,
        "torque": point.torque,
        "speed": point.speed,
        "angle": point.angle,
        "friction": configuration.friction.enabled,
        "modes": [
            {
                "number": k + 1,
                "frequency_hz": float(shapes.frequencies_hz[k]),
                "damping_ratio": float(shapes.damping_ratio[k]),
                "complexity": float(out_of_phase[k]),
                **dataclasses.asdict(mode),
            }
            for k, mode in enumerate(taking_part)
        ],
    }


def _shapes_object(gearbox: Gearbox, shapes: Shapes) -> dict[str, Any]:
    return {
        "motions": [gearbox.layout.name(k) for k in range(gearbox.layout.size)],
        "mass": gearbox.mass.tolist(),
        "real": shapes.vectors.real.T.tolist(),
        "imaginary": shapes.vectors.imag.T.tolist(),
    }


def _follow(
    configuration: Configuration,
    gearbox: Gearbox,
    torque: float | None,
    angle: float,
    wanted: tuple[int, int, float, float],
) -> Campbell:
    import numpy as np  # noqa: PLC0415

    from nw_gear_sim.campbell import find_campbell, wind_torque  # noqa: PLC0415

    turbine = configuration.turbine
    count, speeds, fastest, separation = wanted
    followed = min(count, int(MOST_FOLLOWED * gearbox.layout.size))
    course = wind_torque(turbine.rated_torque, turbine.rated_speed) if torque is None else lambda _speed: torque
    try:
        return find_campbell(
            gearbox,
            course,
            rated=turbine.rated_speed,
            speeds=np.linspace(0, fastest * turbine.rated_speed, speeds),
            count=followed,
            separation=separation,
            angle=angle,
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


def _conditions(configuration: Configuration, point: Point) -> str:
    load = point.torque / configuration.turbine.rated_torque
    rubbing = "on" if configuration.friction.enabled else "off"
    return (
        f"Linearised at the static equilibrium under {point.torque / 1e6:.4g} MN m ({load:.4g} of rated torque), "
        f"with the ring at {point.angle:.4g} rad, which sets the mesh stiffness; friction {rubbing}."
    )


def _write(
    output: Path,
    shown: dict[str, Any],
    gearbox: Gearbox,
    shapes: Shapes,
    taking_part: list[Participation],
    diagram: Campbell | None,
    point: Point,
    words: str,
    constant_load: bool,
) -> dict[str, str]:
    import numpy as np  # noqa: PLC0415

    from nw_gear_sim.campbell import as_object  # noqa: PLC0415
    from nw_gear_sim.drawings.campbell_page import campbell_page  # noqa: PLC0415 - bokeh
    from nw_gear_sim.drawings.shapes_page import shapes_page  # noqa: PLC0415

    files = {name: str(output / name) for name in ("modes.json", "shapes.npz", "shapes.html")}
    (output / "modes.json").write_text(json.dumps(shown), encoding="utf-8")
    np.savez_compressed(
        output / "shapes.npz",
        eigenvalues=shapes.eigenvalues,
        vectors=shapes.vectors,
        motions=np.array([gearbox.layout.name(k) for k in range(gearbox.layout.size)]),
        mass=gearbox.mass,
    )
    page = shapes_page(gearbox, shapes, taking_part, words, point.angle)
    (output / "shapes.html").write_text(page, encoding="utf-8")
    if diagram is not None:
        files |= {name: str(output / name) for name in ("campbell.json", "campbell.html")}
        follows = (
            "is the same at all speeds" if constant_load else "follows the wind law (paper Eq 2) up to rated speed"
        )
        text = f"The load {follows}; the ring stands at {point.angle:.4g} rad, which sets the mesh stiffness."
        (output / "campbell.json").write_text(json.dumps(as_object(diagram)), encoding="utf-8")
        (output / "campbell.html").write_text(campbell_page(diagram, text), encoding="utf-8")
    return files


def _print(
    configuration: Configuration,
    point: Point,
    shown: dict[str, Any],
    shapes: Shapes,
    taking_part: list[Participation],
    diagram: Campbell | None,
) -> None:
    from nw_gear_sim.commands.tables import show  # noqa: PLC0415
    from nw_gear_sim.participation import strongest  # noqa: PLC0415

    print(_conditions(configuration, point))
    step = shown["largest_stable_step"]
    bound = "none" if step is None else f"{step:.6g} s"
    print(
        f"{shown['degrees_of_freedom']} degrees of freedom; largest |lambda| {shown['largest_eigenvalue']:.6g} rad/s; "
        f"largest stable step of rk4 {bound}"
    )
    rows = []
    for k, mode in enumerate(taking_part):
        strain = ", ".join(f"{name} {share:.0%}" for name, share in strongest(mode.strain, 3) if share >= 0.05)
        numbers = [f"{shapes.frequencies_hz[k]:.2f}", f"{100 * shapes.damping_ratio[k]:.2f}"]
        rows.append([str(k + 1), *numbers, mode.name, strain])
    show("Modes", ["mode", "Hz", "damping (%)", "what", "strain energy in"], rows)
    if diagram is not None:
        _print_crossings(diagram)
    for path in shown.get("files", {}).values():
        print(path)


def _print_crossings(diagram: Campbell) -> None:
    from nw_gear_sim.commands.tables import show  # noqa: PLC0415

    rows = [
        [row.order, f"{row.excitation_hz:.1f}", str(row.mode), f"{row.frequency_hz:.1f}", f"{row.margin:+.1%}",
         f"{row.share:.1%}" if math.isfinite(row.share) else "-", diagram.modes[row.mode - 1].name]
        for row in diagram.margins
    ]  # fmt: skip
    columns = ["excited by", "Hz", "mode", "natural Hz", "margin", "strain energy there", "what"]
    show(f"Natural frequencies within {diagram.separation:.0%} of an excitation at rated speed", columns, rows)
