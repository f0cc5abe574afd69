"""The Campbell diagram as a page: natural frequencies and excitations over the ring's speed, crossings, margins."""

from __future__ import annotations

import math

import numpy as np
from bokeh.models import (
    BoxAnnotation,
    ColumnDataSource,
    DataTable,
    HoverTool,
    Label,
    Legend,
    LegendItem,
    NumberFormatter,
    Range1d,
    Span,
    TableColumn,
)
from bokeh.models.renderers import GlyphRenderer
from bokeh.plotting import figure

from nw_gear_sim.campbell import ALIKE, Campbell, Crossing
from nw_gear_sim.drawings.page import BLACK, GREY, ORANGE, PINK, SKY, STAGE_COLOURS, render
from nw_gear_sim.excitations import Order
from nw_gear_sim.participation import KINDS

KIND_COLOURS = dict(zip(KINDS, (BLACK, PINK, ORANGE, SKY, "#7B3294"), strict=True))
DASHES = {1: "solid", 2: "dashed", 3: "dotted"}
GROUPS = {
    "shaft": "shafts",
    "planet passing": "planets pass the ring",
    "rollers": "rollers pass",
    "segments": "segments pass (numerical)",
}
OTHER_COLOURS = {"shaft": GREY, "planet passing": GREY, "rollers": "#8C510A", "segments": "#B0B0B0"}
RPM = 60 / (2 * math.pi)
HIGH_SHARE = 0.05
"""Share of strain energy in the exciting meshes from which a crossing is drawn as a strong one."""


def campbell_page(diagram: Campbell, conditions: str) -> str:
    """Draw the diagram; `conditions` says at which load and angle it holds."""
    intro = (
        conditions,
        "Natural frequencies (thin lines with dots, coloured by the kind of mode at rated speed) are found anew at the "
        "equilibrium of each speed. A gap in a line means that the shape changed so much between two speeds that it "
        "may be another mode. Circles are crossings with mesh orders; filled ones have at least "
        f"{HIGH_SHARE:.0%} of the mode's strain energy in the meshes that excite it. Click on an entry of the legend "
        "to hide it; draw a box to zoom. Shaded: above rated speed.",
    )
    near = (
        f"Natural frequencies within {diagram.separation:.0%} of an excitation at rated speed. How much a mesh order "
        "can do is judged by the share of strain energy in its meshes. The segments' passing comes from the division "
        "of the ring and isn't there in a real one."
    )
    parts = [
        ("", "", _figure(diagram)),
        ("Margins at rated speed", near, _margins(diagram)),
        ("Crossings", "All crossings with mesh orders; click on a heading to sort.", _crossings(diagram)),
    ]
    return render("Campbell diagram", intro, parts)


def _figure(diagram: Campbell) -> figure:
    top = 1.06 * float(np.max(diagram.frequencies_hz))
    right = float(diagram.speed[-1]) * RPM
    plot = figure(
        width=1320, height=780, x_range=Range1d(0, right * 1.02), y_range=Range1d(0, top),
        x_axis_label="Speed of the ring (r/min)", y_axis_label="Frequency (Hz)",
        tools="pan,box_zoom,wheel_zoom,reset,save", active_drag="box_zoom", active_scroll=None,
    )  # fmt: skip
    plot.toolbar.logo = None
    rated = diagram.rated * RPM
    plot.add_layout(Span(location=rated, dimension="height", line_color=BLACK, line_width=1, line_dash="dotdash"))
    plot.add_layout(BoxAnnotation(left=rated, fill_color=GREY, fill_alpha=0.08))
    plot.add_layout(Label(x=rated, y=top, text=" rated", y_offset=-18, text_font_size="12px", text_color=BLACK))
    items = [*_draw_orders(plot, diagram, top, right), *_draw_modes(plot, diagram), *_draw_crossings(plot, diagram)]
    legend = Legend(items=items, click_policy="hide", label_text_font_size="12px", spacing=1, border_line_alpha=0)
    plot.add_layout(legend, "right")
    return plot


def _draw_orders(plot: figure, diagram: Campbell, top: float, right: float) -> list[LegendItem]:
    groups: dict[str, list[GlyphRenderer]] = {}
    for order in diagram.orders:
        slope = order.ratio / 60
        end = min(right, top / slope)
        x = np.linspace(0, end, 50)
        data = {"x": x, "y": slope * x, "name": [order.name] * len(x)}
        mesh = order.kind == "mesh"
        colour = STAGE_COLOURS[order.stage] if mesh else OTHER_COLOURS[order.kind]
        dash = DASHES[order.harmonic] if mesh else "dashed"
        width = 2 if mesh else 1
        line = plot.line("x", "y", source=ColumnDataSource(data), color=colour, line_width=width, line_dash=dash)
        groups.setdefault(GROUPS.get(order.kind, f"mesh {order.stage}, 1st to 3rd"), []).append(line)
        if mesh:
            _label(plot, order, end, slope * end, right)
    lines = [line for group in groups.values() for line in group]
    tips = [("excitation", "@name"), ("frequency", "@y{0.00} Hz"), ("ring", "@x{0.00} r/min")]
    plot.add_tools(HoverTool(renderers=lines, tooltips=tips, line_policy="interp"))
    return [LegendItem(label=name, renderers=group) for name, group in groups.items()]


