"""A page with a chart over two parameters: damping, folds, width of the multivalued range, peak."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np
from bokeh.layouts import gridplot
from bokeh.models import ColorBar, ColorMapper, Div, FixedTicker, HoverTool, LinearColorMapper, LogColorMapper
from bokeh.palettes import Viridis256, interp_palette
from bokeh.plotting import figure

from nw_gear_common.tables import Array
from nw_gear_sim.drawings.page import BLACK, BLUE, GREY, VERMILION, render
from nw_gear_sim.superharmonic.gainchecks import Check
from nw_gear_sim.superharmonic.gainmap import Chart
from nw_gear_sim.superharmonic.pair import PARAMETERS
from nw_gear_sim.superharmonic.question import Question

MOST_DRAWN = 401
"""Points along an axis that are drawn; more are thinned out."""
DIVERGING = interp_palette(("#7f2704", VERMILION, "#ffffff", BLUE, "#08306b"), 255)


def page(chart: Chart, question: Question, found: Sequence[Check]) -> str:
    """Return a self-contained page.

    Args:
        chart: to draw; question: what it answers; found: points of the delay equation beside it, if any.
    """
    reach = float(np.max(np.abs(chart.mu))) or 1.0
    panels = [
        ("effective damping mu; black: mu = 0", chart.mu, LinearColorMapper(DIVERGING, low=-reach, high=reach)),
        ("folds of the resonance curve", chart.folds.astype(float), LinearColorMapper(FOLDS, low=-0.5, high=2.5)),
        ("width of the range of omega with three amplitudes", chart.width, _logarithmic(chart.width)),
        ("peak amplitude alpha where mu > 0", chart.peak, _logarithmic(chart.peak)),
    ]
    if chart.omega is not None:
        at = f"at omega = {chart.omega:g}"
        counts = LinearColorMapper(FOLDS, low=-0.5, high=2.5)
        panels.append((f"stable amplitudes {at}", chart.count.astype(float), counts))
        panels.append((f"largest stable alpha {at}", chart.largest, _logarithmic(chart.largest)))
    plots: list[figure] = []
    for title, values, colours in panels:
        plot = _panel(chart, title, values, colours)
        if plots:
            plot.x_range, plot.y_range = plots[0].x_range, plots[0].y_range
        _mark(plot, chart, found)
        plots.append(plot)
    grid = gridplot([plots[k : k + 2] for k in range(0, len(plots), 2)], toolbar_location="right")
    parts = [("", "", grid)]
    if found:
        parts.append(("Points of the delay equation", _CHECKED, _listed(chart, found)))
    title = f"Superharmonic resonance, stage {question.pair.stage}: {' and '.join(chart.names)}"
    return render(title, _intro(chart, question), parts)


FOLDS = ("#e8e8e8", "#E69F00", "#56B4E9")
_CHECKED = (
    "First order / harmonic balance with the delays, at the crosses. Its damping is that of a disturbance below the "
    "resonance; a dash means that there is none, or that the branch can't be followed through the usual range."
)


def _intro(chart: Chart, question: Question) -> list[str]:
    pair = question.pair
    moved = {*chart.names, *(("tau_d", "tau_v") if "tau" in chart.names else ())}
    fixed = ", ".join(f"{name} = {getattr(pair, name):.5g}" for name in PARAMETERS if name not in moved)
    return [
        f"First order of the theory, mode {question.mode}; what isn't an axis: {fixed}; eps = {pair.eps:g}, w0 = "
        f"{pair.w0:g}, q = {pair.q:g}.",
        "mu = c zeta - [g_v cos(w0 tau_v) - (g_d/w0) sin(w0 tau_d)]/2. On the red side of mu = 0 no steady motion is "
        "stable. Two folds exist where |mu| < mu_c: there the amplitude jumps. One fold means that the other lies too "
        "far from the resonance for the theory. White: nothing to show.",
    ]


def _panel(chart: Chart, title: str, values: Array, colours: ColorMapper) -> figure:
    thin = [max(1, -(-axis.size // MOST_DRAWN)) for axis in chart.axes]
    x, y = chart.axes
    left, bottom, width, height = *(float(axis[0] - 0.5 * _step(axis)) for axis in (x, y)), *(
        float(axis[-1] - axis[0] + _step(axis)) for axis in (x, y)
    )  # fmt: skip
    plot = figure(
        width=640, height=440, title=title, x_axis_label=chart.names[0], y_axis_label=chart.names[1],
        x_range=(left, left + width), y_range=(bottom, bottom + height), tools="pan,box_zoom,wheel_zoom,reset,save",
    )  # fmt: skip
    drawn = plot.image(
        image=[values[:: thin[0], :: thin[1]].T.astype(np.float32)], x=left, y=bottom, dw=width, dh=height,
        color_mapper=colours,
    )  # fmt: skip
    places = [(chart.names[0], "$x{0.0000}"), (chart.names[1], "$y{0.0000}")]
    plot.add_tools(HoverTool(renderers=[drawn], tooltips=[*places, ("value", "@image{0.0000}")]))
    bar = ColorBar(color_mapper=colours, width=14)
    if isinstance(colours, LinearColorMapper) and tuple(colours.palette) == FOLDS:
        bar.ticker = FixedTicker(ticks=[0, 1, 2])
    plot.add_layout(bar, "right")
    return plot


def _mark(plot: figure, chart: Chart, found: Sequence[Check]) -> None:
    if min(chart.mu.shape) > 1 and chart.mu.min() < 0.0 < chart.mu.max():
        plot.contour(*chart.axes, chart.mu.T, levels=[0.0], line_color=BLACK, line_width=2)
    if found:
        x, y = [check.first for check in found], [check.second for check in found]
        plot.scatter(x, y, marker="x", size=11, color="white", line_width=4)
        plot.scatter(x, y, marker="x", size=9, color=BLACK, line_width=2)


def _step(axis: Array) -> float:
    return float(axis[1] - axis[0]) if axis.size > 1 else max(abs(float(axis[0])), 1.0) * 0.1


def _logarithmic(values: Array) -> LogColorMapper:
    seen = values[np.isfinite(values) & (values > 0.0)]
    low, high = (float(seen.min()), float(seen.max())) if seen.size else (0.1, 1.0)
    return LogColorMapper(Viridis256, low=low, high=max(high, 1.001 * low), nan_color="white", low_color="white")


def _listed(chart: Chart, found: Sequence[Check]) -> Div:
    heads = [*chart.names, "mu", "folds", "width", "peak alpha"]
    rows = []
    for check in found:
        pairs = [
            (check.mu, check.exact_mu), (check.folds, check.exact_folds), (check.width, check.exact_width),
            (check.peak, check.exact_peak),
        ]  # fmt: skip
        cells = [f"{check.first:.4g}", f"{check.second:.4g}", *(f"{_text(a)} / {_text(b)}" for a, b in pairs)]
        rows.append("<tr>" + "".join(f"<td>{value}</td>" for value in cells) + "</tr>")
    top = "".join(f"<th>{html.escape(head)}</th>" for head in heads)
    cell = f"padding: 0.2rem 1.4rem 0.2rem 0; text-align: left; border-bottom: 1px solid {GREY};"
    style = f"<style>td, th {{ {cell} }}</style>"
    return Div(text=f"{style}<table><tr>{top}</tr>{''.join(rows)}</table>", width=1200)


def _text(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
