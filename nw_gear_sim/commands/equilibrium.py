"""`nw_gear equilibrium`: the gearbox at rest under its load."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nw_gear_sim.commands.point import (
    AngleOption,
    ConfigOption,
    JsonOption,
    LoadOption,
    SpeedOption,
    read_point,
    remark,
)

if TYPE_CHECKING:
    from nw_gear_sim.gearbox import Gearbox
    from nw_gear_sim.params import Configuration
    from nw_gear_sim.statics import Statics


def equilibrium(
    config: ConfigOption = "",
    load: LoadOption = "1",
    speed: SpeedOption = "",
    angle: AngleOption = "0",
    pure: Annotated[
        bool, typer.Option("--nondimensional", help="Show pure numbers in the paper's units, parameters included.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Find the static equilibrium: mesh displacements and forces, load shares, bearing forces, torques."""
    from nw_gear_sim import config as configurations  # noqa: PLC0415 - numba and scipy only where they are needed
    from nw_gear_sim.gearbox import Gearbox  # noqa: PLC0415
    from nw_gear_sim.statics import as_object, find_statics  # noqa: PLC0415

    configuration = configurations.load(config)
    point = read_point(configuration, load, speed, angle)
    gearbox = Gearbox(configuration)
    said = remark(configuration, gearbox.kinematics)
    found = find_statics(configuration, gearbox, torque=point.torque, speed=point.speed, angle=point.angle)
    shown = as_object(found) | {"friction": configuration.friction.enabled, "remarks": said}
    if pure:
        shown["nondimensional"] = _pure(configuration, gearbox, found)
    if as_json:
        print(json.dumps(shown))
        return
    _print(configuration, found)
    if pure:
        _print_pure(shown["nondimensional"])


def _pure(configuration: Configuration, gearbox: Gearbox, found: Statics) -> Any:
    from nw_gear_common import names  # noqa: PLC0415
    from nw_gear_sim import nondimensional  # noqa: PLC0415

    kinematics = gearbox.kinematics
    scale = nondimensional.scales(configuration, kinematics)
    si = {"x": found.displacement, "force": found.force, "bearing_force": found.bearing_force[None]}
    numbers = nondimensional.signals(si, configuration, kinematics)
    return {
        "scales": {"length": scale.length, "frequency": scale.frequency},
        "mesh": {
            mesh: {"displacement": float(x), "force": float(f)}
            for mesh, x, f in zip(names.MESHES, numbers["x"], numbers["force"], strict=True)
        },
        "bearing": {
            bearing: dict(zip("xyz", map(float, force), strict=True))
            for bearing, force in zip(names.BEARINGS, numbers["bearing_force"][0], strict=True)
        },
        "derived": nondimensional.derived(configuration, kinematics),
        "parameters": nondimensional.parameters(configuration, kinematics),
    }


def _print(configuration: Configuration, found: Statics) -> None:
    from nw_gear_common import names  # noqa: PLC0415
    from nw_gear_sim.commands.tables import show  # noqa: PLC0415

    rubbing = "on" if configuration.friction.enabled else "off"
    load = found.torque / configuration.turbine.rated_torque
    print(
        f"Static equilibrium at {found.torque / 1e6:.4g} MN m ({load:.4g} of rated), ring at {found.angle:.4g} rad, "
        f"friction {rubbing}"
    )
    print(f"Largest force left: {found.found.residual:.2g} N after {found.found.iterations} iterations")
    unit = configuration.mesh.II.backlash
    shares = {
        f"{stage}_{j + 1}": share for stage, planets in found.load_share.items() for j, share in enumerate(planets)
    }
    rows = []
    for mesh, x, force in zip(names.MESHES, found.displacement, found.force, strict=True):
        share = shares.get(mesh, math.nan)
        relative = f"{x / unit:.3f}" if unit else "-"
        rows.append(
            [mesh, f"{x * 1e6:.2f}", relative, f"{force / 1e3:.2f}", "-" if math.isnan(share) else f"{share:.3f}"]
        )
    show("Meshes", ["mesh", "x_n (um)", "x_n / b_II", "force (kN)", "load share"], rows)
    rows = [
        [bearing, *(f"{part / 1e3:.2f}" for part in force), f"{math.hypot(*force[:2]) / 1e3:.2f}"]
        for bearing, force in zip(names.BEARINGS, found.bearing_force, strict=True)
    ]
    show("Forces on the bearings' housings (kN)", ["bearing", "x", "y", "z", "radial"], rows)
    rows = [[part, "-" if math.isnan(r) else f"{r:.12f}"] for part, r in found.torque_ratio.items()]
    show("Torque carried over input torque (speeds divided out)", ["at", "ratio"], rows)


def _print_pure(numbers: Any) -> None:
    from nw_gear_sim.commands.tables import show  # noqa: PLC0415
    from nw_gear_sim.nondimensional import UNITS  # noqa: PLC0415

    scale = numbers["scales"]
    print(f"Units: length b_II = {scale['length'] * 1e6:g} um, omega_n = {scale['frequency']:.6g} rad/s")
    rows = [[mesh, f"{v['displacement']:.6g}", f"{v['force']:.6g}"] for mesh, v in numbers["mesh"].items()]
    show("Meshes", ["mesh", "x_n / b_II", "F / (M_e b_II omega_n^2)"], rows)
    rows = [[name, f"{value:.6g}"] for name, value in numbers["derived"].items()]
    show("Numbers of the equations", ["symbol", "value"], rows)
    rows = [[key, f"{value:.6g}", UNITS[key][0]] for key, value in numbers["parameters"].items()]
    show("Parameters", ["key", "value", "meaning"], rows)
