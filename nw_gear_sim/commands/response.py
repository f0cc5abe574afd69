"""`nw_gear study response`: time histories, spectra, phase diagrams, sections and wavelet maps at chosen points."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tidy import FORMATS
from nw_gear_sim.commands import axes as named
from nw_gear_sim.commands.point import ConfigOption, JsonOption
from nw_gear_sim.commands.telling import Teller

if TYPE_CHECKING:
    from nw_gear_sim.studies.diagram import Row
    from nw_gear_sim.studies.store import Store

STAGES = ("I_1", "II_1", "III")


def response(
    over: Annotated[
        str, typer.Option("--over", help="KEY=A,B,C or KEY=START:STOP:COUNT, such as excitation.omega_e=0.17,0.205.")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder; an interrupted study goes on there.")],
    config: ConfigOption = "",
    excitation: Annotated[str, typer.Option("--excitation", help="tied (as in the paper) or kinematic.")] = "tied",
    ring: Annotated[str, typer.Option("--ring", help="flexible or rigid.")] = "flexible",
    all_meshes: Annotated[bool, typer.Option("--all-meshes", help="All seven meshes, not one of each stage.")] = False,
    transient: Annotated[int, typer.Option("--transient", help="Mesh periods of stage II left out.")] = 100,
    record: Annotated[int, typer.Option("--record", help="Mesh periods of stage II recorded.")] = 200,
    exponent_periods: Annotated[
        int, typer.Option("--exponent-periods", help="Periods between pulls of the twins; 0: no exponents, no states.")
    ] = 5,
    workers: Annotated[int | None, typer.Option("--workers", help="Processes (default: cores).")] = None,
    dask: Annotated[str, typer.Option("--dask", help="Scheduler of an existing Dask cluster.")] = "",
    form: Annotated[str, typer.Option("--format", help="Of the tables: parquet or csv.")] = "parquet",
    as_json: JsonOption = False,
) -> None:
    """Show how the meshes move at points of an axis: over time, in frequency, in the phase plane, and all along it."""
    from nw_gear_sim import config as configurations  # noqa: PLC0415 - numba and scipy only where they are needed
    from nw_gear_sim.studies import bifurcation  # noqa: PLC0415
    from nw_gear_sim.studies import response as study  # noqa: PLC0415
    from nw_gear_sim.studies.diagram import rows  # noqa: PLC0415
    from nw_gear_sim.studies.runner import run  # noqa: PLC0415
    from nw_gear_sim.studies.store import Store  # noqa: PLC0415

    key, values = named.axis("--over", over)
    values = np.unique(values)
    for place, value, known in (
        ("--excitation", excitation, ("tied", "kinematic")),
        ("--ring", ring, ("flexible", "rigid")),
        ("--format", form, FORMATS),
    ):
        if value not in known:
            raise InputError(place, " or ".join(known), value)
    plan = bifurcation.Plan(
        excitation=excitation, ring=ring, transient=transient, record=record, exponent_periods=exponent_periods
    )
    base = configurations.load(config)
    points = bifurcation.grid(base, [(key, values)])
    store = Store(output, study.describe(base, key, values, plan))
    teller = Teller(len(points))
    pieces = study.blocks(points, plan)
    run(pieces, study.compute, store, workers=workers, dask=dask, say=teller.progress)
    teller.cost()
    for damaged in store.damaged:
        print(f"nw_gear: piece {damaged} was damaged, put aside and computed again", file=sys.stderr)
    meshes = names.MESHES if all_meshes else STAGES
    found = [row for row in rows(store, [(v,) for v in values.tolist()], False) if row.mesh in meshes]
    files = _write(store, (key, values, points, plan, meshes), found, form)
    if as_json:
        print(json.dumps({"axes": [key], "rows": [row.as_object([key]) for row in found], "files": files}))
    else:
        _print(found, key, files)


def _write(store: Store, study: tuple[Any, ...], found: list[Row], form: str) -> list[str]:
    from nw_gear_common import tidy  # noqa: PLC0415 - see response
    from nw_gear_sim.drawings.response_data import Collector  # noqa: PLC0415
    from nw_gear_sim.drawings.response_page import page  # noqa: PLC0415
    from nw_gear_sim.studies import response_tables as tables  # noqa: PLC0415
    from nw_gear_sim.studies.diagram import points_table  # noqa: PLC0415
    from nw_gear_sim.studies.response import responses  # noqa: PLC0415

    key, values, points, plan, meshes = study
    folder, about = store.folder, {"study": "response", "over": key, "excitation": plan.excitation}
    collector = Collector(values, meshes)
    files = [folder / f"points.{form}"]
    tidy.write(files[0], points_table(found, [key]), about)
    made = {"histories": tables.histories, "spectra": tables.spectra, "sections": tables.sections}
    for name in made:
        _folder(folder / name)
        files.append(folder / name)
    for piece in sorted(store.done()):
        own = list(responses(store, piece, points, values, plan, meshes))
        collector.add(own)
        for name, make in made.items():
            tidy.write(folder / name / f"{piece}.{form}", make(own, key), about)
    drawing = folder / "response.html"
    try:
        drawing.write_text(page(collector, found, key, plan.excitation), encoding="utf-8")
    except OSError as error:
        raise InputError(f"-o {folder}", "room for the results", error.strerror or str(error)) from None
    return [str(path) for path in (*files, drawing)]


def _folder(path: Path) -> None:
    try:
        path.mkdir(exist_ok=True)
        for old in path.glob("points-*"):
            old.unlink()  # they may be of another format
    except OSError as error:
        raise InputError(f"-o {path.parent}", "a folder to write to", error.strerror or str(error)) from None


def _print(found: list[Row], key: str, files: list[str]) -> None:
    from nw_gear_sim.commands.tables import show  # noqa: PLC0415 - see response

    lines = []
    for row in found:
        mark = "" if row.settled else " *"
        swing = [f"{1e6 * row.deviation:.3g}", f"{100 * row.open:.1f}", f"{100 * row.back:.1f}"]
        lines.append([f"{row.values[0]:.6g}", row.mesh, row.state + mark, f"{row.rate:.2f} +- {row.error:.2f}", *swing])
    show("Response", [key, "mesh", "state", "exponent (1/s)", "deviation (um)", "open (%)", "back (%)"], lines)
    print("* both halves of the record differ: more --transient may help\n" + "\n".join(files))
