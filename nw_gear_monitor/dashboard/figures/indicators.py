"""Indicators over time: figures whose indicator is chosen on the page, one line per mesh or bearing."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from bokeh.models import ColumnDataSource, DataRange1d, Model, Select
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.dashboard.feed import INDICATOR_ROWS, Feed
from nw_gear_monitor.indicators import bearing_registry, registry
from nw_gear_monitor.indicators.window import Column
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.figures.indicators import DASHES, wording

MESH_FIRST = ("rms", "residual_ratio", "tonal_share", "kurtosis")
BEARING_FIRST = ("rms", "kurtosis")


class Rows:
    """The chosen indicators of one place as a data source; a browser gets no others.

    Args:
        columns: that the registry of this version knows.
        chosen: names of those that are drawn.
    """

    def __init__(self, columns: tuple[Column, ...], chosen: tuple[str, ...]) -> None:
        self._columns = chosen
        self._scales = {column.name: wording(column.name, columns).scale for column in columns}
        self.source = ColumnDataSource({name: np.empty(0, np.float32) for name in ("t", *chosen)})
        self._seen, self._epoch = 0, -1

    def choose(self, chosen: tuple[str, ...], feed: Feed | None, place: str) -> None:
        """Draw others from now on, with all that is known of them."""
        self._columns, self._epoch = chosen, -1
        if feed is None:
            self.source.data = {name: np.empty(0, np.float32) for name in ("t", *chosen)}
        else:
            self.update(feed, place)

    def update(self, feed: Feed, place: str) -> None:
        """Send the rows that are new."""
        with feed.lock:
            known = feed.indicators.get(place)
            epoch, origin = feed.epoch, feed.origin
            count = 0 if known is None else known[1].count
            fresh = epoch != self._epoch or count < self._seen
            rows = None if known is None else known[1].since(0 if fresh else self._seen)
        self._epoch, self._seen = epoch, count
        if fresh:
            self.source.data = self._shown((), np.empty((0, 0)), origin)
        if known is not None and rows is not None and len(rows):
            self.source.stream(self._shown(known[0], rows, origin), rollover=INDICATOR_ROWS)

    def _shown(self, columns: tuple[str, ...], rows: Array, origin: float) -> dict[str, npt.NDArray[Any]]:
        data: dict[str, npt.NDArray[Any]] = {
            "t": rows[:, columns.index("time")] - origin if "time" in columns else np.empty(len(rows))
        }
        for name in self._columns:
            given = rows[:, columns.index(name)] if name in columns else np.full(len(rows), np.nan)
            data[name] = style.small(self._scales[name] * given)
        return data


class Chosen:
    """A figure of one indicator, with the choice of it above."""

    def __init__(
        self,
        name: str,
        columns: tuple[Column, ...],
        lines: dict[str, tuple[Rows, str, str]],
        shared: DataRange1d,
        changed: Callable[[], None],
    ) -> None:
        self._changed = changed
        self._columns, self._what = columns, "Bearings" if columns is bearing_registry.COLUMNS else "Meshes"
        options = [(column.name, wording(column.name, columns).title) for column in columns]
        self.select = Select(title=f"{self._what}: indicator", value=name, options=options, width=230)
        self.figure: figure = style.time_figure("", "", shared, height=230)
        self._lines = {
            place: self.figure.line("t", name, source=rows.source, line_color=colour, line_dash=dash, line_width=1.4)
            for place, (rows, colour, dash) in lines.items()
        }
        style.add_legend(self.figure, [(place, [line]) for place, line in self._lines.items()])
        self._rows = {place: rows for place, (rows, _colour, _dash) in lines.items()}
        self._label(name)
        self.select.on_change("value", self._choose)

    def _choose(self, _attribute: str, _old: str, new: str) -> None:
        self._changed()  # the data first, then the lines that need them
        for line in self._lines.values():
            line.glyph.y = new
        self._label(new)

    def _label(self, name: str) -> None:
        words = wording(name, self._columns)
        self.figure.yaxis.axis_label = words.axis
        self.look()

    def look(self) -> None:
        """Say so where the indicator has no value anywhere: its window isn't full, or the state has none."""
        name = self.select.value
        known = any(np.isfinite(rows.source.data[name]).any() for rows in self._rows.values())
        title = f"{self._what}: {wording(name, self._columns).title}" + ("" if known else " (no value yet)")
        if self.figure.title.text != title:
            self.figure.title.text = title


class IndicatorsPanel:
    """Six figures: four of the meshes, two of the bearings."""

    def __init__(self) -> None:
        shared = DataRange1d(range_padding=0.02, default_span=60.0)
        self._feed: Feed | None = None
        self._rows = {mesh: Rows(registry.COLUMNS, MESH_FIRST) for mesh in names.MESHES}
        self._rows |= {bearing: Rows(bearing_registry.COLUMNS, BEARING_FIRST) for bearing in names.WAVEFORM_BEARINGS}
        meshes = {
            m: (self._rows[m], style.STAGE_COLOURS[names.STAGE_OF_MESH[m]], DASHES.get(m[-1], "solid"))
            for m in names.MESHES
        }
        bearings = {
            b: (self._rows[b], colour, "solid")
            for b, colour in zip(names.WAVEFORM_BEARINGS, style.PALETTE, strict=False)
        }
        figures = [Chosen(name, registry.COLUMNS, meshes, shared, self._chosen) for name in MESH_FIRST]
        figures += [Chosen(name, bearing_registry.COLUMNS, bearings, shared, self._chosen) for name in BEARING_FIRST]
        self._figures = figures
        self.roots: dict[str, Model] = {}
        for i, chosen in enumerate(figures, start=1):
            self.roots |= {f"indicator_{i}": chosen.figure, f"choice_{i}": chosen.select}

    def _chosen(self) -> None:
        names_of = [figure.select.value for figure in self._figures]
        wanted = {True: tuple(names_of[: len(MESH_FIRST)]), False: tuple(names_of[len(MESH_FIRST) :])}
        for place, rows in self._rows.items():
            rows.choose(wanted[place in names.MESHES], self._feed, place)

    def update(self, feed: Feed) -> None:
        """Send what is new."""
        self._feed = feed
        for place, rows in self._rows.items():
            rows.update(feed, place)
        for chosen in self._figures:
            chosen.look()
