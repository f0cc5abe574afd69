"""A page with a sweep in time over the branches of theory and delay equation."""

from __future__ import annotations

import numpy as np
from bokeh.models import HoverTool, Legend
from bokeh.plotting import figure

from nw_gear_sim.drawings.page import BLUE, GREY, VERMILION, render
from nw_gear_sim.drawings.superharmonic_page import draw_curve, draw_exact, fit_plot, mark_jumps
from nw_gear_sim.superharmonic.family import Curve
from nw_gear_sim.superharmonic.question import Question
from nw_gear_sim.superharmonic.sweeping import Sweep

COLOURS = {"up": VERMILION, "down": BLUE}
MARKERS = {"up": "triangle", "down": "inverted_triangle"}


def page(found: Sweep, curve: Curve, question: Question) -> str:
    """Return a self-contained page.

    Args:
        found: the sweep; curve: first order and delay equation over the same frequencies; question: what is answered.
    """
    plot = figure(
        width=1200, height=600, x_axis_label="excitation frequency omega",
        y_axis_label="amplitude alpha of the third superharmonic", tools="pan,box_zoom,wheel_zoom,reset,save",
    )  # fmt: skip
    items = [(f"first order, trust {curve.trust:.2g}", draw_curve(plot, curve, GREY))]
    if curve.exact is not None:
        items.append((f"delay equation, {question.law}", draw_exact(plot, curve.exact, "#009E73")))
    for direction in ("up", "down"):
        items.append((f"in time, {direction}", _draw(plot, found, direction)))
        mark_jumps(plot, [j for j in found.jumps if j.sweep == direction], COLOURS[direction], filled=True)
    plot.add_layout(Legend(items=items, click_policy="hide"), "right")
    parts = [("", "", plot)]
    if question.fit is not None:
        parts.append(("Cubic fit of the backlash", question.in_words(), fit_plot(question)))
    return render(f"Sweep of the superharmonic resonance, stage {question.pair.stage}", _intro(found, curve), parts)


def _intro(found: Sweep, curve: Curve) -> list[str]:
    unsettled = sum(not step.settled for step in found.steps)
    several = sorted({step.repeats for step in found.steps if step.repeats > 1})
    said = [
        "Triangles: the delay equation integrated in time, from rest at the lowest frequency up to the highest and "
        "back down, the motion carried on from step to step. Arrows are its jumps; they start at the fold at which the "
        "branch that it had been on turns back.",
        "Beneath: the first order of the theory (thin; dotted where unstable) and the branch of the same delay "
        "equation by harmonic balance (broad; dotted where unstable).",
    ]
    if unsettled:
        said.append(
            f"At {unsettled} of {len(found.steps)} steps the motion didn't take the period of the excitation: "
            "bars give the range of alpha from period to period."
            + (f" Some repeat after {', '.join(map(str, several))} periods." if several else "")
        )
    said += [f"Jump {jump.in_words('omega')}." for jump in found.jumps]
    said.append(
        f"Trust of the first order: {curve.trust:.3g}, "
        + ("within about 5 %." if curve.trust <= 1.0 else "off by more than about 5 %.")
    )
    return said


def _draw(plot: figure, found: Sweep, direction: str) -> list[object]:
    steps = [step for step in found.steps if step.direction == direction]
    colour = COLOURS[direction]
    drawn: list[object] = []
    restless = [step for step in steps if not step.settled]
    if restless:
        at = [step.omega for step in restless]
        drawn.append(
            plot.segment(
                at, [s.low for s in restless], at, [s.high for s in restless], line_color=colour, line_alpha=0.5,
                line_width=3,
            )
        )  # fmt: skip
    omega, alpha = np.array([s.omega for s in steps]), np.array([s.alpha for s in steps])
    marks = plot.scatter(omega, alpha, marker=MARKERS[direction], size=7, color=colour, fill_alpha=0.6)
    plot.add_tools(HoverTool(renderers=[marks], tooltips=[("omega", "$x{0.000000}"), ("alpha", "$y{0.0000}")]))
    return [*drawn, marks]
