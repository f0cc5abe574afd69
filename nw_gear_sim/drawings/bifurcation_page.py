"""A page with a bifurcation diagram: sections of the three stages over the axis, and the largest exponent below."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.layouts import column
from bokeh.models import ColorBar, LinearColorMapper, Span
from bokeh.plotting import figure

from nw_gear_sim.drawings.page import BLACK, GREY, STAGE_COLOURS, VERMILION, render
from nw_gear_sim.studies.diagram import Row

MESHES = ("I_1", "II_1", "III")
UM = 1e6
MOST_DOTS = 400_000


def page(found: Sequence[Row], keys: Sequence[str]) -> str:
    """Return a self-contained page; a diagram for one axis, maps of the exponent and the period for two."""
    unsettled = sum(not row.settled for row in found if row.mesh in MESHES)
    total = sum(row.mesh in MESHES for row in found)
    intro = [
        "Poincare sections of one mesh of each stage, and the largest Lyapunov exponent of the whole gearbox, +- three "
        "standard errors. Positive means chaotic.",
        f"{unsettled} of {total} sections differ between both halves of their record: they may not have settled.",
    ]
    parts = [_diagram(found, keys[0])] if len(keys) == 1 else [_map(found, keys)]
    return render("Bifurcation over " + " and ".join(keys), intro, [("", "", parts[0])], widgets=False)


def _diagram(found: Sequence[Row], key: str) -> column:
    plots: list[figure] = []
    for mesh in MESHES:
        own = [row for row in found if row.mesh == mesh]
        plot = figure(
            width=1200, height=300, x_axis_label=key, y_axis_label=f"x_{mesh} (um)", output_backend="webgl",
            tools="pan,box_zoom,wheel_zoom,reset,save", **({"x_range": plots[0].x_range} if plots else {}),
        )  # fmt: skip
        thin = max(1, sum(len(row.x) for row in own) // MOST_DOTS)
        for sweep, colour in (("", STAGE_COLOURS[mesh.split("_")[0]]), ("up", BLACK), ("down", VERMILION)):
            rows = [row for row in own if row.sweep == sweep]
            if rows:
                x = np.concatenate([np.full(len(row.x[::thin]), row.values[0]) for row in rows])
                y = np.concatenate([UM * row.x[::thin] for row in rows])
                label = {"legend_label": f"sweep {sweep}"} if sweep else {}
                plot.scatter(x, y, size=1.6, color=colour, alpha=0.55, **label)
        plots.append(plot)
    exponent = figure(
        width=1200, height=240, x_axis_label=key, y_axis_label="largest exponent (1/s)", x_range=plots[0].x_range,
        tools="pan,box_zoom,wheel_zoom,reset,save",
    )  # fmt: skip
    for sweep, colour in (("", GREY), ("up", BLACK), ("down", VERMILION)):
        rows = [row for row in found if row.mesh == "I_1" and row.sweep == sweep and np.isfinite(row.rate)]
        at = [row.values[0] for row in rows]
        low, high = ([row.rate + sign * 3.0 * row.error for row in rows] for sign in (-1.0, 1.0))
        exponent.segment(at, low, at, high, color=colour)
        exponent.scatter(at, [row.rate for row in rows], size=4, color=colour)
    exponent.add_layout(Span(location=0.0, dimension="width", line_color=GREY, line_dash="dashed"))
    return column(*plots, exponent)


def _map(found: Sequence[Row], keys: Sequence[str]) -> column:
    own = [row for row in found if row.mesh == "II_1"]
    largest = max((abs(row.rate) for row in own if np.isfinite(row.rate)), default=1.0)
    colours = LinearColorMapper("RdBu11", low=-largest, high=largest)
    steps = [np.unique([row.values[k] for row in own]) for k in range(2)]
    width, height = (float(np.min(np.diff(step))) if len(step) > 1 else 1.0 for step in steps)
    plot = figure(
        width=1000, height=700, x_axis_label=keys[0], y_axis_label=keys[1], title="largest exponent (1/s)",
        tools="pan,box_zoom,wheel_zoom,reset,save,hover", tooltips=[("rate", "@rate"), ("stage II", "@state")],
    )  # fmt: skip
    source = {
        "x": [row.values[0] for row in own],
        "y": [row.values[1] for row in own],
        "rate": [row.rate for row in own],
        "state": [row.state for row in own],
    }
    plot.rect("x", "y", width, height, source=source, color={"field": "rate", "transform": colours})
    plot.add_layout(ColorBar(color_mapper=colours), "right")
    return column(plot)
