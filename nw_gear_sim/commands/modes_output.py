"""What `nw_gear modes` hands out: the JSON object, files and pages, tables."""

from __future__ import annotations

import dataclasses
import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from nw_gear_sim import campbell
from nw_gear_sim.commands.point import Point
from nw_gear_sim.commands.tables import show
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.linear import Modes, Shapes
from nw_gear_sim.params import Configuration
from nw_gear_sim.participation import Participation, complexity, strongest

METHOD = "all eigenvalues of the first-order system [0 1; -K/M -C/M] at the equilibrium, dense QR algorithm"


@dataclass(frozen=True, eq=False)
class Findings:
    """A gearbox linearised at a point: all modes, the shapes asked for with what takes part in them, and remarks."""

    configuration: Configuration
    gearbox: Gearbox
    point: Point
    modes: Modes
    shapes: Shapes
    taking_part: list[Participation]
    remarks: list[str]


def as_object(found: Findings) -> dict[str, Any]:
    """Return the JSON object without shapes and diagram: SI units, frequencies in Hz."""
    modes, shapes, point = found.modes, found.shapes, found.point
    out_of_phase = complexity(shapes, found.gearbox.mass)
    step = modes.largest_stable_step
    return {
        "degrees_of_freedom": found.gearbox.layout.size,
        "frequencies_hz": modes.frequencies_hz.tolist(),
        "damping_ratio": modes.damping_ratio.tolist(),
        "largest_eigenvalue": modes.largest_eigenvalue,
        "largest_stable_step": step if math.isfinite(step) else None,
        "method": METHOD,
        **dataclasses.asdict(point),
        "friction": found.configuration.friction.enabled,
        "remarks": found.remarks,
        "modes": [
            {
                "number": k + 1,
                "frequency_hz": float(shapes.frequencies_hz[k]),
                "damping_ratio": float(shapes.damping_ratio[k]),
                "complexity": float(out_of_phase[k]),
                **dataclasses.asdict(mode),
            }
            for k, mode in enumerate(found.taking_part)
        ],
    }


def whole_object(
    shown: dict[str, Any], found: Findings, diagram: campbell.Campbell | None, with_shapes: bool
) -> dict[str, Any]:
    """Add diagram and shapes, as far as they are there and wanted."""
    out = dict(shown)
    if diagram is not None:
        out["campbell"] = campbell.as_object(diagram)
    if with_shapes:
        vectors = found.shapes.vectors
        out["shapes"] = {
            "motions": _motions(found.gearbox),
            "mass": found.gearbox.mass.tolist(),
            "real": vectors.real.T.tolist(),
            "imaginary": vectors.imag.T.tolist(),
        }
    return out


def _motions(gearbox: Gearbox) -> list[str]:
    return [gearbox.layout.name(k) for k in range(gearbox.layout.size)]


def _conditions(found: Findings) -> str:
    point = found.point
    load = point.torque / found.configuration.turbine.rated_torque
    rubbing = "on" if found.configuration.friction.enabled else "off"
    return (
        f"Linearised at the static equilibrium under {point.torque / 1e6:.4g} MN m ({load:.4g} of rated torque), "
        f"with the ring at {point.angle:.4g} rad, which sets the mesh stiffness; friction {rubbing}."
    )


def write(
    output: Path, shown: dict[str, Any], found: Findings, diagram: campbell.Campbell | None, constant_load: bool
) -> dict[str, str]:
    """Write data and pages into a folder and return their paths by name.

    Raises:
        OSError: a file can't be written.
    """
    from nw_gear_sim.drawings.campbell_page import campbell_page  # noqa: PLC0415 - bokeh is heavy
    from nw_gear_sim.drawings.shapes_page import shapes_page  # noqa: PLC0415

    shapes, gearbox, angle = found.shapes, found.gearbox, found.point.angle
    np.savez_compressed(
        output / "shapes.npz",
        eigenvalues=shapes.eigenvalues,
        vectors=shapes.vectors,
        motions=np.array(_motions(gearbox)),
        mass=gearbox.mass,
    )
    texts = {
        "modes.json": json.dumps(shown),
        "shapes.html": shapes_page(gearbox, shapes, found.taking_part, _conditions(found), angle),
    }
    if diagram is not None:
        follows = (
            "is the same at all speeds" if constant_load else "follows the wind law (paper Eq 2) up to rated speed"
        )
        words = f"The load {follows}; the ring stands at {angle:.4g} rad, which sets the mesh stiffness."
        texts["campbell.json"] = json.dumps(campbell.as_object(diagram))
        texts["campbell.html"] = campbell_page(diagram, words)
    for name, text in texts.items():
        (output / name).write_text(text, encoding="utf-8")
    return {name: str(output / name) for name in ("shapes.npz", *texts)}


def show_modes(shown: dict[str, Any], found: Findings, diagram: campbell.Campbell | None) -> None:
    """Print modes, margins at rated speed, and the paths of the files."""
    print(_conditions(found))
    step = shown["largest_stable_step"]
    bound = "none" if step is None else f"{step:.6g} s"
    print(
        f"{shown['degrees_of_freedom']} degrees of freedom; largest |lambda| {shown['largest_eigenvalue']:.6g} rad/s; "
        f"largest stable step of rk4 {bound}"
    )
    rows = []
    for k, mode in enumerate(found.taking_part):
        strain = ", ".join(f"{name} {share:.0%}" for name, share in strongest(mode.strain, 3) if share >= 0.05)
        numbers = [f"{found.shapes.frequencies_hz[k]:.2f}", f"{100 * found.shapes.damping_ratio[k]:.2f}"]
        rows.append([str(k + 1), *numbers, mode.name, strain])
    show("Modes", ["mode", "Hz", "damping (%)", "what", "strain energy in"], rows)
    if diagram is not None:
        _show_margins(diagram)
    for path in shown.get("files", {}).values():
        print(path)


def _show_margins(diagram: campbell.Campbell) -> None:
    rows = [
        [
            row.order,
            f"{row.excitation_hz:.1f}",
            str(row.mode),
            f"{row.frequency_hz:.1f}",
            f"{row.margin:+.1%}",
            f"{row.share:.1%}" if math.isfinite(row.share) else "-",
            diagram.modes[row.mode - 1].name,
        ]
        for row in diagram.margins
    ]
    columns = ["excited by", "Hz", "mode", "natural Hz", "margin", "strain energy there", "what"]
    show(f"Natural frequencies within {diagram.separation:.0%} of an excitation at rated speed", columns, rows)
