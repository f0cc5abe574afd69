"""One browser's page: built without data, then told at each update what is new since the one before."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from bokeh.document import Document
from bokeh.models import ColumnDataSource, CustomJS, Div, InlineStyleSheet, Model

from nw_gear_common import names
from nw_gear_monitor.dashboard import text
from nw_gear_monitor.dashboard.controls import Request
from nw_gear_monitor.dashboard.digest import Digest
from nw_gear_monitor.dashboard.feed import Feed
from nw_gear_monitor.dashboard.figures.indicators import IndicatorsPanel
from nw_gear_monitor.dashboard.figures.planes import PlanesPanel
from nw_gear_monitor.dashboard.figures.scrolling import Operation, Scrolling
from nw_gear_monitor.dashboard.figures.spectra import SpectraPanel
from nw_gear_monitor.dashboard.figures.states import StatesFigure
from nw_gear_monitor.dashboard.panel import Controls
from nw_gear_monitor.dashboard.template import STYLE, WATCH, page_template

SLOW = 0.5
"""Seconds between two updates of text, states and indicators."""
KNOCK = 0.25
"""Seconds between two questions to a browser that doesn't answer."""
UNANSWERED = 4
"""Updates that may be under way to a browser; one that is slower gets fewer, and then everything that is new."""
ANSWER = """
const n = cb_obj.data.n;
window.lastPulse = Date.now();
// answered once it is painted: never in a tab that nobody sees
requestAnimationFrame(() => setTimeout(() => { answer.data = {n}; }, 0));
"""


@dataclass(frozen=True)
class Show:
    """What pages show and ask through.

    Attributes:
        feed: what came in.
        digest: returns the newest pictures that took computing.
        ask: hands a request on to a node.
        title: of the page.
        topic: full name of the waveform's topic.
        rate: updates per second.
        stale_after: s.
    """

    feed: Feed
    digest: Callable[[], Digest]
    ask: Callable[[Request], None]
    title: str
    topic: str
    rate: float
    stale_after: float


class Page:
    """Everything on one browser's page.

    Args:
        document: to build the page in.
        show: what it shows.
    """

    def __init__(self, document: Document, show: Show) -> None:
        self._show = show
        self._scrolling = Scrolling(show.feed.history)
        self._operation = Operation(self._scrolling.shared)
        self._spectra, self._planes = SpectraPanel(), PlanesPanel()
        self._indicators, self._states = IndicatorsPanel(), StatesFigure()
        self._controls = Controls(show.ask, lambda words, reason: show.feed.answer(words, False, reason))
        style = InlineStyleSheet(css=text.CSS)
        parts = ("banner", "states_text", "truth_text", "alarms_text")
        self._texts = {name: Div(text="", stylesheets=[style], sizing_mode="stretch_width") for name in parts}
        self._pulse, self._answer = ColumnDataSource({"n": [0]}), ColumnDataSource({"n": [0]})
        self._pulse.js_on_change("data", CustomJS(args={"answer": self._answer}, code=ANSWER))
        self._texts["banner"].tags = [self._pulse]
        self._sent = UNANSWERED  # nothing is sent before the browser has answered once
        self._next_slow = self._next_knock = 0.0
        self._build(document)

    def _build(self, document: Document) -> None:
        document.title = self._show.title
        document.template = page_template()
        document.template_variables.update(page_style=STYLE, watch=WATCH, stages=names.STAGES)
        panels = (
            self._scrolling,
            self._operation,
            self._spectra,
            self._planes,
            self._indicators,
            self._states,
            self._controls,
        )
        roots: dict[str, Model] = dict(self._texts)
        for panel in panels:
            roots |= panel.roots
        with document.models.freeze():  # else Bokeh looks through all models again for each root
            for name, root in roots.items():
                root.name = name
                document.add_root(root)
        self._slow(time.monotonic())
        document.add_periodic_callback(self.update, round(1e3 / self._show.rate))

    @property
    def unanswered(self) -> int:
        """Updates that the browser hasn't answered yet."""
        return self._sent - int(self._answer.data["n"][0])

    def update(self) -> None:
        """Send what is new; nothing while the browser is still busy with what it got."""
        now = time.monotonic()
        if self.unanswered >= UNANSWERED:
            self._knock(now)
            return
        self._scrolling.update(self._show.feed)
        self._operation.update(self._show.feed)
        if now >= self._next_slow:
            self._next_slow = now + SLOW
            self._slow(now)
        self._beat()

    def _knock(self, now: float) -> None:
        """Ask a browser that doesn't answer whether it is there: what was sent before it was connected got lost."""
        if now >= self._next_knock:
            self._next_knock = now + KNOCK
            self._beat()

    def _beat(self) -> None:
        self._sent += 1
        self._pulse.data = {"n": [self._sent]}

    def _slow(self, now: float) -> None:
        show, feed = self._show, self._show.feed
        digest = show.digest()
        self._spectra.update(digest)
        self._planes.update(digest)
        self._indicators.update(feed)
        self._states.update(feed)
        self._controls.update(feed, now)
        words = {
            "banner": text.banner(feed, show.topic, now),
            "states_text": text.states(feed, now),
            "truth_text": text.truth(feed, now, show.stale_after),
            "alarms_text": text.alarms(feed, now),
        }
        for name, html in words.items():
            if self._texts[name].text != html:
                self._texts[name].text = html
