"""`nw_gear study bifurcation`: Poincare sections, states and exponents over any number of the configuration."""

from __future__ import annotations

import itertools
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nw_gear_common.errors import InputError
from nw_gear_common.tidy import FORMATS
from nw_gear_sim.commands import axes as named
from nw_gear_sim.commands.point import ConfigOption, JsonOption
from nw_gear_sim.commands.telling import Teller

if TYPE_CHECKING:
    from nw_gear_sim.studies.diagram import Row

MOST_AXES = 2


def bifurcation(
    over: Annotated[
        list[str],
        typer.Option("--over", help="KEY=START:STOP:COUNT of the configuration; twice for a map."),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder; an interrupted study goes on there.")],
    config: ConfigOption = "",
    excitation: Annotated[str, typer.Option("--excitation", help="tied (as in the paper) or kinematic.")] = "tied",
    ring: Annotated[str, typer.Option("--ring", help="flexible or rigid.")] = "flexible",
    sweep: Annotated[
        bool, typer.Option("--sweep", help="Carry the state from point to point, up and down: shows hysteresis.")
    ] = False,
    transient: Annotated[int, typer.Option("--transient", help="Mesh periods of stage II left out.")] = 100,
    record: Annotated[int, typer.Option("--record", help="Mesh periods of stage II recorded.")] = 200,
    exponent_periods: Annotated[
        int, typer.Option("--exponent-periods", help="Periods between pulls of the twins; 0: no exponents.")
    ] = 5,
    workers: Annotated[int | None, typer.Option("--workers", help="Processes (default: cores).")] = None,
    dask: Annotated[str, typer.Option("--dask", help="Scheduler of an existing Dask cluster.")] = "",
    form: Annotated[str, typer.Option("--format", help="Of the tables: parquet or csv.")] = "parquet",
    as_json: JsonOption = False,
) -> None:
    """Find how the motion changes over a parameter: sections, periods, largest exponent, separation of flanks."""
    from nw_gear_sim import config as configurations  # noqa: PLC0415 - numba and scipy only where they are needed
    from nw_gear_sim.studies import bifurcation as study  # noqa: PLC0415
    from nw_gear_sim.studies.diagram import rows  # noqa: PLC0415
    from nw_gear_sim.studies.runner import run  # noqa: PLC0415
    from nw_gear_sim.studies.store import Store  # noqa: PLC0415

    axes = [named.axis("--over", text) for text in over]
    if len(axes) > MOST_AXES or (sweep and len(axes) > 1) or (sweep and dask):
        raise InputError("--over", "one axis, or two without --sweep; --sweep goes without --dask", ", ".join(over))
    for place, value, known in (
        ("--excitation", excitation, ("tied", "kinematic")),
        ("--ring", ring, RINGS),
        ("--format", form, FORMATS),
    ):
        if value not in known:
            raise InputError(place, " or ".join(known), value)
    plan = study.Plan(
        excitation=excitation, ring=ring, transient=transient, record=record, exponent_periods=exponent_periods
    )
    base = configurations.load(config)
    points = study.grid(base, axes)
    store = Store(output, study.describe(base, axes, plan, sweep))
    if sweep:
        study.sweep(points, plan, store, _say_points)
    else:
        teller = Teller(len(points))
        run(study.blocks(points, plan), study.compute, store, workers=workers, dask=dask, say=teller.progress)
        teller.cost()
    for key in store.damaged:
        print(f"nw_gear: piece {key} was damaged, put aside and computed again", file=sys.stderr)
    keys = [name for name, _ in axes]
    found = rows(store, list(itertools.product(*(values.tolist() for _, values in axes))), sweep)
    files = _write(output, found, keys, form)
    if as_json:
        print(json.dumps({"axes": keys, "rows": [row.as_object(keys) for row in found], "files": files}))
    else:
        _print(found, keys, files)


RINGS = ("flexible", "rigid")


def _write(folder: Path, found: list[Row], keys: list[str], form: str) -> list[str]:
    from nw_gear_common import tidy  # noqa: PLC0415 - see bifurcation
    from nw_gear_sim.drawings.bifurcation_page import page  # noqa: PLC0415
    from nw_gear_sim.studies.diagram import points_table, sections_table  # noqa: PLC0415

    about = {"study": "bifurcation", "over": ", ".join(keys)}
    points, sections, drawing = folder / f"points.{form}", folder / f"sections.{form}", folder / "diagram.html"
    tidy.write(points, points_table(found, keys), about)
    tidy.write(sections, sections_table(found, keys), about)
    try:
        drawing.write_text(page(found, keys), encoding="utf-8")
    except OSError as error:
        raise InputError(f"-o {folder}", "room for the results", error.strerror or str(error)) from None
    return [str(path) for path in (points, sections, drawing)]


def _print(found: list[Row], keys: list[str], files: list[str]) -> None:
    from nw_gear_sim.commands.tables import show  # noqa: PLC0415 - see bifurcation

    stages: dict[tuple[Any, ...], dict[str, Row]] = {}
    for row in found:
        stages.setdefault((*row.values, row.sweep), {})[row.mesh] = row
    lines = []
    for place, meshes in stages.items():
        first = meshes["I_1"]
        rate = f"{first.rate:.2f} +- {first.error:.2f}"
        states = [meshes[mesh].state + ("" if meshes[mesh].settled else " *") for mesh in ("I_1", "II_1", "III")]
        lines.append([f"{place[0]:.6g}", *(str(p) for p in place[1:]), *states, rate])
    show("Bifurcation", [*keys, "sweep", "I_1", "II_1", "III", "exponent (1/s)"], lines)
    print("* both halves of the record differ: more --transient may help\n" + "\n".join(files))


def _say_points(done: int, total: int) -> None:
    if done % 10 == 0 or done == total:
        print(f"{done} of {total} points of both sweeps", file=sys.stderr, flush=True)
