"""How every figure looks: colours that colour-blind readers can tell apart, fonts, axes, legends outside the data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from bokeh.core.enums import SizingModeType
from bokeh.models import ColumnDataSource, HoverTool, Legend, LegendItem, Range1d, Span
from bokeh.models.renderers import GlyphRenderer
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.review.decimate import Band

# Okabe and Ito, "Color Universal Design" (2008).
BLUE, VERMILION, GREEN, PINK, ORANGE, SKY, YELLOW, BLACK = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#E69F00",
    "#56B4E9",
    "#F0E442",
    "#222222",
)
GREY = "#8A8F98"
PALETTE = (BLUE, VERMILION, GREEN, PINK, ORANGE, SKY, BLACK, "#7B3294", "#8C510A", GREY)
PLANET_COLOURS = {1: BLUE, 2: VERMILION, 3: GREEN}
MESH_COLOURS = {m: PLANET_COLOURS[int(m[-1])] if m[-1] in "123" else BLUE for m in names.MESHES}
STAGE_COLOURS = dict(zip(names.STAGES, (BLUE, VERMILION, GREEN), strict=True))
STATE_COLOURS = {
    "period-1": "#A8D8C2",
    "period-n": SKY,
    names.QUASI_PERIODIC: YELLOW,
    names.CHAOTIC: VERMILION,
    names.TRANSIENT: "#D9CBE3",
    names.STALE: "#6B7078",
    names.UNKNOWN: "#E3E5E8",
}
TOOLS = "pan,wheel_zoom,box_zoom,reset,save"
TIME_TOOLS = "xpan,xwheel_zoom,box_zoom,reset,save"
INK = "#2B2F36"


def mesh_label(mesh: str) -> str:
    """Words for a mesh: `I_2` is planet 2 of stage I."""
    stage, _, planet = mesh.partition("_")
    return f"planet {planet}" if planet else f"stage {stage}"


def state_colour(state: str) -> str:
    """Colour of a state label."""
    if state in STATE_COLOURS:
        return STATE_COLOURS[state]
    return STATE_COLOURS["period-n"] if state in names.PERIODS else STATE_COLOURS[names.UNKNOWN]


def make_figure(
    title: str,
    x_label: str,
    y_label: str,
    *,
    height: int = 240,
    x_range: Range1d | None = None,
    y_type: str = "auto",
    tools: str = TOOLS,
    sizing: SizingModeType = "stretch_width",
    **options: Any,
) -> figure:
    """An empty figure in the style of the report."""
    if x_range is not None:
        options["x_range"] = x_range
    fig = figure(
        title=title, height=height, sizing_mode=sizing, tools=tools, y_axis_type=y_type, min_width=320, **options
    )
    fig.toolbar.logo = None
    fig.toolbar.autohide = True
    fig.xaxis.axis_label, fig.yaxis.axis_label = x_label, y_label
    fig.title.text_font_size, fig.title.text_color = "13px", INK
    fig.outline_line_color = "#C9CDD3"
    fig.grid.grid_line_color = "#E8EAED"
    fig.min_border_left, fig.min_border_right = 72, 12
    for axis in fig.axis:
        axis.axis_label_text_font_style, axis.axis_label_text_font_size = "normal", "12px"
        axis.major_label_text_font_size = "11px"
        axis.axis_line_color = axis.major_tick_line_color = "#9AA0A8"
        axis.minor_tick_line_color = None
        axis.axis_label_text_color = axis.major_label_text_color = INK
    return fig


def time_figure(title: str, y_label: str, time_range: Range1d, **options: Any) -> figure:
    """A figure over the run's time, linked to all others of its kind."""
    return make_figure(title, "Time since start (s)", y_label, x_range=time_range, tools=TIME_TOOLS, **options)


def add_legend(fig: figure, items: Sequence[tuple[str, Sequence[GlyphRenderer]]], columns: int = 10) -> None:
    """A legend above the data; a click on an entry hides or shows it."""
    legend = Legend(
        items=[LegendItem(label=text, renderers=list(renderers)) for text, renderers in items],
        orientation="horizontal",
        location="top_left",
        ncols=min(columns, max(1, len(items))),
        click_policy="hide",
        border_line_color=None,
        background_fill_alpha=0.0,
        label_text_font_size="11px",
        label_text_color=INK,
        padding=0,
        margin=2,
        spacing=10,
        glyph_width=16,
        glyph_height=12,
        label_height=12,
        label_standoff=4,
    )
    fig.add_layout(legend, "above")


def small(values: Array) -> npt.NDArray[np.float32]:
    """Single precision: half the size on the page, far finer than a screen."""
    return np.ascontiguousarray(values, dtype=np.float32)


def band_source(band: Band, start: float, scale: float, longest_gap: float, *, mean: bool = True) -> ColumnDataSource:
    """Data of a band, broken at gaps (s): `t`, and `low_<c>`, `high_<c>`, `mean_<c>` of each channel times `scale`."""
    broken = band.with_breaks(longest_gap)
    data: dict[str, npt.NDArray[np.float32]] = {"t": small(broken.time - start)}
    for i, channel in enumerate(band.channels):
        data[f"low_{channel}"] = small(broken.low[:, i] * scale)
        data[f"high_{channel}"] = small(broken.high[:, i] * scale)
        if mean:
            data[f"mean_{channel}"] = small(broken.mean[:, i] * scale)
    return ColumnDataSource(data)


def draw_band(
    fig: figure, source: ColumnDataSource, channel: str, colour: str, *, mean: bool = False
) -> list[GlyphRenderer]:
    """Draw one channel of a band: an area from its minimum to its maximum, with the mean as a line where wanted."""
    area = fig.varea("t", f"low_{channel}", f"high_{channel}", source=source, fill_color=colour, fill_alpha=0.25)
    edges = [
        fig.line("t", f"{edge}_{channel}", source=source, line_color=colour, line_width=0.7, line_alpha=0.8)
        for edge in (("mean",) if mean else ("low", "high"))
    ]
    if mean:
        edges[0].glyph.line_width = 1.5
        edges[0].glyph.line_alpha = 1.0
    return [area, *edges]


def mark(fig: figure, at: float, *, vertical: bool = True, colour: str = GREY, dash: str = "dashed") -> None:
    """A thin line across the figure."""
    fig.add_layout(
        Span(location=at, dimension="height" if vertical else "width", line_color=colour, line_dash=dash, line_width=1)
    )


def hover(
    fig: figure, renderers: Sequence[GlyphRenderer], tooltips: Sequence[tuple[str, str]], mode: str = "mouse"
) -> None:
    """Show values under the pointer."""
    fig.add_tools(HoverTool(renderers=list(renderers), tooltips=list(tooltips), mode=mode, line_policy="nearest"))


def level(fig: figure, values: npt.NDArray[np.float32]) -> None:
    """Let a line that never changes be seen as one: the axis then spans its value and a tenth to both sides."""
    fig.y_range.default_span = 0.2 * max(abs(float(np.nanmean(values))), 1e-3)


def padded(values: Array, least: float = 1e-3) -> Range1d:
    """A range that holds all values with some room on both sides, `least` where they are all the same."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = max(0.08 * (high - low), least)
    return Range1d(low - room, high + room)
