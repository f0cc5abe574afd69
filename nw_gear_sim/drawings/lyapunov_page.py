"""A page with Lyapunov exponents: over the axis or by their number, and how their means settled."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import ColorBar, HoverTool, LinearColorMapper, Span
from bokeh.palettes import Viridis256
from bokeh.plotting import figure

from nw_gear_sim.drawings.page import BLUE, GREEN, GREY, ORANGE, PINK, SKY, VERMILION, render
from nw_gear_sim.studies.lyapunov import SIGMAS, Row

COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PINK, SKY)
CURVES = 6
"""Exponents drawn over an axis, and means drawn of a single point."""
DARK = 225
"""Colours of the scale that stand out from white."""
TOOLS = "pan,box_zoom,wheel_zoom,reset,save"


def page(found: Sequence[Row], keys: Sequence[str]) -> str:
    """Return a self-contained page."""
    parts = [
        ("Exponents", _meaning(found), _over_axis(found, keys[0]) if keys else _by_number(found[0])),
        (
            "Convergence",
            "Means from the end of the settling up to each time; a mean that still runs away at the right end needs "
            "a longer record than its error says.",
            _convergence(found, keys),
        ),
    ]
    title = "Lyapunov exponents" + (f" over {keys[0]}" if keys else "")
    intro = [
        "How fast deviations from the motion grow (positive: chaos) or decay, by the variational equations. Error bars "
        "are three standard errors from the scatter between blocks of the record. The phase of the excitation isn't a "
        "state, so that it adds no exponent of zero."
    ]
    return render(title, intro, parts, widgets=False)


def _meaning(found: Sequence[Row]) -> str:
    names = ("chaotic", "regular", "unknown", "diverged")
    counts = [(name, sum(row.motion == name for row in found)) for name in names]
    text = "Points: " + ", ".join(f"{count} {name}" for name, count in counts if count) + "."
    complete = [row for row in found if row.complete and np.isfinite(row.divergence)]
    if complete:
        worst = max(abs(float(row.rate.sum()) / row.divergence - 1.0) for row in complete)
        text += f" The sum of all exponents is the mean divergence of the flow to within {worst:.1e}."
    if len(found) == 1 and np.isfinite(found[0].dimension):
        text += f" Kaplan-Yorke dimension {found[0].dimension:.2f}."
    return text


def _over_axis(found: Sequence[Row], key: str) -> figure:
    plot = figure(
        width=1280, height=460, x_axis_label=key, y_axis_label="exponent (1/s)", tools=TOOLS,
    )  # fmt: skip
    at = np.array([row.values[0] for row in found])
    for k in range(min(CURVES, len(found[0].rate))):
        rate, error = (np.array([getattr(row, name)[k] for row in found]) for name in ("rate", "error"))
        period = np.array([row.period for row in found])
        source = {"x": at, "y": rate, "per": rate * period, "low": rate - SIGMAS * error, "high": rate + SIGMAS * error}
        label = f"exponent {k + 1}" if k else "largest"
        plot.segment("x", "low", "x", "high", source=source, color=COLOURS[k], line_width=1.5)
        plot.line("x", "y", source=source, color=COLOURS[k], alpha=0.5)
        dots = plot.scatter("x", "y", source=source, size=6, color=COLOURS[k], legend_label=label)
        if k == 0:
            shown = [(key, "@x"), ("1/s", "@y{0.00}"), ("per mesh period of II", "@per{0.0000}")]
            plot.add_tools(HoverTool(renderers=[dots], tooltips=shown))
    plot.add_layout(Span(location=0.0, dimension="width", line_color=GREY, line_dash="dashed"))
    plot.legend.click_policy = "hide"
    return plot


def _by_number(row: Row) -> figure:
    plot = figure(
        width=1280, height=460, x_axis_label="number of the exponent", y_axis_label="exponent (1/s)", tools=TOOLS,
        tooltips=[("number", "@x"), ("1/s", "@y{0.00}"), ("per mesh period of II", "@per{0.0000}")],
    )  # fmt: skip
    source = {
        "x": np.arange(len(row.rate)) + 1, "y": row.rate, "per": row.rate * row.period,
        "low": row.rate - SIGMAS * row.error, "high": row.rate + SIGMAS * row.error,
    }  # fmt: skip
    plot.segment("x", "low", "x", "high", source=source, color=BLUE, line_width=1.5)
    plot.scatter("x", "y", source=source, size=5, color=BLUE)
    plot.add_layout(Span(location=0.0, dimension="width", line_color=GREY, line_dash="dashed"))
    return plot


def _convergence(found: Sequence[Row], keys: Sequence[str]) -> figure:
    label = "mean of the largest exponent (1/s)" if keys else "mean (1/s)"
    plot = figure(
        width=1280, height=380, x_axis_label="time since the deviations settled (s)", y_axis_label=label, tools=TOOLS
    )
    if not keys:
        row = found[0]
        for k in range(min(CURVES, len(row.rate))):
            plot.line(row.time, row.history[:, k], color=COLOURS[k], legend_label=f"exponent {k + 1}", line_width=1.5)
    else:
        values = [row.values[0] for row in found]
        mapper = LinearColorMapper(Viridis256[:DARK], low=min(values), high=max(values))
        source = {
            "x": [row.time for row in found], "y": [row.history[:, 0] for row in found], "value": values
        }  # fmt: skip
        plot.multi_line("x", "y", source=source, color={"field": "value", "transform": mapper}, line_width=1.5)
        plot.add_layout(ColorBar(color_mapper=mapper, title=keys[0]), "right")
    plot.add_layout(Span(location=0.0, dimension="width", line_color=GREY, line_dash="dashed"))
    return plot
