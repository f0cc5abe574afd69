"""The live page without a browser: what it is built from, and what is sent after news."""

import dataclasses
import time

import numpy as np
import pytest
from bokeh.document import Document
from bokeh.document.events import ColumnsStreamedEvent

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.quantities import quantities
from nw_gear_common.tables import Table
from nw_gear_monitor.dashboard import controls, text
from nw_gear_monitor.dashboard.buffers import Ring
from nw_gear_monitor.dashboard.digest import Digest, digest, settled
from nw_gear_monitor.dashboard.feed import Feed
from nw_gear_monitor.dashboard.figures.follow import Follower
from nw_gear_monitor.dashboard.page import UNANSWERED, Page, Show
from nw_gear_monitor.pipeline import Pipeline
from nw_gear_sim.params.faults import SEVERITIES, FaultSettings
from test.monitor.gear_signal import blocks, paper, waveform

HOSTILE = "<script>alert(1)</script>"


class Shown:
    """A page in a document, and what it asks for; building one takes a second, so that it is used again and again."""

    def __init__(self):
        self.feed, self.asked, self.digest, self.events = Feed(10.0, 3.0), [], Digest(), []
        self.document = Document()
        show = Show(self.feed, lambda: self.digest, self.asked.append, "live", "/nw_gear/waveform", 20.0, 3.0)
        self.page = Page(self.document, show)
        self.built = {name: self.get(name).text for name in ("banner", "states_text", "truth_text", "alarms_text")}
        self.document.on_change(self.events.append)

    def begin(self):
        """Nothing has come in yet."""
        feed = Feed(10.0, 3.0)
        feed.epoch = self.feed.epoch + 100
        self.feed, self.digest = feed, Digest()
        self.page._controls._refuse = lambda words, reason: feed.answer(words, False, reason)
        self.page._show = dataclasses.replace(self.page._show, feed=feed)
        self.update()
        self.asked.clear()
        self.events.clear()
        return self

    def get(self, name):
        return self.document.get_model_by_name(name)

    def answer(self):
        self.page._answer.data = {"n": [self.page._sent]}

    def update(self):
        self.answer()
        self.page._next_slow = 0.0
        self.page.update()


@pytest.fixture(scope="module")
def page():
    return Shown()


@pytest.fixture
def shown(page):
    return page.begin()


@pytest.fixture(scope="module")
def hops():
    pipeline = Pipeline(paper())
    return [hop for block in blocks(waveform(9.0), 999) for hop in pipeline.feed(block)]


def feed_all(feed, hops, seconds=9.0):
    for block in blocks(waveform(seconds)):
        feed.add_waveform(block, time.monotonic())
    for hop in hops:
        if hop.spectrum:
            feed.add_spectra(names.SPECTRUM, hop.spectrum)
            feed.add_spectra(names.ORDERS, hop.orders)
        for stage in names.STAGES:
            feed.add_section(stage, hop.sections[stage])
        for place, row in hop.indicators.items():
            feed.add_indicators(place, row)


def test_without_data_the_page_says_what_it_waits_for(page):
    assert len(page.document.to_json().content["roots"]) == len(page.document.roots)
    assert "waiting for /nw_gear/waveform" in page.built["banner"]
    assert page.built["banner"].count("not heard yet") == 3
    for part, words in (("states_text", "about a stage"), ("alarms_text", "about alarms"), ("truth_text", "truth")):
        assert words in page.built[part]
    assert page.get("Pause").disabled


def test_with_data_every_figure_shows_them_and_the_words_follow(shown, hops):
    feed_all(shown.feed, hops)
    shown.digest = digest(shown.feed, Digest())
    shown.update()
    empty = [
        (root.name, renderer.glyph.__class__.__name__)
        for root in shown.document.roots
        for renderer in getattr(root, "renderers", [])
        if renderer.data_source.data and not len(next(iter(renderer.data_source.data.values())))
    ]
    assert {name for name, _glyph in empty} <= {"wind", "speed", "torque", "states", "indicator_5", "indicator_6"}
    assert "live: 9.0 s since" in shown.get("banner").text
    line = shown.get("displacement_I").renderers[0]
    mine = waveform(9.0).column("x_I_1") * 1e6
    assert line.data_source.data["I_1"].max() == pytest.approx(mine.max(), rel=1e-6)
    assert line.data_source.data["I_1"].dtype == np.float32


