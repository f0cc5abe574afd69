"""A page with superharmonic curves: stable and unstable branches, folds, jumps, trust in the theory."""

from __future__ import annotations

import html
from collections.abc import Iterator, Sequence

import numpy as np
from bokeh.models import Arrow, Div, HoverTool, LabelSet, Legend, NormalHead
from bokeh.models.sources import ColumnDataSource
from bokeh.plotting import figure
from scipy.optimize import linear_sum_assignment

from nw_gear_common.tables import Array
from nw_gear_sim.drawings.page import BLACK, BLUE, GREEN, ORANGE, PINK, SKY, VERMILION, render
from nw_gear_sim.superharmonic.exact import ExactBranch
from nw_gear_sim.superharmonic.family import Curve
from nw_gear_sim.superharmonic.firstorder import OMEGA, TRUSTED
from nw_gear_sim.superharmonic.jumps import Jump
from nw_gear_sim.superharmonic.question import Question
from nw_gear_sim.superharmonic.restoring import unit_backlash

COLOURS = (BLUE, VERMILION, GREEN, PINK, ORANGE, SKY, BLACK)


def page(curves: Sequence[Curve], question: Question) -> str:
    """Return a self-contained page.

    Args:
        curves: of one family; question: what they answer.
    """
    first = curves[0]
    over = "excitation frequency omega" if first.over == OMEGA else first.over
    plot = figure(
        width=1200, height=560, x_axis_label=over, y_axis_label="amplitude alpha of the third superharmonic",
        tools="pan,box_zoom,wheel_zoom,reset,save",
    )  # fmt: skip
    items = []
    for k, curve in enumerate(curves):
        colour = COLOURS[k % len(COLOURS)]
        drawn = draw_curve(plot, curve, colour)
        if curve.exact is not None:
            drawn += draw_exact(plot, curve.exact, colour)
            mark_jumps(plot, curve.exact.jumps, colour, filled=False)
        mark_jumps(plot, curve.jumps, colour, filled=True)
        judged = "" if question.slope is not None else f", trust {curve.trust:.2g}"
        items.append((f"{curve.name}{judged}", drawn))
    plot.add_layout(Legend(items=items, click_policy="hide"), "right")
    plot.add_tools(HoverTool(tooltips=[(first.over, "$x{0.000000}"), ("alpha", "$y{0.0000}")]))
    parts = [("", "", plot), ("Each curve", "", _listed(curves, question))]
    if question.fit is not None:
        parts.append(("Cubic fit of the backlash", question.in_words(), fit_plot(question)))
    return render(f"Superharmonic resonance, stage {first.pair.stage}", _intro(curves, question), parts)


def _intro(curves: Sequence[Curve], question: Question) -> list[str]:
    measure = TRUSTED * max(curve.trust for curve in curves)
    verdict = "first order within about 5 %" if measure <= TRUSTED else "first order off by more than about 5 %"
    said = [
        f"Gear pair of stage {question.pair.stage}, mode {question.mode}. Thin lines are the first order of theory, "
        "full where stable, dotted where not. Arrows are jumps: a slow sweep falls from A3 to A1, and on its way back "
        "rises from A2 to A4.",
        f"Trust: eps 3 q Lam^2 / w0 = {measure:.4g}, limit {TRUSTED:g}: {verdict}.",
    ]
    if any(curve.exact is not None for curve in curves):
        said.append(
            f"Broad lines are the delay equation itself with the {question.law}, by harmonic balance; dotted where "
            "unstable, with open arrows."
        )
    if question.slope is not None:
        said.append(
            "The first order knows the cubic alone. With the gap itself, the branch may lose its stability to motions "
            "that aren't periodic, and exponents say nothing where an orbit only just touches a flank."
        )
    return said


def draw_curve(plot: figure, curve: Curve, colour: str) -> list[object]:
    """Draw the first order of a curve, and return what belongs to its entry in the legend."""
    b = curve.branches
    drawn: list[object] = []
    for dash, wanted in (("solid", b.stable), ("dotted", ~b.stable & np.isfinite(b.alpha))):
        xs, ys = _strands(b.values, np.where(wanted, b.alpha, np.nan))
        drawn.append(plot.multi_line(xs, ys, line_color=colour, line_width=1.5, line_dash=dash))
    return drawn


def draw_exact(plot: figure, branch: ExactBranch, colour: str) -> list[object]:
    """Draw a branch of the delay equation, and return what belongs to its entry in the legend."""
    drawn: list[object] = []
    for stable, dash in ((True, "solid"), (False, (2, 4))):
        runs = list(_runs(branch, stable))
        if runs:
            xs, ys = [[p[0] for p in run] for run in runs], [[p[1] for p in run] for run in runs]
            drawn.append(plot.multi_line(xs, ys, line_color=colour, line_width=5, line_alpha=0.4, line_dash=dash))
    return drawn


