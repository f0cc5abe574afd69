"""Two runs on one page: both named, on the same axes, and what differs in numbers."""

import dataclasses
import re

import numpy as np
import pytest
from bokeh.models import Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_monitor.review import compared, comparison
from test.monitor import synthetic
from test.monitor.browser import look
from test.monitor.test_review_gather import gathered
from test.monitor.test_review_page import Page

LABELS = ("before", "after")
SECONDS = (4, 5)


@pytest.fixture(scope="module")
def runs():
    first = gathered(synthetic.stream(SECONDS[0]), SECONDS[0], 0.0)
    items = []
    for topic, at, payload in synthetic.stream(SECONDS[1]):
        if topic == names.WAVEFORM:  # stage II vibrates twice as much
            for mesh in names.MESHES_OF_STAGE["II"]:
                x = payload.column(f"x_{mesh}")
                x += x - synthetic.OFFSET["II"]
        if topic == names.indicators_topic("II_1"):
            payload.data[:, payload.index("rms")] *= 2.0
        items.append((topic, at, payload))
    return first, gathered(items, SECONDS[1], 0.0)


@pytest.fixture(scope="module")
def html(runs):
    return comparison.render(*runs, LABELS)


@pytest.mark.slow
def test_both_runs_are_named_everywhere(html):
    page = Page(html)
    assert page.titles == ["before beside after"]
    assert "before: Worst state: chaotic" in page.words
    assert "after: Worst state: chaotic" in page.words
    drawn = re.sub(r"\\+u00b7", "·", html)  # as JSON in a string of JavaScript writes it
    for title in ("Wind speed at the rotor", "Stage II: meshing displacement", "Stage I: phase diagram"):
        for label in LABELS:
            assert f"{label} · {title}" in drawn, (label, title)


def test_the_change_is_told_in_numbers(runs):
    table = compared.stages(runs, LABELS)
    rows = {(row[0], row[1]): row for row in table.rows}
    assert rows["II", "before"][4] == ""
    assert rows["II", "after"][4] == "+100.0 %"
    assert rows["II", "after"][6] == "+100.0 %"
    assert float(rows["II", "after"][5]) == pytest.approx(4e6 * synthetic.AMPLITUDE["II"], abs=0.06)
    assert rows["III", "after"][4] == "+0.0 %"


def test_indicators_that_differ_come_first(runs):
    noisy = []
    for k, run in enumerate(runs):
        changed = dict(run.indicators)
        for i, mesh in enumerate(names.MESHES):
            table = changed[mesh]
            data = table.data.copy()
            data[:, table.index("rms")] *= 1.0 + 0.01 * np.random.default_rng(10 * k + i).normal(size=len(data))
            changed[mesh] = dataclasses.replace(table, data=data)
        noisy.append(dataclasses.replace(run, indicators=changed))
    found = compared.differing(tuple(noisy))
    assert (found[0].mesh, found[0].column) == ("II_1", "rms")
    assert found[0].means[1] == pytest.approx(2.0 * found[0].means[0], rel=0.02)
    assert found[0].far > 10.0 * found[1].far


def ranges(section):
    return [(fig.title.text, fig.x_range, fig.y_range) for fig in section.figures.values()]


def test_pairs_share_their_axes(runs):
    for section in comparison.build(runs, LABELS):
        if section.anchor in ("summary", "states", "alarms"):
            continue
        found = ranges(section)
        assert found, section.anchor
        for (left, x1, y1), (right, x2, y2) in zip(found[::2], found[1::2], strict=True):
            assert left.startswith("before · ")
            assert right.startswith("after · ")
            assert left.removeprefix("before · ").split(",")[0] == right.removeprefix("after · ").split(",")[0]
            assert x1 is x2, left
            assert y1 is y2, left


def test_shared_axes_hold_what_both_need():
    figures = [figure(x_range=Range1d(0, 1), y_range=Range1d(low, high)) for low, high in ((-1.0, 2.0), (0.5, 7.0))]
    figures[1].x_range = Range1d(-3, 0.5)
    comparison.share(figures)
    assert (figures[1].y_range.start, figures[1].y_range.end) == (-1.0, 7.0)
    assert (figures[0].x_range.start, figures[0].x_range.end) == (-3, 1)


@pytest.mark.slow
def test_a_run_without_a_monitor_can_stand_beside_one_with(runs):
    bare = gathered(synthetic.stream(2, monitor=False), 2, 0.0)
    words = Page(comparison.render(runs[0], bare, ("same", "same"))).words
    assert "same (2) has nothing to set beside some of the figures." in words
    assert "same (2): No monitor was recorded" in words


@pytest.mark.slow
def test_the_browser_draws_both_without_complaint(html, tmp_path):
    file = tmp_path / "comparison.html"
    file.write_text(html, encoding="utf-8")
    found, console = look(file, tmp_path)
    assert console == []
    assert found["loads"] == []
    assert not found["wide"]
    assert len(found["figures"]) >= 40
    for one in found["figures"]:
        assert one["colours"] > 5, one
