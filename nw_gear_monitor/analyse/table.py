"""The results as a table: with boxes on a terminal, plain elsewhere."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from nw_gear_monitor.analyse.lines import Line
from nw_gear_monitor.analyse.measure import Result

WIDE = 240
SHOWN_PEAKS = 8
UNITS = {"largest_exponent": ("nats/s", "nats a step"), "permutation_entropy": ("bit", "bit")}


def show(results: Sequence[Result]) -> None:
    """Print the results on standard output."""
    console = Console(width=None if sys.stdout.isatty() else WIDE, highlight=False, markup=False)
    for result in results:
        signal = result.signal
        rate = "steps of a map" if signal.rate is None else f"samples at {signal.rate:.6g} Hz"
        console.print(f"{signal.name}: {signal.x.size} {rate}")
        console.print(f"state: {state_line(result)}")
        console.print(_table(console, ("indicator", "value", ""), indicator_rows(result)))
        for title, lines in _lines(result):
            console.print(title)
            rows = [tuple(cell(v) for v in (line.order, line.hz, line.amplitude, line.prominence)) for line in lines]
            console.print(_table(console, ("order", "Hz", "amplitude", "over the floor"), rows))


def state_line(result: Result) -> str:
    """The state in one line."""
    verdict = result.verdict
    noise = f", noise {verdict.noise_db:.0f} dB below the signal" if math.isfinite(verdict.noise_db) else ""
    return f"{verdict.label} ({100.0 * verdict.confidence:.0f} %){noise}: {verdict.reason}"


def indicator_rows(result: Result) -> list[tuple[str, str, str]]:
    """Name, value with its unit, and note of each indicator."""
    findings = result.findings
    rows: list[tuple[str, str, str]] = []
    for name, value in findings.values.items():
        unit = UNITS.get(name, ("", ""))[result.signal.rate is None]
        rows.append(
            (name, cell(value) + (f" {unit}" if unit and value is not None else ""), findings.notes.get(name, ""))
        )
    return rows


def _lines(result: Result) -> list[tuple[str, Sequence[Line]]]:
    found: list[tuple[str, Sequence[Line]]] = []
    if result.impulsive is not None:
        band = result.impulsive
        found.append((f"most impulsive band: {band.low:.6g} to {band.high:.6g} Hz, kurtosis {band.kurtosis:.3g}", ()))
    if result.envelope is not None:
        low, high = result.envelope.band
        found.append((f"envelope of {low:.6g} to {high:.6g} Hz: strongest lines", result.envelope.peaks[:SHOWN_PEAKS]))
        if result.envelope.bearing:
            found.append(("lines of the bearing", result.envelope.bearing))
    if result.shaft:
        found.append(("lines of the shaft", result.shaft))
    return found


def cell(value: float | None) -> str:
    """A number as it is shown; - where there is none."""
    return "-" if value is None or not math.isfinite(value) else f"{value:.6g}"


def _table(console: Console, head: Sequence[str], rows: Sequence[Sequence[str]]) -> Table | str:
    if not rows:
        return ""
    table = Table(box=SIMPLE if console.is_terminal else None, pad_edge=False)
    for heading in head:
        table.add_column(heading, overflow="fold" if console.is_terminal else "ignore", no_wrap=not console.is_terminal)
    for row in rows:
        table.add_row(*row)
    return table