def _runs(branch: ExactBranch, stable: bool) -> Iterator[list[tuple[float, float]]]:
    """Yield stretches of points that are (un)stable, each with the point after it, so that no gap is left."""
    run: list[tuple[float, float]] = []
    for point in branch.points:
        if point.stable is stable or run:
            run.append((point.omega, point.alpha))
        if point.stable is not stable and run:
            yield run
            run = []
    if run:
        yield run


def mark_jumps(plot: figure, jumps: Sequence[Jump], colour: str, *, filled: bool) -> None:
    """Draw an arrow for each jump that has somewhere to land, with the names of its ends; circles at other folds."""
    labels: dict[str, list[object]] = {"x": [], "y": [], "name": []}
    for jump in jumps:
        plot.scatter([jump.value], [jump.start], marker="circle", size=8, line_color=colour, fill_color=None)
        if jump.end is None or not jump.real:
            continue
        head = NormalHead(size=9, fill_color=colour if filled else "white", line_color=colour)
        plot.add_layout(
            Arrow(
                x_start=jump.value,
                x_end=jump.value,
                y_start=jump.start,
                y_end=jump.end,
                end=head,
                line_color=colour,
                line_dash="dashed",
            )
        )
        for name, alpha in zip(jump.names, (jump.start, jump.end), strict=True):
            labels["x"].append(jump.value)
            labels["y"].append(alpha)
            labels["name"].append(name)
    if labels["x"] and filled:
        plot.add_layout(
            LabelSet(
                x="x",
                y="y",
                text="name",
                source=ColumnDataSource(labels),
                x_offset=6,
                y_offset=-4,
                text_color=colour,
                text_font_size="12px",
            )
        )


def fit_plot(question: Question) -> figure:
    """Return a plot of the backlash and of the cubic fitted to it, over the interval of the fit."""
    fit = question.fit
    assert fit is not None
    x = np.linspace(-1.1 * fit.interval, 1.1 * fit.interval, 801)
    plot = figure(
        width=1200, height=380, x_axis_label="displacement (half backlashes)", y_axis_label="force over c k_m",
        tools="pan,box_zoom,wheel_zoom,reset,save,hover",
    )  # fmt: skip
    cubic = fit.delta_1 * x + fit.delta_2 * x**3
    inside = np.abs(x) <= fit.interval
    plot.line(x, unit_backlash(x), line_color=BLACK, line_width=2, legend_label="backlash")
    plot.line(x, cubic, line_color=VERMILION, line_dash="dotted", line_width=1.5)
    plot.line(x[inside], cubic[inside], line_color=VERMILION, line_width=2, legend_label="cubic, within its interval")
    plot.line(
        x[inside],
        (cubic - unit_backlash(x))[inside],
        line_color=BLUE,
        line_width=1.5,
        legend_label="cubic less backlash",
    )
    plot.legend.location = "top_left"
    return plot


def _listed(curves: Sequence[Curve], question: Question) -> Div:
    """Return a table with trust, largest amplitude and jumps of each curve."""
    rows = []
    for curve in curves:
        best, at = curve.highest()
        verdict = "within about 5 %" if curve.trust <= 1.0 else "off by more than about 5 %"
        jumps = [jump.in_words(curve.over) for jump in curve.jumps] or ["none"]
        cells = [curve.name, f"{curve.trust:.3g}: {verdict}", f"{best:.4g} at {at:.6g}", "<br>".join(jumps)]
        if curve.exact is not None:
            top = max(point.alpha for point in curve.exact.points)
            own = [jump.in_words(curve.over) for jump in curve.exact.jumps] or ["none"]
            cells += [f"{top:.4g}" + ("" if curve.exact.whole else " (branch lost)"), "<br>".join(own)]
        rows.append(cells)
    heads = ["curve", "trust of the first order", "its largest alpha", "its jumps"]
    heads += [f"largest alpha with the {question.law}", "jumps"] if curves[0].exact is not None else []
    text = "".join(f"<th>{html.escape(head)}</th>" for head in heads)
    lines = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>" for cells in rows)
    style = "<style>td, th { padding: 0.2rem 1rem 0.2rem 0; text-align: left; vertical-align: top; }</style>"
    return Div(text=f"{style}<table><tr>{text}</tr>{lines}</table>", width=1200)


def _strands(values: Array, alpha: Array) -> tuple[list[list[float]], list[list[float]]]:
    """Cut amplitudes (n, 3) into lines: those of neighbouring values are joined so that they change least."""
    running: list[tuple[list[float], list[float]]] = []
    ended: list[tuple[list[float], list[float]]] = []
    for value, row in zip(values, alpha, strict=True):
        here = row[np.isfinite(row)]
        ends = np.array([line[1][-1] for line in running])
        before, now = linear_sum_assignment(np.abs(ends[:, None] - here[None, :]))
        met = dict(zip(now.tolist(), before.tolist(), strict=True))
        ended += [line for k, line in enumerate(running) if k not in met.values()]
        running = [running[met[k]] if k in met else ([], []) for k in range(len(here))]
        for line, a in zip(running, here, strict=True):
            line[0].append(float(value))
            line[1].append(float(a))
    ended += running
    return [line[0] for line in ended], [line[1] for line in ended]
