"""State of each stage over time, as coloured bands."""

from __future__ import annotations

import math
from collections.abc import Sequence

from bokeh.models import ColumnDataSource, DataRange1d, FactorRange, Model

from nw_gear_common import names
from nw_gear_monitor.dashboard.feed import Feed
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.rundata import LEVEL_WORDS, Span

ROWS = tuple(f"stage {stage}" for stage in names.STAGES)
KEY = ("period-1", "period-2", names.QUASI_PERIODIC, names.CHAOTIC, names.TRANSIENT, names.STALE, names.UNKNOWN)


class StatesFigure:
    """One row of bands per stage; a machine with other stages gets other rows."""

    def __init__(self) -> None:
        self._source = ColumnDataSource(_columns([], 0.0))
        self._rows = FactorRange(*reversed(ROWS))
        span = DataRange1d(range_padding=0.0, default_span=60.0)
        fig = style.time_figure("State of each stage", "", span, height=190, y_range=self._rows, min_border_top=4)
        bars = fig.hbar(
            y="row",
            left="left",
            right="right",
            height=0.72,
            source=self._source,
            fill_color="colour",
            line_color="white",
            line_width=0.5,
        )
        style.hover(fig, [bars], [("state", "@state"), ("level", "@level"), ("reason", "@reason")])
        fig.ygrid.visible = False
        items = []
        for state in KEY:
            colour = style.state_colour(state)
            square = fig.scatter(
                [math.nan], [ROWS[0]], marker="square", size=11, fill_color=colour, line_color="#9AA0A8"
            )
            items.append(("period-n" if state == "period-2" else state, [square]))
        style.add_legend(fig, items)
        fig.legend[0].click_policy = "none"
        fig.legend[0].glyph_width = fig.legend[0].glyph_height = fig.legend[0].label_height = 18
        self._version = (-1, -1)
        self.roots: dict[str, Model] = {"states": fig}

    def update(self, feed: Feed) -> None:
        """Show the stretches that are known now."""
        with feed.lock:
            version = (feed.epoch, feed.states.version)
            if version == self._version:
                return
            self._version = version
            spans = [span for own in feed.states.spans.values() for span in own]
            stages = tuple(feed.states.spans) or ROWS
            origin = feed.origin
        rows = list(reversed(stages))
        if rows != self._rows.factors:
            self._rows.factors = rows
        self._source.data = _columns(spans, origin)


def _columns(spans: Sequence[Span], origin: float) -> dict[str, list[object]]:
    return {
        "row": [span.name for span in spans],
        "left": [span.start - origin for span in spans],
        "right": [span.end - origin for span in spans],
        "state": [span.state for span in spans],
        "level": [LEVEL_WORDS.get(span.level, str(span.level)) for span in spans],
        "reason": [span.reason for span in spans],
        "colour": [style.state_colour(span.state) for span in spans],
    }
