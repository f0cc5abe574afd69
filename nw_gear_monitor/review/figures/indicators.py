"""Indicators over time: one small figure per indicator, one line per mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from bokeh.models import ColumnDataSource, Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_monitor.indicators import registry
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.rundata import RunData

DASHES = {"1": "solid", "2": "dashed", "3": "dotted"}


SCALES = {"m": ("µm", 1e6), "m/s": ("mm/s", 1e3), "N": ("kN", 1e-3)}
"""Units of indicators as they are shown, with the factor."""
FIRST = ("rms", "peak_to_peak", "crest_factor", "kurtosis", "residual_ratio", "tonal_share", "zero_one_k")


@dataclass(frozen=True)
class Wording:
    """How an indicator is shown.

    Attributes:
        title: name.
        axis: name with unit.
        unit: as shown.
        scale: factor from SI.
    """

    title: str
    axis: str
    unit: str = ""
    scale: float = 1.0


def wording(column: str) -> Wording:
    """Title, axis and unit of an indicator by its column's name; one that this version doesn't know keeps its name."""
    known = next((c for c in registry.COLUMNS if c.name == column), None)
    name = column.replace("_", " ").capitalize().replace("Rms", "RMS")
    if known is None:
        return Wording(name, f"{name} (unit unknown)")
    unit, scale = SCALES.get(known.unit, (known.unit, 1.0))
    return Wording(name, f"{name} ({unit or '-'})", unit, scale)


def columns(run: RunData) -> list[str]:
    """Names of the indicators in the recording that have a finite value somewhere, the most telling ones first."""
    found: dict[str, None] = {}
    for table in run.indicators.values():
        for column in table.columns:
            if column != "time" and np.isfinite(table.column(column)).any():
                found[column] = None
    return sorted(found, key=lambda c: FIRST.index(c) if c in FIRST else len(FIRST))


def source(run: RunData, mesh: str) -> ColumnDataSource:
    """All indicators of a mesh over time, shared by the figures."""
    table = run.indicators[mesh]
    data = {"t": style.small(table.column("time") - run.start)}
    for column in table.columns:
        if column != "time":
            data[column] = style.small(wording(column).scale * table.column(column))
    return ColumnDataSource(data)


def history(run: RunData, column: str, sources: dict[str, ColumnDataSource], time_range: Range1d) -> figure:
    """One indicator over time, a line per mesh: colours are stages, dashes are planets."""
    words = wording(column)
    fig = style.time_figure(words.title, words.axis, time_range, height=230)
    items, lines = [], []
    for mesh, data in sources.items():
        if column not in data.data:
            continue
        line = fig.line(
            "t",
            column,
            source=data,
            line_color=style.STAGE_COLOURS[names.STAGE_OF_MESH[mesh]],
            line_dash=DASHES.get(mesh[-1] if "_" in mesh else "1"),
            line_width=1.4,
        )
        items.append((mesh, [line]))
        lines.append((mesh, line))
    style.add_legend(fig, items)
    for mesh, line in lines:
        tips = [("mesh", mesh), ("time", "@t{0.0} s"), ("value", f"@{{{column}}}{{0.[0000]}} {words.unit}")]
        style.hover(fig, [line], tips)
    return fig
