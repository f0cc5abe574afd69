"""A page with responses: one chooses a point and sees every mesh; surfaces along the axis where there is a range."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from bokeh.layouts import column, row
from bokeh.models import (
    ColumnDataSource,
    CustomJS,
    Div,
    FactorRange,
    LinearColorMapper,
    Model,
    RadioButtonGroup,
    Range1d,
    Select,
)
from bokeh.palettes import Viridis256
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_sim.drawings.page import BLACK, BLUE, GREEN, GREY, SKY, STAGE_COLOURS, VERMILION, render
from nw_gear_sim.drawings.response_data import DECADES, Collector
from nw_gear_sim.drawings.response_script import CHOSEN
from nw_gear_sim.drawings.response_surfaces import heat_maps, surfaces
from nw_gear_sim.studies.diagram import Row

TOOLS = "pan,box_zoom,wheel_zoom,reset,save"
COLOURS = {"period-1": BLUE, "period-2": SKY, "other periods": GREEN, "chaotic": VERMILION, "unknown": "#D0D3D8",
           "diverged": BLACK}  # fmt: skip


def page(collector: Collector, found: Sequence[Row], key: str, excitation: str) -> str:
    """Return a self-contained page.

    Args:
        collector: has taken all responses; found: states of the same points; key: name of the axis.
    """
    intro = [
        "Meshing displacement x of the meshes after the transient, in units of b (half the backlash of stage II) and "
        f"1 / omega_n, or in SI. All meshes are excited {_WORDS[excitation]}.",
        "Amplitudes come from a Hann window over the whole record. Phase diagrams show the last 40 mesh periods, with "
        "the Poincaré points of the whole record, one per period, in black. Left and right of the dashed lines of a "
        "wavelet map amplitudes are too small.",
    ]
    if not collector.details:
        return render("Responses", intro, [("", "Every point diverged: nothing to show.", Div(text=""))])
    units = RadioButtonGroup(labels=["as in the paper", "SI"], active=0)
    parts: list[tuple[str, str, Model]] = []
    if len(collector.values) > 1:
        parts.append((f"States over {key}", "", _states(found, key)))
    parts.append(("Responses at a point", "", _chosen(collector, found, key, units)))
    if collector.ranged:
        parts.append((f"Along {key}", "", surfaces(collector, key, units)))
        text = "Colours are logarithmic."
        parts.append((f"Spectra over {key}", text, heat_maps(collector, key)))
    return render("Responses over " + key, intro, parts)


_WORDS = {"tied": "at the mesh frequency of stage II", "kinematic": "at the mesh frequency of their own stage"}


def _states(found: Sequence[Row], key: str) -> Model:
    meshes = list(dict.fromkeys(row.mesh for row in found))
    values = sorted({row.values[0] for row in found})
    steps = [b - a for a, b in pairwise(values)]
    plot = figure(
        width=1240, height=90 + 26 * len(meshes), y_range=FactorRange(factors=meshes[::-1]), x_axis_label=key,
        tools="hover,save", tooltips=[(key, "@value"), ("state", "@state"), ("exponent (1/s)", "@rate")],
    )  # fmt: skip
    plot.toolbar.logo = None
    for name, colour in COLOURS.items():
        own = [row for row in found if _kind(row.state) == name]
        if own:
            source = ColumnDataSource({
                "value": [row.values[0] for row in own], "mesh": [row.mesh for row in own],
                "state": [row.state for row in own], "rate": [f"{row.rate:.2f} +- {row.error:.2f}" for row in own],
            })  # fmt: skip
            plot.rect("value", "mesh", min(steps), 0.8, source=source, color=colour, legend_label=name)
    plot.add_layout(plot.legend[0], "right")
    plot.grid.visible = False
    return plot


def _kind(state: str) -> str:
    return state if state in COLOURS else "other periods"


def _chosen(collector: Collector, found: Sequence[Row], key: str, units: RadioButtonGroup) -> Model:
    values = sorted(collector.details)
    facts = {(row.values[0], row.mesh): _facts(row) for row in found}
    data = []
    for value in values:
        meshes = collector.details[value]
        data.append({m: {**d, "facts": facts[value, m] + f"; f_m = {d['fm_hz']:.4g} Hz"} for m, d in meshes.items()})
    options = [(str(k), f"{key} = {value:.6g}") for k, value in enumerate(values)]
    select = Select(title="Point", value="0", options=options, width=320)
    views, blocks = {}, []
    for mesh in collector.meshes:
        views[mesh], block = _mesh(mesh)
        blocks.append(block)
    arguments = {"data": data, "views": views, "select": select, "units": units, "decades": DECADES}
    draw = CustomJS(args=arguments, code=CHOSEN)
    select.js_on_change("value", draw)
    units.js_on_change("active", draw)
    views[collector.meshes[0]]["first"].js_on_change("inner_width", draw)  # the first drawing
    for view in views.values():
        del view["first"]
    return column(row(select, column(Div(text="", height=14), units)), *blocks)


def _facts(row: Row) -> str:
    exponent = "" if row.rate != row.rate else f"; largest exponent {row.rate:.2f} ± {row.error:.2f} 1/s"
    settled = "" if row.settled else "; both halves of the record differ"
    return (
        f"<b>{row.mesh}: {row.state}</b>{exponent}; flanks apart {100 * row.open:.1f} %, on the back flanks "
        f"{100 * row.back:.1f} % of the time{settled}"
    )


def _mesh(mesh: str) -> tuple[dict[str, Any], Model]:
    """Return the figures of one mesh, empty, and what the script fills."""
    colour = STAGE_COLOURS[names.STAGE_OF_MESH[mesh]]
    history, spectrum = ColumnDataSource({"t": [], "x": []}), ColumnDataSource({"f": [], "a": []})
    phase, section = (ColumnDataSource({"x": [], "v": []}) for _ in range(2))
    orders, cone = ColumnDataSource({"f": [], "name": []}), ColumnDataSource({"xs": [], "ys": []})
    image = ColumnDataSource({"image": [], "x": [], "y": [], "dw": [], "dh": []})
    top = [_figure(f"{mesh}: time history", 620), _figure("Amplitude spectrum; dashed: f_m, 1/2 f_m, harmonics", 620)]
    top[0].line("t", "x", source=history, color=colour)
    top[1].vspan("f", source=orders, line_color=GREY, line_dash="dashed", line_width=1)
    top[1].line("f", "a", source=spectrum, color=colour)
    below = [_figure("Phase diagram and Poincaré points", 400), _figure("Poincaré map", 400)]
    below[0].line("x", "v", source=phase, color=colour, line_width=0.7)
    below[0].scatter("x", "v", source=section, color=BLACK, size=2.5)
    below[1].scatter("x", "v", source=section, color=colour, size=3.5, alpha=0.7)
    below[1].x_range, below[1].y_range = below[0].x_range, below[0].y_range
    wavelet = _figure("Wavelet map", 440, Range1d(0.0, 1.0), Range1d(0.1, 1.0))
    mapper = LinearColorMapper(palette=Viridis256, low=0, high=255)
    wavelet.image("image", x="x", y="y", dw="dw", dh="dh", source=image, color_mapper=mapper)
    wavelet.multi_line("xs", "ys", source=cone, color="white", line_dash="dashed")
    wavelet.grid.visible = False
    facts = Div(text="", width=1240)
    labels = [(top[0], 0, 1), (top[1], 2, 3), (below[0], 1, 4), (below[1], 1, 4), (wavelet, 0, 2)]
    axes = [part for plot, x, y in labels for part in ((plot.xaxis[0], x), (plot.yaxis[0], y))]
    view = {
        "history": history, "spectrum": spectrum, "phase": phase, "section": section, "orders": orders,
        "image": image, "cone": cone, "map_x": wavelet.x_range, "map_y": wavelet.y_range, "map_title": wavelet.title,
        "facts": facts, "axes": [list(pair) for pair in axes], "first": top[0],
    }  # fmt: skip
    return view, column(facts, row(*top), row(*below, wavelet))


def _figure(title: str, width: int, x_range: Range1d | None = None, y_range: Range1d | None = None) -> figure:
    kind = "log" if title.startswith(("Amplitude", "Wavelet")) else "linear"
    ranges = {name: value for name, value in (("x_range", x_range), ("y_range", y_range)) if value is not None}
    plot = figure(
        width=width, height=260, title=title, y_axis_type=kind, tools=TOOLS, toolbar_location="above", **ranges
    )
    plot.toolbar.logo = None
    return plot
