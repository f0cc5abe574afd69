"""`nw_gear study lyapunov`: exponents of the gearbox, at one point or along an axis."""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nw_gear_common.errors import InputError
from nw_gear_sim.commands import axes as named
from nw_gear_sim.commands.point import ConfigOption, JsonOption
from nw_gear_sim.commands.telling import Teller

if TYPE_CHECKING:
    from nw_gear_common.tables import Array
    from nw_gear_sim.params import Configuration
    from nw_gear_sim.studies.lyapunov import Plan, Row

SHOWN = 12
"""Exponents of a single point that are printed; the files have all."""


def lyapunov(
    over: Annotated[str, typer.Option("--over", help="KEY=START:STOP:COUNT of the configuration.")] = "",
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Folder for tables and page; an interrupted study goes on there."),
    ] = None,
    config: ConfigOption = "",
    excitation: Annotated[str, typer.Option("--excitation", help="tied (as in the paper) or kinematic.")] = "tied",
    ring: Annotated[str, typer.Option("--ring", help="rigid or flexible.")] = "rigid",
    count: Annotated[int, typer.Option("--count", help="Exponents, the largest first; 0: all of them.")] = 1,
    transient: Annotated[int, typer.Option("--transient", help="Mesh periods of stage II left out.")] = 200,
    record: Annotated[
        int, typer.Option("--record", help="Mesh periods of stage II that count, a fifth settles.")
    ] = 1000,
    workers: Annotated[int | None, typer.Option("--workers", help="Processes (default: cores).")] = None,
    dask: Annotated[str, typer.Option("--dask", help="Scheduler of an existing Dask cluster.")] = "",
    as_json: JsonOption = False,
) -> None:
    """Find how fast neighbouring motions part: the largest Lyapunov exponents by the variational equations."""
    from nw_gear_sim import config as configurations  # noqa: PLC0415 - numba and scipy only where they are needed
    from nw_gear_sim.studies import lyapunov as study  # noqa: PLC0415

    axes = [named.axis("--over", over)] if over else []
    for place, value, known in (
        ("--excitation", excitation, ("tied", "kinematic")),
        ("--ring", ring, ("rigid", "flexible")),
    ):
        if value not in known:
            raise InputError(place, " or ".join(known), value)
    plan = study.Plan(excitation=excitation, ring=ring, count=count, transient=transient, record=record)
    base = configurations.load(config)
    with tempfile.TemporaryDirectory() as unnamed:
        folder = output or Path(unnamed)
        found = _compute(base, axes, plan, folder, workers, dask)
        files = _write(folder, found, [name for name, _ in axes]) if output else []
    keys = [name for name, _ in axes]
    if as_json:
        print(json.dumps({"axes": keys, "rows": [row.as_object(keys) for row in found], "files": files}))
    else:
        _print(found, keys, files)


def _compute(
    base: Configuration,
    axes: list[tuple[str, Array]],
    plan: Plan,
    folder: Path,
    workers: int | None,
    dask: str,
) -> list[Row]:
    from nw_gear_sim.studies import lyapunov as study  # noqa: PLC0415 - see lyapunov
    from nw_gear_sim.studies.bifurcation import grid  # noqa: PLC0415
    from nw_gear_sim.studies.runner import run  # noqa: PLC0415
    from nw_gear_sim.studies.store import Store  # noqa: PLC0415

    points = grid(base, axes)
    store = Store(folder, study.describe(base, axes, plan))
    teller = Teller(len(points))
    run(study.pieces(points, plan), study.compute, store, workers=workers, dask=dask, say=teller.progress)
    teller.cost()
    for key in store.damaged:
        print(f"nw_gear: piece {key} was damaged, put aside and computed again", file=sys.stderr)
    return study.rows(store, [(value,) for _, values in axes for value in values.tolist()] or [()])


def _write(folder: Path, found: list[Row], keys: list[str]) -> list[str]:
    from nw_gear_common import tidy  # noqa: PLC0415 - see lyapunov
    from nw_gear_sim.drawings.lyapunov_page import page  # noqa: PLC0415
    from nw_gear_sim.studies.lyapunov import convergence_table, exponents_table  # noqa: PLC0415

    about = {"study": "lyapunov", "over": ", ".join(keys)}
    exponents, means = folder / "exponents.parquet", folder / "convergence.parquet"
    drawing = folder / "exponents.html"
    tidy.write(exponents, exponents_table(found, keys), about)
    tidy.write(means, convergence_table(found, keys), about)
    try:
        drawing.write_text(page(found, keys), encoding="utf-8")
    except OSError as error:
        raise InputError(f"-o {folder}", "room for the results", error.strerror or str(error)) from None
    return [str(path) for path in (exponents, means, drawing)]


def _print(found: list[Row], keys: list[str], files: list[str]) -> None:
    from nw_gear_sim.commands.tables import show  # noqa: PLC0415 - see lyapunov

    if keys:
        lines = [
            [f"{row.values[0]:.6g}", row.motion, _measured(row, 0), f"{row.rate[0] * row.period:.3g}", _fractal(row)]
            for row in found
        ]
        columns = [keys[0], "motion", "largest (1/s)", "per mesh period of II", "dimension"]
        show("Lyapunov exponents", columns, lines)
    else:
        (row,) = found
        lines = [[str(k + 1), _measured(row, k), f"{row.rate[k] * row.period:.3g}"] for k in range(len(row.rate))]
        columns = ["exponent", "1/s", "per mesh period of II"]
        show(f"Lyapunov exponents: {row.motion}", columns, lines[:SHOWN])
        print(f"Kaplan-Yorke dimension {_fractal(row)}")
        if row.complete:
            print(f"sum {row.rate.sum():.2f} 1/s, divergence {row.divergence:.2f} 1/s")
    for file in files:
        print(file)


def _measured(row: Row, k: int) -> str:
    return f"{row.rate[k]:.2f} +- {row.error[k]:.2f}"


def _fractal(row: Row) -> str:
    known = row.dimension == row.dimension
    return f"{row.dimension:.2f}" if known else "needs more exponents"
