"""Indicators over time: one small figure per indicator, one line per mesh or bearing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from bokeh.models import ColumnDataSource, Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.indicators import bearing_registry, registry
from nw_gear_monitor.indicators.window import Column
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.rundata import RunData

DASHES = {"1": "solid", "2": "dashed", "3": "dotted"}


SCALES = {"m": ("µm", 1e6), "m/s": ("mm/s", 1e3), "N": ("kN", 1e-3)}
"""Units of indicators as they are shown, with the factor."""
FIRST = ("rms", "peak_to_peak", "crest_factor", "kurtosis", "residual_ratio", "tonal_share", "zero_one_k")
NOT_DRAWN = frozenset(
    {
        *(f"sideband_ratio_{gear}_{k}" for gear in ("driver", "driven") for k in (2, 3)),
        *("sideband_driver", "sideband_driven", "dispersion_entropy", "recurrence_rate", "laminarity"),
        *("diagonal_entropy", "correlation_dimension", "crest_factor", "peak_to_peak", "ftf", "ftf_prominence"),
        *("bsf", "bsf_prominence", "spectral_kurtosis_low", "spectral_kurtosis_high"),
    }
)
"""Columns that the report leaves to the recording: their neighbours say nearly the same."""
MESH_ONLY = frozenset({"crest_factor", "peak_to_peak"})
"""Of these, what is drawn for meshes all the same."""


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


def wording(column: str, among: tuple[Column, ...] = registry.COLUMNS) -> Wording:
    """Title, axis and unit of an indicator by its column's name; one that this version doesn't know keeps its name."""
    known = next((c for c in among if c.name == column), None)
    name = column.replace("_", " ").capitalize()
    for plain, usual in (("Rms", "RMS"), ("Fm", "FM"), ("Na4", "NA4"), ("Bpfo", "BPFO"), ("Bpfi", "BPFI")):
        name = name.replace(plain, usual)
    if known is None:
        return Wording(name, f"{name} (unit unknown)")
    unit, scale = SCALES.get(known.unit, (known.unit, 1.0))
    return Wording(name, f"{name} ({unit or '-'})", unit, scale)


def columns(run: RunData) -> list[str]:
    """Indicators of meshes that have a finite value somewhere and are drawn, the most telling ones first."""
    return _finite(run.indicators, NOT_DRAWN - MESH_ONLY)


def bearing_columns(run: RunData) -> list[str]:
    """The same of bearings."""
    return _finite(run.bearing_indicators, NOT_DRAWN)


def _finite(tables: Mapping[str, Table], left_out: frozenset[str]) -> list[str]:
    found: dict[str, None] = {}
    for table in tables.values():
        for column in table.columns:
            if column != "time" and column not in left_out and np.isfinite(table.column(column)).any():
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


def bearing_history(run: RunData, column: str, time_range: Range1d) -> figure:
    """One indicator over time, a line per bearing."""
    words = wording(column, bearing_registry.COLUMNS)
    fig = style.time_figure(f"Bearings: {words.title}", words.axis, time_range, height=230)
    items = []
    for (bearing, table), colour in zip(run.bearing_indicators.items(), style.PALETTE, strict=False):
        if column in table.columns:
            values = {"t": table.column("time") - run.start, "y": words.scale * table.column(column)}
            data = ColumnDataSource({name: style.small(array) for name, array in values.items()})
            line = fig.line("t", "y", source=data, line_color=colour, line_width=1.4)
            items.append((bearing, [line]))
            tips = [("bearing", bearing), ("time", "@t{0.0} s"), ("value", f"@y{{0.[0000]}} {words.unit}")]
            style.hover(fig, [line], tips)
    style.add_legend(fig, items)
    return fig
