"""The page in real Chromium, over the real nodes: data move, controls act, refusals are told, who goes comes back."""

from urllib.parse import urlsplit

import pytest

from test.system.chromium import Chromium, chromium_or_reason
from test.system.live_suite import live_suite
from test.system.processes import running

LIMIT = 180.0
NEWEST = "model('displacement_I').renderers[0].data_source.data.t.at(-1)"
KNOWN = "could not set initial ranges"
"""Bokeh's warning about a figure that has no data yet."""


def newest(browser):
    browser.wait_for(f"{NEWEST} > 0", LIMIT)
    return browser.read(NEWEST)


def drawn(browser):
    """How many figures have more than one colour on their canvas."""
    return browser.read(
        """deep(document).filter(e => e.tagName === "CANVAS" && e.width > 100 && e.height > 100).filter(c => {
             const pixels = c.getContext("2d").getImageData(0, 0, c.width, c.height).data;
             const colours = new Set();
             for (let i = 0; i < pixels.length; i += 4)
               if (pixels[i + 3]) colours.add(pixels[i] + 256 * pixels[i + 1] + 65536 * pixels[i + 2]);
             return colours.size > 3;
           }).length"""
    )


@pytest.fixture(scope="module")
def page():
    """The suite with its page open in a browser, at simulated time."""
    if chromium_or_reason():
        pytest.skip(chromium_or_reason())
    suite = live_suite(
        wind=["source:=constant", "speed:=11.5"],
        simulator=["publish_clock:=true"],
        dashboard=["update_rate:=10.0", "history:=10.0"],
    )
    with suite as running_suite, Chromium((1200, 900)) as browser:
        browser.open(running_suite.url)
        browser.wait_for("words().includes('live: ')", LIMIT, running_suite.report)
        yield running_suite, browser


@pytest.mark.slow
def test_the_page_lives(page):
    suite, browser = page
    data_move_and_every_figure_is_drawn(browser)
    a_fault_is_injected_and_seen(browser, suite)
    what_a_node_refuses_is_told_with_its_reason(browser)
    speed_wind_and_pause_are_those_of_the_nodes(browser)
    a_node_that_goes_is_stale_and_comes_back(browser, suite)
    assert [line for line in browser.complaints if KNOWN not in line] == []
    hosts = {urlsplit(url).netloc for url in browser.requested if not url.startswith("data:")}
    assert hosts == {urlsplit(suite.url).netloc}
    suite.processes["dashboard_node"].interrupt()
    assert suite.processes["dashboard_node"].wait() == 0
    browser.wait_for("document.getElementById('lost').offsetHeight > 0", LIMIT)


def data_move_and_every_figure_is_drawn(browser):
    first = newest(browser)
    browser.wait_for(f"{NEWEST} > {first} + 1", LIMIT)
    browser.wait_for("model('spectrum_III').renderers.some(r => r.data_source.data.axis?.length > 100)", LIMIT)
    browser.wait_for("words().includes('period-1')", LIMIT)
    assert drawn(browser) >= 15


def a_fault_is_injected_and_seen(browser, suite):
    assert browser.read("words().includes('no fault injected')")
    browser.enter("Gear", "pinion")
    browser.enter("Loss of stiffness (1)", 0.9)
    browser.press("Inject fault")
    browser.wait_for("/inject cracked tooth \\(pinion[^]*?accepted/.test(words())", LIMIT, suite.report)
    browser.wait_for("words().includes('fault cracked tooth')", LIMIT, suite.report)
    # the tooth passes the mesh of stage III once a turn: lines between those of the mesh, which the monitor tells
    browser.wait_for(
        """(() => {
             const d = model('states').renderers[0].data_source.data;
             return d.row.some((r, i) => r === 'stage III' && !['period-1', 'unknown'].includes(d.state[i]));
           })()""",
        LIMIT,
        suite.report,
    )


def what_a_node_refuses_is_told_with_its_reason(browser):
    browser.enter("Tooth", 1000)
    browser.press("Inject fault")
    browser.wait_for("words().includes('refused: fault_crack_tooth')", LIMIT)


def speed_wind_and_pause_are_those_of_the_nodes(browser):
    browser.enter("Speed (× real time, 0 = fastest)", 0.5)
    browser.press("Set speed")
    browser.wait_for("/real_time_factor = 0.5[^]*?accepted/.test(words())", LIMIT)
    browser.enter("Wind speed (m/s, constant)", 9)
    browser.press("Set wind speed")
    browser.wait_for("Math.abs(model('wind').renderers[0].data_source.data.wind.at(-1) - 9) < 0.01", LIMIT)
    browser.press("Pause")
    browser.wait_for("words().includes('gear_sim_node: paused')", LIMIT)
    browser.press("Go on")
    browser.wait_for("words().includes('gear_sim_node: integrating')", LIMIT)


def a_node_that_goes_is_stale_and_comes_back(browser, suite):
    suite.processes["wind_node"].interrupt()
    assert suite.processes["wind_node"].wait() == 0
    browser.wait_for("words().includes('wind_node: stale')", LIMIT)
    browser.wait_for("named('Set wind speed').disabled", LIMIT)
    with running("wind_node", ["source:=constant", "use_sim_time:=true"]):
        browser.wait_for("words().includes('wind_node: live')", LIMIT)
        browser.wait_for("!named('Set wind speed').disabled", LIMIT)
