"""A page with superharmonic curves: stable and unstable branches, folds, jumps, trust in the theory."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import HoverTool, Legend
from bokeh.plotting import figure
from scipy.optimize import linear_sum_assignment

from nw_gear_common.tables import Array
from nw_gear_sim.drawings.page import BLACK, BLUE, GREEN, ORANGE, PINK, SKY, VERMILION, render
from nw_gear_sim.superharmonic.family import Curve
from nw_gear_sim.superharmonic.firstorder import OMEGA, TRUSTED

COLOURS = (BLUE, VERMILION, GREEN, PINK, ORANGE, SKY, BLACK)


def page(curves: Sequence[Curve], mode: str) -> str:
    """Return a self-contained page.

    Args:
        curves: of one family; mode: of the first-order theory.
    """
    first = curves[0]
    over = "excitation frequency omega" if first.over == OMEGA else first.over
    plot = figure(
        width=1100, height=560, x_axis_label=over, y_axis_label="amplitude alpha of the third superharmonic",
        tools="pan,box_zoom,wheel_zoom,reset,save",
    )  # fmt: skip
    items = []
    for k, curve in enumerate(curves):
        colour = COLOURS[k % len(COLOURS)]
        drawn = _draw(plot, curve, colour)
        items.append((curve.name, drawn))
    plot.add_layout(Legend(items=items, click_policy="hide"), "right")
    plot.add_tools(HoverTool(tooltips=[(first.over, "$x{0.000000}"), ("alpha", "$y{0.0000}")]))
    measure = max(float(np.max(curve.branches.trust)) for curve in curves)
    verdict = "first order within about 5 %" if measure <= TRUSTED else "first order off by more than about 5 %"
    intro = [
        f"Gear pair of stage {first.pair.stage}, mode {mode}. Full lines are stable, dotted ones unstable; circles are "
        "folds, where the amplitude jumps. Crosses, where shown, are the delay equation itself (harmonic balance).",
        f"Trust: eps 3 q Lam^2 / w0 = {measure:.4g}, limit {TRUSTED:g}: {verdict}.",
    ]
    return render(f"Superharmonic resonance, stage {first.pair.stage}", intro, [("", "", plot)], widgets=False)


def _draw(plot: figure, curve: Curve, colour: str) -> list[object]:
    b = curve.branches
    drawn: list[object] = []
    for dash, wanted in (("solid", b.stable), ("dotted", ~b.stable & np.isfinite(b.alpha))):
        xs, ys = _strands(b.values, np.where(wanted, b.alpha, np.nan))
        drawn.append(plot.multi_line(xs, ys, line_color=colour, line_width=2, line_dash=dash))
    if b.folds:
        at, height = _at_folds(curve)
        drawn.append(plot.scatter(at, height, marker="circle", size=9, line_color=colour, fill_color=None))
    for stable, alpha in ((True, 0.9), (False, 0.35)):
        points = [point for point in curve.exact or () if point.stable is stable]
        if points:
            drawn.append(
                plot.scatter(
                    [p.omega for p in points], [p.alpha for p in points], marker="x", size=6, color=colour, alpha=alpha
                )
            )
    return drawn


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


def _at_folds(curve: Curve) -> tuple[list[float], list[float]]:
    """Return folds with the amplitude at which two branches meet: the closest pair of the nearest value beside."""
    b = curve.branches
    xs, ys = [], []
    inside = np.flatnonzero(b.multivalued)
    for fold in b.folds:
        k = inside[np.argmin(np.abs(b.values[inside] - fold))]
        gaps = np.diff(b.alpha[k])
        j = int(np.argmin(gaps))
        xs.append(fold)
        ys.append(float(0.5 * (b.alpha[k, j] + b.alpha[k, j + 1])))
    return xs, ys
