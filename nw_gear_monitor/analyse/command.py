"""`nw_gear analyse`: indicators and state of a signal in anybody's file."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nw_gear_common.errors import InputError

if TYPE_CHECKING:
    from nw_gear_monitor.analyse.measure import Result

PAGES = (".html", ".htm")


def analyse(
    file: Annotated[Path, typer.Argument(help="CSV with a header, NPY, WAV or MAT.", show_default=False)],
    rate: Annotated[
        float | None, typer.Option(metavar="HZ", help="Samples per second, where the file has none.")
    ] = None,
    strobe: Annotated[
        float | None, typer.Option(metavar="HZ", help="Frequency that the motion is driven with.")
    ] = None,
    phase: Annotated[
        str | None, typer.Option(metavar="COLUMN", help="Unwrapped phase of the drive (rad); one strobe every 2 pi.")
    ] = None,
    column: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="A channel; may be repeated (all, if left out).")
    ] = None,
    velocity: Annotated[str | None, typer.Option(metavar="NAME", help="Column of the channel's derivative.")] = None,
    envelope: Annotated[
        str | None, typer.Option(metavar="LOW:HIGH", help="Band (Hz) whose envelope is looked at.")
    ] = None,
    shaft_rate: Annotated[float | None, typer.Option(metavar="HZ", help="Turns of the shaft per second.")] = None,
    bearing_orders: Annotated[
        str | None, typer.Option(metavar="A,B,..", help="Orders of a bearing, in turns of the shaft.")
    ] = None,
    as_map: Annotated[bool, typer.Option("--map", help="Each row is one step of a map.")] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="Draw a page (.html), or write .json.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Compute state and indicators of a signal in a file, with the code that the monitor watches a gearbox with."""
    from nw_gear_monitor.analyse import measure, options, select  # noqa: PLC0415 - numba and scipy are heavy
    from nw_gear_monitor.datafiles import read  # noqa: PLC0415

    wanted = options.Options(
        rate=rate,
        strobe=strobe,
        phase=phase,
        columns=tuple(column or ()),
        velocity=velocity,
        envelope=options.band(envelope),
        shaft_rate=shaft_rate,
        bearing_orders=options.numbers(bearing_orders),
        map=as_map,
    )
    _check_output(output)
    source = read.read(file)
    for name, reason in source.left_out.items():
        print(f"{name}: left out, {reason}", file=sys.stderr)
    results = []
    for signal in select.signals(source, wanted):
        print(signal.name, file=sys.stderr, flush=True)
        results.append(measure.measure(signal, wanted))
    found = _as_object(results)
    if output is not None:
        _write(output, file, results, found)
    if as_json:
        typer.echo(json.dumps(found, allow_nan=False))
    else:
        from nw_gear_monitor.analyse import table  # noqa: PLC0415 - Rich isn't needed for --json

        table.show(results)


def _as_object(results: Sequence[Result]) -> dict[str, Any]:
    """The JSON object; what is known of a single channel's envelope stands at the top as well."""
    from nw_gear_monitor.analyse.measure import as_object  # noqa: PLC0415

    channels = {result.signal.name: as_object(result) for result in results}
    first = results[0].signal
    found: dict[str, Any] = {"rate_hz": first.rate, "samples": int(first.x.size), "channels": channels}
    if len(channels) == 1 and results[0].envelope is not None:
        found["envelope_peaks_hz"] = channels[first.name]["envelope_peaks_hz"]
    return found


def _check_output(output: Path | None) -> None:
    """Refuse a file that can't be written before any work is done."""
    if output is None:
        return
    if output.suffix.lower() not in (*PAGES, ".json"):
        raise InputError(f"-o {output}", "a file named *.html or *.json", "another")
    from nw_gear_monitor.review.output import check_output  # noqa: PLC0415

    check_output(output)


def _write(output: Path, file: Path, results: Sequence[Result], found: dict[str, Any]) -> None:
    from nw_gear_monitor.review.output import write  # noqa: PLC0415

    if output.suffix.lower() == ".json":
        write(output, json.dumps(found, allow_nan=False, indent=1) + "\n")
        return
    from nw_gear_monitor.analyse.page import render  # noqa: PLC0415 - bokeh is heavy

    write(output, render(file.name, results))
