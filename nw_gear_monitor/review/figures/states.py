"""States over time: one row of coloured bands per stage, one per other status."""

from __future__ import annotations

import math

from bokeh.models import ColumnDataSource, FactorRange, Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.rundata import ERROR, LEVEL_WORDS, OK, SILENT, WARN, RunData, Span

LEVEL_COLOURS = {OK: "#A8D8C2", WARN: style.ORANGE, ERROR: style.VERMILION, SILENT: "#6B7078"}
LEAST_VISIBLE = 0.003
"""Shortest band drawn, as a share of the run."""


def _source(run: RunData, rows: dict[str, tuple[Span, ...]], colours: list[str]) -> ColumnDataSource:
    shortest = LEAST_VISIBLE * run.duration
    spans = [(row, span) for row, own in rows.items() for span in own]
    return ColumnDataSource(
        {
            "row": [row for row, _ in spans],
            "left": [span.start - run.start for _, span in spans],
            "right": [max(span.end, span.start + shortest) - run.start for _, span in spans],
            "state": [span.state or LEVEL_WORDS.get(span.level, "") for _, span in spans],
            "level": [LEVEL_WORDS.get(span.level, str(span.level)) for _, span in spans],
            "reason": [span.reason for _, span in spans],
            "colour": colours,
        }
    )


def _bands(fig: figure, source: ColumnDataSource) -> None:
    bars = fig.hbar(
        y="row",
        left="left",
        right="right",
        height=0.72,
        source=source,
        fill_color="colour",
        line_color="white",
        line_width=0.5,
    )
    tips = [
        ("state", "@state"),
        ("level", "@level"),
        ("reason", "@reason"),
        ("from", "@left{0.0} s"),
        ("to", "@right{0.0} s"),
    ]
    style.hover(fig, [bars], tips)


def _key(fig: figure, row: str, colours: dict[str, str]) -> None:
    """A legend of squares that carry no data of their own; `row` is any row of the figure."""
    items = []
    for text, colour in colours.items():
        square = fig.scatter([math.nan], [row], marker="square", size=11, fill_color=colour, line_color="#9AA0A8")
        items.append((text, [square]))
    style.add_legend(fig, items)
    fig.legend[0].click_policy = "none"
    fig.legend[0].glyph_width = fig.legend[0].glyph_height = fig.legend[0].label_height = 18


def stages(run: RunData, time_range: Range1d) -> figure | None:
    """State label of each stage over time."""
    rows = {f"stage {s}": run.stage_spans(s) for s in run.stage_names}
    if not any(rows.values()):
        return None
    fig = style.time_figure(
        "State of each stage", "", time_range, height=200, y_range=FactorRange(*reversed(list(rows))), min_border_top=4
    )
    spans = [span for own in rows.values() for span in own]
    _bands(fig, _source(run, rows, [style.state_colour(span.state) for span in spans]))
    seen = sorted({span.state for span in spans if span.state}, key=names.STATES.index)
    _key(fig, next(iter(rows)), {state: style.state_colour(state) for state in seen})
    fig.ygrid.visible = False
    return fig


def levels(run: RunData, time_range: Range1d) -> figure | None:
    """Level of every diagnostic status over time."""
    rows = {
        name.split(": ", 1)[-1] if name.startswith("gear_monitor_node") else name: own
        for name, own in run.spans.items()
    }
    if not rows:
        return None
    height = 96 + 22 * len(rows)
    fig = style.time_figure(
        "Diagnostic level of every status", "", time_range, height=height, y_range=FactorRange(*reversed(list(rows)))
    )
    spans = [span for own in rows.values() for span in own]
    _bands(fig, _source(run, rows, [LEVEL_COLOURS.get(span.level, style.GREY) for span in spans]))
    seen = [level for level in sorted({s.level for s in spans}) if level in LEVEL_COLOURS]
    _key(fig, next(iter(rows)), {LEVEL_WORDS[level]: LEVEL_COLOURS[level] for level in seen})
    fig.ygrid.visible = False
    return fig