def _label(plot: figure, order: Order, x: float, y: float, right: float) -> None:
    at_side = x >= right
    label = Label(
        x=x,
        y=y,
        text=order.name.removeprefix("mesh ").replace(", ", " "),
        text_color=STAGE_COLOURS[order.stage],
        text_font_size="11px",
        text_align="right" if at_side else "center",
        text_baseline="bottom",
        y_offset=2 if at_side else -14,
        background_fill_color="white",
        background_fill_alpha=0.75,
    )
    plot.add_layout(label)


def _draw_modes(plot: figure, diagram: Campbell) -> list[LegendItem]:
    groups: dict[str, list[GlyphRenderer]] = {}
    speed = diagram.speed * RPM
    for m, mode in enumerate(diagram.modes):
        colour = KIND_COLOURS[mode.kind]
        y = diagram.frequencies_hz[:, m]
        sure = diagram.alike[:, m] >= ALIKE
        line = plot.segment(
            speed[:-1][sure], y[:-1][sure], speed[1:][sure], y[1:][sure], line_color=colour, line_width=1.2
        )
        source = ColumnDataSource(
            {
                "x": speed,
                "y": y,
                "damping": 100 * diagram.damping_ratio[:, m],
                "torque": diagram.torque / 1e6,
                "mode": [f"{m + 1}: {mode.name}"] * len(speed),
            }
        )
        dots = plot.scatter("x", "y", source=source, size=3.5, color=colour)
        groups.setdefault(mode.kind, []).extend([line, dots])
    dots = [r for lines in groups.values() for r in lines[1::2]]
    tips = [
        ("mode", "@mode"), ("frequency", "@y{0.00} Hz"), ("damping ratio", "@damping{0.00} %"),
        ("ring", "@x{0.00} r/min, @torque{0.00} MN m"),
    ]  # fmt: skip
    plot.add_tools(HoverTool(renderers=dots, tooltips=tips))
    return [LegendItem(label=f"modes: {kind}", renderers=groups[kind]) for kind in KINDS if kind in groups]


def _draw_crossings(plot: figure, diagram: Campbell) -> list[LegendItem]:
    items = []
    kinds = (
        (f"crossings, share from {HIGH_SHARE:.0%}", True, {"size": 11, "fill_color": "#FFD400", "line_color": BLACK}),
        ("other crossings", False, {"size": 7, "fill_color": None, "line_color": GREY}),
    )
    for name, strong, look in kinds:
        chosen = [c for c in diagram.crossings if math.isfinite(c.share) and (c.share >= HIGH_SHARE) == strong]
        if chosen:
            spots = plot.scatter("speed", "frequency", source=_crossing_source(diagram, chosen), **look)
            tips = [("crossing", "@order with mode @mode"), ("at", "@speed{0.00} r/min, @frequency{0.0} Hz"),
                    ("mode", "@name"), ("strain energy in these meshes", "@share{0.0 %}")]  # fmt: skip
            plot.add_tools(HoverTool(renderers=[spots], tooltips=tips))
            items.append(LegendItem(label=name, renderers=[spots]))
    return items


def _crossing_source(diagram: Campbell, chosen: list[Crossing]) -> ColumnDataSource:
    return ColumnDataSource(
        {
            "speed": [c.speed * RPM for c in chosen],
            "relative": [c.speed / diagram.rated for c in chosen],
            "frequency": [c.frequency_hz for c in chosen],
            "order": [c.order for c in chosen],
            "mode": [c.mode for c in chosen],
            "name": [diagram.modes[c.mode - 1].name for c in chosen],
            "share": [c.share for c in chosen],
            "sure": ["yes" if c.certain else "doubtful" for c in chosen],
        }
    )


def _crossings(diagram: Campbell) -> DataTable:
    chosen = sorted((c for c in diagram.crossings if math.isfinite(c.share)), key=lambda c: -c.share)
    source = _crossing_source(diagram, chosen)
    columns = [
        _column("order", "Excitation", 120), _number("speed", "Ring (r/min)", "0.00"),
        _number("relative", "Speed over rated", "0.000"), _number("frequency", "Frequency (Hz)", "0.0"),
        _number("mode", "Mode", "0"), _column("name", "Mode at rated speed", 320),
        _number("share", "Strain energy in these meshes", "0.0 %"), _column("sure", "Same mode", 90),
    ]  # fmt: skip
    return DataTable(source=source, columns=columns, width=1320, height=420, index_position=None)


def _margins(diagram: Campbell) -> DataTable:
    rows = diagram.margins
    source = ColumnDataSource(
        {
            "order": [r.order for r in rows],
            "excitation": [r.excitation_hz for r in rows],
            "mode": [r.mode for r in rows],
            "frequency": [r.frequency_hz for r in rows],
            "name": [diagram.modes[r.mode - 1].name for r in rows],
            "margin": [r.margin for r in rows],
            "share": [f"{r.share:.1%}" if math.isfinite(r.share) else "-" for r in rows],
        }
    )
    columns = [
        _column("order", "Excitation", 200), _number("excitation", "Excitation (Hz)", "0.0"),
        _number("mode", "Mode", "0"), _column("name", "Name", 320), _number("frequency", "Natural (Hz)", "0.0"),
        _number("margin", "Margin", "+0.0 %"), _column("share", "Strain energy in these meshes", 160),
    ]  # fmt: skip
    height = 60 + 25 * min(len(rows), 16)
    return DataTable(source=source, columns=columns, width=1320, height=height, index_position=None)


def _column(field: str, title: str, width: int) -> TableColumn:
    return TableColumn(field=field, title=title, width=width)


def _number(field: str, title: str, form: str) -> TableColumn:
    return TableColumn(field=field, title=title, width=130, formatter=NumberFormatter(format=form, text_align="right"))
