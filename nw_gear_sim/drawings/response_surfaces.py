"""Surfaces along the axis of a study: phase trajectories and spectra, stacked and turned by hand; spectra as maps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.events import Pan, PanStart
from bokeh.layouts import column, row
from bokeh.models import ColorBar, ColumnDataSource, CustomJS, Div, FixedTicker, LinearColorMapper, Model, Slider
from bokeh.palettes import Viridis256
from bokeh.plotting import figure

from nw_gear_common.tables import Array
from nw_gear_sim.drawings.response_data import DECADES, Collector, levels
from nw_gear_sim.drawings.response_script import SURFACES, TURN, TURN_BEGINS

ACROSS = 3
SIZE = 440
REACH = 1.9
HEIGHT = 0.8
"""Of the spectra, over half of the width of their box."""


def surfaces(collector: Collector, key: str, units: Model) -> Model:
    """Return the stacked phase trajectories and spectra of all meshes, with sliders and dragging that turn them."""
    azimuth = Slider(title="Turned by (deg)", start=-180, end=180, step=1, value=35, width=300)
    elevation = Slider(title="Seen from above by (deg)", start=-10, end=90, step=1, value=28, width=300)
    views: list[dict[str, Any]] = []
    phase: list[figure] = []
    waterfall: list[figure] = []
    for mesh in collector.meshes:
        for kind, plots in ((_phase, phase), (_waterfall, waterfall)):
            view, plot = kind(collector, mesh, key)
            views.append(view)
            plots.append(plot)
    draw = CustomJS(args={"views": views, "azimuth": azimuth, "elevation": elevation, "units": units}, code=SURFACES)
    for slider in (azimuth, elevation):
        slider.js_on_change("value", draw)
    units.js_on_change("active", draw)
    turn = CustomJS(args={"azimuth": azimuth, "elevation": elevation}, code=TURN)
    for plot in (*phase, *waterfall):
        plot.js_on_event(PanStart, CustomJS(code=TURN_BEGINS))
        plot.js_on_event(Pan, turn)
    phase[0].js_on_change("inner_width", draw)  # the first drawing
    texts = (
        f"Phase trajectories along {key}: drag a picture to turn all of them",
        f"Spectra along {key}: amplitudes upwards, linear",
    )
    heads = [Div(text=f"<b>{text}</b>", width=900) for text in texts]
    return column(row(azimuth, elevation), heads[0], *_rows(phase), heads[1], *_rows(waterfall))


def heat_maps(collector: Collector, key: str) -> Model:
    """Return the spectra of all meshes as maps over the axis."""
    return column(*_rows([_heat(collector, mesh, key) for mesh in collector.meshes]))


def _phase(collector: Collector, mesh: str, key: str) -> tuple[dict[str, Any], figure]:
    lines = collector.phases[mesh]
    detail = next(iter(collector.details.values()))[mesh]
    b, wn = detail["b"], detail["wn"]
    spans = [_span([line[k] for line in lines]) for k in (1, 2)]
    values = [line[0] for line in lines]
    drawn = [
        {"x": _into(x, spans[0]), "y": y, "z": _into(v, spans[1]), "colour": colour}
        for (_, x, v), y, colour in zip(lines, _into(np.array(values), _span([values])), _colours(values), strict=True)
    ]
    axes = ((spans[0], "x / b", 1e6 * b, "x (um)"), (spans[1], "v / (b omega_n)", 1e3 * b * wn, "v (mm/s)"))
    return _view(drawn, axes, (_span([values]), key), mesh, filled=False)


def _waterfall(collector: Collector, mesh: str, key: str) -> tuple[dict[str, Any], figure]:
    edges, lines = collector.spectra(mesh)
    lines = [line for line in lines if collector.drawn(line[0])]
    detail = next(iter(collector.details.values()))[mesh]
    middles = 0.5 * (edges[1:] + edges[:-1])
    across, up = (0.0, float(edges[-1])), (0.0, max(float(np.nanmax(a)) for _, a in lines))
    values = [value for value, _ in lines]
    drawn = []
    for (_, a), y, colour in zip(lines, _into(np.array(values), _span([values])), _colours(values), strict=True):
        there = np.isfinite(a)
        x, z = _into(middles[there], across), -1.0 + HEIGHT * (1.0 + _into(a[there], up))
        ground = np.array([x[-1], x[0]], dtype=np.float32)
        drawn.append({"x": np.concatenate([x, ground]), "y": y, "z": np.append(z, [-1.0, -1.0]).astype("f4"),
                      "colour": colour})  # fmt: skip
    hz, um = detail["wn"] / (2.0 * np.pi), 1e6 * detail["b"]
    axes = ((across, "omega / omega_n", hz, "Frequency (Hz)"), (up, "Amplitude / b", um, "Amplitude (um)"))
    return _view(drawn, axes, (_span([values]), key), mesh, filled=True)


def _view(
    lines: list[dict[str, Any]],
    axes: Sequence[tuple[tuple[float, float], str, float, str]],
    along: tuple[tuple[float, float], str],
    mesh: str,
    *,
    filled: bool,
) -> tuple[dict[str, Any], figure]:
    """Return what the script draws, and the figure: x to the right, the axis of the study into it, z upwards."""
    plot = figure(
        width=SIZE, height=SIZE, x_range=(-REACH, REACH), y_range=(-REACH, REACH), title=mesh, tools="save",
        toolbar_location="right",
    )  # fmt: skip
    plot.toolbar.logo = None
    plot.axis.visible = plot.grid.visible = False
    empty: dict[str, list[Any]] = {"xs": [], "ys": []}
    source, frame = ColumnDataSource({**empty, "colour": []}), ColumnDataSource(dict(empty))
    text = ColumnDataSource({"x": [], "y": [], "text": []})
    plot.multi_line("xs", "ys", source=frame, color="#B5BAC2", line_width=1)
    if filled:
        plot.patches("xs", "ys", source=source, fill_color="white", fill_alpha=0.8, line_color="colour", line_width=1)
    else:
        plot.multi_line("xs", "ys", source=source, color="colour", line_width=1, alpha=0.8)
    plot.text("x", "y", text="text", source=text, text_font_size="10px", text_align="center", text_baseline="middle")
    top = -1.0 + 2.0 * HEIGHT if filled else 1.0
    corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
    edges = [((*corners[k], -1.0), (*corners[k - 1], -1.0)) for k in range(4)] + [((-1, 1, -1), (-1, 1, top))]
    marks: list[dict[str, Any]] = []
    (across, name, unit, si), (up, up_name, up_unit, up_si) = axes
    for t in _ticks(across):
        x = float(_into(np.array([t]), across)[0])
        marks.append(_mark((x, -1.16, -1.0), f"{t:.3g}", f"{unit * t:.3g}"))
    for t in _ticks(along[0]):
        y = float(_into(np.array([t]), along[0])[0])
        marks.append(_mark((1.2, y, -1.0), f"{t:.4g}", f"{t:.4g}"))
    for t in _ticks(up):
        z = float(_into(np.array([t]), up)[0])
        marks.append(_mark((-1.17, 1.0, -1.0 + 0.5 * (1.0 + top) * (1.0 + z)), f"{t:.3g}", f"{up_unit * t:.3g}"))
    marks.append(_mark((0.0, -1.55, -1.0), name, si))
    marks.append(_mark((1.55, 0.0, -1.08), along[1].split(".")[-1], along[1].split(".")[-1]))
    marks.append(_mark((-1.0, 1.0, top + 0.16), up_name, up_si))
    return {"lines": lines, "edges": edges, "marks": marks, "source": source, "frame": frame, "text": text}, plot


def _heat(collector: Collector, mesh: str, key: str) -> figure:
    edges, lines = collector.spectra(mesh)
    values = np.array([value for value, _ in lines])
    amplitude = np.array([a for _, a in lines])
    even = np.linspace(values[0], values[-1], len(values))
    nearest = np.abs(values[None, :] - even[:, None]).argmin(axis=1)  # points at unequal distances
    top = float(np.ceil(np.log10(max(float(np.nanmax(amplitude)), 1e-12))))
    half = 0.5 * (even[1] - even[0])
    plot = figure(
        width=SIZE, height=360, title=f"{mesh}: amplitude / b; dashed: f_m and its harmonics", x_axis_label=key,
        y_axis_label="omega / omega_n", tools="pan,box_zoom,wheel_zoom,reset,save",
        x_range=(even[0] - half, even[-1] + half), y_range=(0.0, float(edges[-1])),
    )  # fmt: skip
    plot.toolbar.logo = None
    mapper = LinearColorMapper(palette=Viridis256, low=0, high=255)
    place = {"x": even[0] - half, "y": 0.0, "dw": even[-1] - even[0] + 2 * half, "dh": float(edges[-1])}
    plot.image([levels(amplitude[nearest].T, top)], color_mapper=mapper, **place)
    orders = np.array(collector.orders[mesh])
    for k in (1, 2, 3):
        plot.line(orders[:, 0], k * orders[:, 1], color="white", line_dash="dashed", line_width=0.8, alpha=0.7)
    exponents = range(int(top - DECADES), int(top) + 1)
    ticks = [255.0 * (n - top + DECADES) / DECADES for n in exponents]
    words = {t: f"{10.0**n:g}" for t, n in zip(ticks, exponents, strict=True)}
    bar = ColorBar(color_mapper=mapper, ticker=FixedTicker(ticks=ticks), major_label_overrides=words, width=10)
    plot.add_layout(bar, "right")
    return plot


def _mark(at: tuple[float, float, float], text: str, si: str) -> dict[str, Any]:
    return {"at": list(at), "text": text, "si": si}


def _span(parts: Sequence[Any]) -> tuple[float, float]:
    low, high = (float(f(np.concatenate([np.ravel(p) for p in parts]))) for f in (np.min, np.max))
    return (low, high) if high > low else (low - 0.5, low + 0.5)


def _into(values: Any, span: tuple[float, float]) -> Any:
    """Map a span to -1 .. 1."""
    return (2.0 * (np.asarray(values) - span[0]) / (span[1] - span[0]) - 1.0).astype(np.float32)


def _ticks(span: tuple[float, float]) -> Array:
    """Return three to six round numbers within a span."""
    width = (span[1] - span[0]) / 3.0
    power = 10.0 ** np.floor(np.log10(width))
    step = next(k for k in (5.0, 2.0, 1.0) if k * power <= width) * power
    first, last = np.ceil(span[0] / step - 1e-9), np.floor(span[1] / step + 1e-9)
    return np.asarray(np.arange(first, last + 1) * step + 0.0)  # no -0


def _colours(values: Sequence[float]) -> list[str]:
    places = np.linspace(0, 225, len(values)).astype(int)
    return [Viridis256[k] for k in places]


def _rows(plots: list[figure]) -> list[Model]:
    return [row(*plots[k : k + ACROSS]) for k in range(0, len(plots), ACROSS)]
