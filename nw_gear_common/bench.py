"""`nw_gear bench`: how fast this machine simulates and watches the gearbox, and how exactly.

Each package contributes its own measurements through the entry point group `nw_gear.benchmarks` (name -> function, see
`benchmarking.Benchmark`), so that this shared package knows neither of them.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from nw_gear_common.benchmarking import Part
    from nw_gear_common.machine import Machine

GROUP = "nw_gear.benchmarks"
WIDE = 240
"""Columns of the table where nobody looks at it."""
MARK = {True: "met", False: "missed", None: ""}


def bench(
    config: Annotated[str | None, typer.Option(help="Configuration or preset laid over the default one.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
    quick: Annotated[bool, typer.Option("--quick", help="Everything once and shortly; the figures are rough.")] = False,
) -> None:
    """Measure speed and accuracy of the simulator and the indicators on this machine (two to five minutes)."""
    from nw_gear_common.machine import describe  # noqa: PLC0415 - commands are light to import

    machine = describe()
    points = sorted(entry_points(group=GROUP), key=lambda point: point.name)
    parts: list[Part] = [point.load()(config, quick=quick, say=_say) for point in points]
    if as_json:
        values: dict[str, Any] = {"machine": machine.as_values(), "quick": quick, "config": config or "default"}
        for part in parts:
            _merge(values, part.values)
        typer.echo(json.dumps(values, allow_nan=False))
    else:
        _print(machine, parts)


def _merge(values: dict[str, Any], more: Mapping[str, Any]) -> None:
    """Put values of a part to the others; tables that several parts have a share in are joined."""
    for key, value in more.items():
        if isinstance(value, Mapping) and isinstance(values.get(key), Mapping):
            value = {**values[key], **value}  # noqa: PLW2901 - the same value, joined
        values[key] = value


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _print(machine: Machine, parts: list[Part]) -> None:
    from rich.box import SIMPLE  # noqa: PLC0415 - nor is it needed for --json
    from rich.console import Console  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415

    console = Console(width=None if sys.stdout.isatty() else WIDE, highlight=False, markup=False)
    console.print(str(machine))
    for part in parts:
        console.print(f"\n{part.title}")
        table = Table(box=SIMPLE if console.is_terminal else None, pad_edge=False)
        for heading in ("what", "measured", "goal", ""):
            table.add_column(
                heading, overflow="fold" if console.is_terminal else "ignore", no_wrap=not console.is_terminal
            )
        for figure in part.figures:
            table.add_row(figure.name, figure.value, figure.goal, MARK[figure.met])
        console.print(table)
        for condition in part.conditions:
            console.print(f"- {condition}")
