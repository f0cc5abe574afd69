"""A page with a map of basins: which start ends in which motion."""

from __future__ import annotations

import numpy as np
from bokeh.models import HoverTool, Label, Legend, LinearColorMapper
from bokeh.plotting import figure

from nw_gear_common.tables import Array
from nw_gear_sim.drawings.page import BLACK, render
from nw_gear_sim.superharmonic.basins import Basins, state
from nw_gear_sim.superharmonic.pair import PARAMETERS
from nw_gear_sim.superharmonic.question import Question

ELSEWHERE = "#9a9a9a"
COLOURS = ("#9ecae1", "#fdbe85", "#a1d99b", "#d4b9da", "#fff2ae", "#f4cae4")
HISTORIES = {
    "constant": "at rest at x until time 0, when it is set off with v",
    "free": "the free linear motion through the start, at w0",
}


def page(found: Basins, question: Question) -> str:
    """Return a self-contained page.

    Args:
        found: the map; question: what it answers.
    """
    left, width = _extent(found.x)
    bottom, height = _extent(found.v)
    plot = figure(
        width=1100, height=760, x_axis_label="displacement x at time 0 (half backlashes)",
        y_axis_label="velocity v at time 0 (half backlashes per unit of the dimensionless time)",
        x_range=(left, left + width), y_range=(bottom, bottom + height), tools="pan,box_zoom,wheel_zoom,reset,save",
    )  # fmt: skip
    palette = (ELSEWHERE, *(COLOURS[k % len(COLOURS)] for k in range(len(found.orbits))))
    mapper = LinearColorMapper(palette, low=-1.5, high=len(found.orbits) - 0.5)
    image = plot.image(
        image=[found.ends.T.astype(np.float32)], x=left, y=bottom, dw=width, dh=height, color_mapper=mapper
    )
    plot.add_tools(HoverTool(renderers=[image], tooltips=[("x", "$x{0.000}"), ("v", "$y{0.000}"), ("orbit", "@image")]))
    plot.add_layout(Legend(items=_marks(plot, found)), "below")
    title = f"Basins of the superharmonic resonance, stage {question.pair.stage}"
    return render(title, _intro(found, question), [("", "", plot)])


def _marks(plot: figure, found: Basins) -> list[tuple[str, list[object]]]:
    """Mark the orbits at phase 0, and return entries of the legend that tell their shares."""
    items: list[tuple[str, list[object]]] = []
    for k, ((orbit, stable), share) in enumerate(zip(found.orbits, found.shares, strict=True)):
        x, v = state(orbit)
        marker = "circle" if stable else "x"
        colour = COLOURS[k % len(COLOURS)] if stable else BLACK
        drawn = plot.scatter([x], [v], marker=marker, size=13, fill_color=colour, line_color=BLACK, line_width=2)
        plot.add_layout(Label(x=x, y=v, text=str(k), x_offset=9, y_offset=5, text_font_style="bold"))
        words = f"{100.0 * share:.1f} % of the starts" if stable else "unstable"
        items.append((f"{k}: alpha = {orbit.amplitude(3):.4g}, {words}", [drawn]))
    if found.elsewhere > 0.0:
        square = plot.scatter([np.nan], [np.nan], marker="square", size=13, color=ELSEWHERE)
        items.append((f"elsewhere, {100.0 * found.elsewhere:.1f} %", [square]))
    return items


def _intro(found: Basins, question: Question) -> list[str]:
    pair = question.pair
    return [
        f"The delay equation with the {question.law} at omega = {found.omega:g}, integrated from {found.ends.size} "
        f"starts: the colour tells in which motion each ends. Before the start: {HISTORIES[found.history]}. Excitation "
        "at phase 0.",
        "Circles are the stable orbits at phase 0, crosses unstable ones. An orbit has a history of its own, so this "
        "plane meets it exactly only without feedback; with gains of order eps it comes close.",
        ", ".join(f"{name} = {getattr(pair, name):.5g}" for name in (*PARAMETERS, "eps", "w0", "q")),
    ]


def _extent(axis: Array) -> tuple[float, float]:
    """Return where the cells of an axis begin, and how far they reach."""
    step = float(axis[1] - axis[0]) if axis.size > 1 else 1.0
    return float(axis[0]) - 0.5 * step, float(axis[-1] - axis[0]) + step
