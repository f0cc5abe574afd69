"""The page: self-contained, complete, and drawn without complaints by a real browser."""

import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

from nw_gear_common import names
from nw_gear_monitor.review.gather import Gatherer
from nw_gear_monitor.review.page import render
from test.monitor import synthetic
from test.monitor.browser import look
from test.monitor.test_review_gather import feed

SECONDS = 8
WIDGETS = 4
"""The choice of a stretch, two sliders of the phase diagrams, the time of the sections: they have no canvas."""
ANCHORS = (
    "summary",
    "wind-and-load",
    "states",
    "displacement",
    "forces",
    "spectra",
    "waterfall",
    "phase",
    "indicators",
    "alarms",
    "truth",
    "provenance",
)


def gathered(items, provenance=None, complete=True):
    gatherer = Gatherer()
    feed(gatherer, items)
    topics = {"/nw_gear/waveform": ("std_msgs/msg/Float64MultiArray", 20 * SECONDS)}
    chosen = synthetic.PROVENANCE if provenance is None else provenance
    return gatherer.result(Path("2030-01-01/recording"), complete, (0.0, float(SECONDS)), topics, chosen)


class Page(HTMLParser):
    """Collects what a page would load, its anchors, links and text outside of scripts."""

    def __init__(self, text):
        super().__init__()
        self.loads, self.anchors, self.links, self.text, self.titles = [], set(), [], [], []
        self._inside = ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        if tag in ("script", "img", "iframe", "source", "link", "object", "embed"):
            self.loads += [v for key in ("src", "href", "data", "srcset") if (v := values.get(key))]
        if "id" in values:
            self.anchors.add(values["id"])
        if tag == "a":
            self.links.append(values["href"])
        self._inside = tag

    def handle_endtag(self, tag):
        self._inside = ""

    def handle_data(self, data):
        if self._inside == "title":
            self.titles.append(data)
        elif self._inside not in ("script", "style"):
            self.text.append(data)

    @property
    def words(self):
        return re.sub(r"\s+", " ", " ".join(self.text))


@pytest.fixture(scope="module")
def html():
    return render(gathered(synthetic.stream(SECONDS)))


@pytest.fixture(scope="module")
def page(html):
    return Page(html)


def test_page_loads_nothing(html, page):
    assert [load for load in page.loads if not load.startswith("data:")] == []
    style = "".join(re.findall(r"<style>(.*?)</style>", html, re.DOTALL))
    assert "url(" not in style
    assert "@import" not in style


def test_every_section_is_there_and_reachable(page):
    assert set(ANCHORS) <= page.anchors
    assert {f"#{anchor}" for anchor in ANCHORS} <= set(page.links)
    assert page.titles == ["Gearbox run 2030-01-01"]


def test_summary_shows_the_numbers_of_the_run(page):
    for words in (
        "17.30 r/min",
        "2.700 MN m",
        "4.891 MW",
        "26.2 Hz",
        "99.0 Hz",
        "324.2 Hz",
        "weibull, seed 7",
        "chaotic 29 %",
        "unexplained variance 0.31",
        f"{SECONDS * 5120} at 5120 Hz, no gaps",
        "nw_gear demo --duration 10",
        "excitation kinematic",
        "II_2 30.00 0.00",
    ):
        assert words in page.words, words


def test_configuration_of_the_run_is_on_the_page(page):
    assert "resolved_config: gear: teeth: 91" in page.words


def test_size_stays_small(html):
    assert len(html) < 15e6


def test_missing_data_are_said_in_words():
    items = [item for item in synthetic.stream(2, monitor=False) if item[0] in (names.WIND_SPEED, names.SHAFTS_TOPIC)]
    words = Page(render(gathered(items, provenance={}))).words
    for sentence in (
        "No monitor was recorded",
        "The waveform was not recorded.",
        "Mesh forces were not recorded.",
        "No diagnostics were recorded.",
        "No truth was recorded",
        "The recording carries no provenance.",
    ):
        assert sentence in words, sentence


def test_an_empty_recording_still_gives_a_page():
    page = Page(render(gathered([], provenance={})))
    assert set(ANCHORS) <= page.anchors
    assert "The wind speed was not recorded." in page.words


def test_standstill_is_said_in_words():
    still = [(topic, at, payload) for topic, at, payload in synthetic.stream(2, monitor=False)]
    for topic, _at, payload in still:
        if topic == names.WAVEFORM:
            payload.data[:, 1:] = payload.data[0, 1:]
    still += [(names.DIAGNOSTICS, 2.0, synthetic.diagnostics(2.0, {"II": (0, names.UNKNOWN, "not turning")}))]
    words = Page(render(gathered(still))).words
    assert "The gearbox stood still: there is no state to tell." in words
    assert "there are no mesh cycles to show" in words


def test_a_run_of_one_block_still_gives_a_page():
    first = next(item for item in synthetic.stream(1) if item[0] == names.WAVEFORM)
    page = Page(render(gathered([first], provenance={})))
    assert set(ANCHORS) <= page.anchors
    assert "256 at 5120 Hz" in page.words


def test_a_damaged_recording_is_called_damaged():
    words = Page(render(gathered(synthetic.stream(1), complete=False))).words
    assert "damaged, read through a repaired copy" in words


def test_text_from_a_recording_is_never_markup():
    evil = "</pre><script>alert(1)</script>"
    items = [*synthetic.stream(2), (names.DIAGNOSTICS, 3.0, synthetic.diagnostics(3.0, {"I": (2, "period-1", evil)}))]
    html = render(gathered(items, provenance={"nw_gear.run": {"command_line": evil}, evil: {evil: evil}}))
    assert "<script>alert(1)" not in html


@pytest.fixture(scope="module")
def seen(html, tmp_path_factory):
    folder = tmp_path_factory.mktemp("browser")
    file = folder / "report.html"
    file.write_text(html, encoding="utf-8")
    return look(file, folder)


def test_browser_draws_every_figure_without_complaint(seen):
    found, console = seen
    assert console == []
    assert len(found["figures"]) >= 30
    widgets = [figure for figure in found["figures"] if figure["height"] == 0]
    assert len(widgets) == WIDGETS
    for figure in (figure for figure in found["figures"] if figure["height"]):
        assert figure["colours"] > 5, figure
        assert figure["height"] > 150, figure
    assert found["loads"] == []
    assert not found["wide"]