def test_news_are_streamed_in_binary_and_the_browser_forgets_the_oldest():
    ring, follower = Ring(2, 10), Follower(("t", "y"), (2.0,), 6)
    document = Document()
    document.add_root(follower.source)
    follower.update(ring, 1, 0.0)
    events = []
    document.on_change(events.append)
    ring.add(np.array([[100.0, 1.0], [101.0, 2.0]]))
    follower.update(ring, 1, 100.0)
    assert isinstance(events[-1], ColumnsStreamedEvent)
    assert isinstance(events[-1].data["y"], np.ndarray)
    ring.add(np.column_stack([np.arange(102.0, 108.0), np.arange(3.0, 9.0)]))
    follower.update(ring, 1, 100.0)
    assert follower.source.data["t"].tolist() == [2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
    assert follower.source.data["y"].tolist() == [6.0, 8.0, 10.0, 12.0, 14.0, 16.0]
    count = len(events)
    follower.update(ring, 1, 100.0)
    assert len(events) == count
    ring.add(np.column_stack([np.arange(108.0, 130.0), np.zeros(22)]))  # more than is kept: everything is new
    follower.update(ring, 1, 100.0)
    assert follower.source.data["t"].tolist() == [24.0, 25.0, 26.0, 27.0, 28.0, 29.0]
    ring.clear()
    ring.add(np.array([[5.0, 1.0]]))
    follower.update(ring, 2, 5.0)
    assert follower.source.data["t"].tolist() == [0.0]


def test_a_browser_that_does_not_answer_gets_nothing_but_questions(shown):
    for block in blocks(waveform(1.0)):
        shown.feed.add_waveform(block, time.monotonic())
    shown.page._sent += UNANSWERED
    for _ in range(50):
        shown.page.update()
    assert not any(isinstance(event, ColumnsStreamedEvent) for event in shown.events)
    shown.update()
    source = shown.get("displacement_I").renderers[0].data_source
    seen = len(source.data["t"])
    assert seen > 0
    data = waveform(2.0)
    for block in blocks(data)[20:]:
        shown.feed.add_waveform(block, time.monotonic())
    for _ in range(UNANSWERED + 3):
        shown.page.update()
    assert shown.page.unanswered <= UNANSWERED + 1
    shown.update()
    assert source.data["t"][-1] == pytest.approx(2.0, abs=0.05)  # what was left out came in one piece
    assert np.all(np.diff(source.data["t"]) > 0.0)


def test_a_mesh_tone_stands_at_its_frequency_with_its_amplitude(hops):
    feed = Feed(10.0, 3.0)
    feed_all(feed, hops)
    found = digest(feed, Digest())
    rated = dict(zip(names.STAGES, paper().rated_frequency, strict=True))
    for stage in names.STAGES:
        at, text_, own = found.marks[stage][[mark[1] for mark in found.marks[stage]].index(f"f_{stage}")]
        assert own
        assert text_ == f"f_{stage}"
        assert at == pytest.approx(rated[stage], rel=1e-6)
        curve = found.curves[names.SPECTRUM, stage]
        mesh = names.MESHES_OF_STAGE[stage][0]
        newest = feed.spectra[names.SPECTRUM].table
        assert curve.amplitude[mesh].max() == pytest.approx(
            1e6 * newest.column(mesh)[newest.data[:, 0] <= 2000.0].max()
        )
        plane = found.planes[stage]
        assert set(plane.paths) == set(names.MESHES_OF_STAGE[stage])
        assert len(plane.points) > 10
    again = digest(feed, found)
    assert again.curves[names.SPECTRUM, "I"] is found.curves[names.SPECTRUM, "I"]
    feed.add_waveform(blocks(waveform(1.0))[0], 0.0)  # begins anew
    assert digest(feed, again).curves == {}


def test_axes_stay_while_the_picture_fits_and_is_not_lost_in_them():
    first = settled((-1.0, 1.0), None)
    assert settled((-0.9, 1.1), first) == first
    assert settled((-2.0, 1.0), first)[0] < -2.0
    assert settled((-0.1, 0.1), first)[1] < 0.2


def test_a_node_that_has_gone_is_stale_with_its_states_and_controls_and_comes_back(shown):
    now = time.monotonic()
    values = {"state": "period-1"}

    def say(at):
        shown.feed.add_waveform(blocks(waveform(1.0))[0], at)
        shown.feed.add_status("gear_monitor_node: stage I", 0, "period-1: fine", values, at)
        shown.feed.add_status("gear_sim_node: integration", 0, "integrating", {}, at)

    say(now - 60.0)
    shown.update()
    assert "stale: nothing on /nw_gear/waveform for 60 s" in shown.get("banner").text
    assert "gear_sim_node: stale for 60 s" in shown.get("banner").text
    assert "nothing from gear_monitor_node for 60 s" in shown.get("states_text").text
    assert "period-1" not in shown.get("states_text").text
    assert shown.get("Pause").disabled
    say(now)
    shown.update()
    assert "live: " in shown.get("banner").text
    assert "period-1" in shown.get("states_text").text
    assert not shown.get("Pause").disabled


def test_what_nodes_say_is_text_and_never_code():
    feed = Feed(10.0, 3.0)
    feed.add_status(f"node{HOSTILE}: stage {HOSTILE}", 1, HOSTILE, {"state": HOSTILE}, 0.0)
    feed.add_status("gear_monitor_node: alarms", 1, HOSTILE, {HOSTILE: HOSTILE}, 0.0)
    feed.add_truth(HOSTILE, {HOSTILE: HOSTILE}, 0.0)
    feed.answer(HOSTILE, False, HOSTILE)
    feed.refused = HOSTILE
    pages = [
        text.banner(feed, HOSTILE, 0.0),
        text.states(feed, 0.0),
        text.alarms(feed, 0.0),
        text.truth(feed, 0.0, 3.0),
        text.answers(feed),
    ]
    for page in pages:
        assert "<script" not in page
        assert "&lt;script" in page


def test_truth_and_answers_are_told():
    feed = Feed(10.0, 3.0)
    shares = {f"open fraction {mesh} (1)": "0.25" for mesh in names.MESHES}
    feed.add_truth("cracked tooth", {"fault cracked tooth": "sun, 3", **shares}, 0.0)
    page = text.truth(feed, 1.0, 3.0)
    assert "sun, 3" in page
    assert page.count("0.250") == 7
    assert "stale" not in page
    assert "stale, 9 s old" in text.truth(feed, 9.0, 3.0)
    feed.answer("gear_sim_node: this", False, "refused: parameter: expected 0 to 39, got 1000")
    assert 'class="refused"' in text.answers(feed)
    assert "expected 0 to 39" in text.answers(feed)


@pytest.mark.parametrize("kind", list(SEVERITIES))
def test_every_fault_can_be_asked_for_in_the_units_of_the_page(kind):
    fields = controls.fields_of(kind)
    shown = {field.name: field.shown for field in fields} | {"fault_ramp": 2.0}
    request = controls.inject(kind, shown)
    asked = dataclasses.replace(FaultSettings(), **request.parameters)
    assert any(getattr(asked, name) != 0.0 for name in SEVERITIES[kind])
    units = {name: description.unit for name, _kind, _default, description in quantities(FaultSettings)}
    for field in fields:
        if units[field.name] == "m":
            assert "µm" in field.label
            assert request.parameters[field.name] == pytest.approx(1e-6 * field.shown)
    over = controls.heal(kind, 1.0)
    assert all(over.parameters[name] == 0.0 for name in SEVERITIES[kind])
    assert request.node == over.node == "gear_sim_node"


def test_buttons_ask_the_nodes_and_what_is_wrong_never_leaves_the_page(shown):
    press = lambda name: shown.get(name)._event_callbacks["button_click"][0]()  # noqa: E731
    press("Pause")
    assert (shown.asked[-1].node, shown.asked[-1].service, shown.asked[-1].flag) == ("gear_sim_node", "pause", True)
    press("Inject fault")
    assert shown.asked[-1].parameters["fault_crack"] == 0.5
    press("Set wind speed")
    assert shown.asked[-1].parameters == {"speed": 11.5}
    shown.get("fault_crack").value = None
    count = len(shown.asked)
    press("Inject fault")
    assert len(shown.asked) == count
    assert "Loss of stiffness" in shown.feed.answers[-1].text
    with pytest.raises(InputError):
        controls.set_pace(None)


def test_a_widget_follows_its_parameter_and_else_keeps_what_was_typed(shown):
    shown.feed.add_parameters("wind_node", {"source": "constant", "speed": 8.0})
    shown.update()
    speed = shown.page._controls._speed
    assert (shown.page._controls._source.value, speed.value) == ("constant", 8.0)
    speed.value = 9.5
    shown.update()
    assert speed.value == 9.5
    shown.feed.add_parameters("wind_node", {"speed": 12.0})
    shown.update()
    assert speed.value == 12.0


def test_a_foreign_waveform_is_named_and_indicators_can_be_chosen(shown, hops):
    shown.feed.add_waveform(Table("sample", ("time", "x_1"), np.array([[0.0, 1.0], [0.1, 1.0]])), time.monotonic())
    shown.update()
    assert "is of another machine (no column phase_I)" in shown.get("banner").text
    shown.get("choice_1").value = "kurtosis"
    figure = shown.get("indicator_1")
    assert {line.glyph.y for line in figure.renderers} == {"kurtosis"}
    assert figure.title.text == "Meshes: Kurtosis (no value yet)"
