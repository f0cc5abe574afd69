"""What the page does when someone zooms or chooses, in a real browser, against the closed form of the made-up run."""

import math
import re

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_common.wavelets import wavelet_map
from nw_gear_monitor.review import windows
from nw_gear_monitor.review.decimate import Envelope, Stretches
from nw_gear_monitor.review.page import render
from nw_gear_monitor.review.read import read
from test.monitor import recorded, synthetic
from test.monitor.browser import look

SECONDS = 14
BEGIN = 5.0
"""Where the test zooms in."""
PROBE = """
<script>
const pause = ms => new Promise(done => setTimeout(done, ms));
async function play() {
  while (!(window.Bokeh && Bokeh.documents.length && Bokeh.documents.every(d => d.is_idle))) await pause(100);
  const named = name => Bokeh.documents[0].get_model_by_name(name);
  const plain = (source, columns) => Object.fromEntries(columns.map(c => [c, Array.from(source.data[c])]));
  const found = {whole: named("envelope").data.t.length};
  named("time").setv({start: BEGIN, end: BEGIN + 0.1});
  await pause(300);
  found.exact = plain(named("samples"), ["t", "II_1", "III"]);
  found.forces = plain(named("F_samples"), ["t", "F_sb"]);
  named("time").setv({start: 8, end: 10});
  await pause(300);
  found.fine = plain(named("envelope"), ["t", "low_I_1", "high_I_1"]);
  named("time").setv({start: 0, end: 13});
  await pause(300);
  found.nothing = named("samples").data.t.length;
  named("pick").value = named("pick").options[0];
  await pause(300);
  found.chosen = plain(named("chosen"), ["t", "II_2"]);
  found.path = plain(named("path_II_2"), ["x", "v"]);
  named("when").value = [3, 5];
  await pause(300);
  found.points = plain(named("points_II_2"), ["x", "v"]);
  found.options = named("pick").options;
  const pre = document.createElement("pre");
  pre.id = "probe";
  pre.textContent = JSON.stringify(found);
  document.body.appendChild(pre);
}
window.addEventListener("load", play);
</script>
""".replace("BEGIN", str(BEGIN))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("zoom") / "recording"
    recorded.write(folder, synthetic.stream(SECONDS))
    return folder


@pytest.fixture(scope="module")
def run(folder):
    return read(folder, lambda _words: None, [(BEGIN - 0.5, BEGIN + 0.5)])


@pytest.fixture(scope="module")
def played(run, tmp_path_factory):
    folder = tmp_path_factory.mktemp("browser")
    file = folder / "report.html"
    file.write_text(render(run), encoding="utf-8")
    found, console = look(file, folder, probe=PROBE)
    assert console == []
    return found


def expected(mesh, time):
    x, v = synthetic.displacement(mesh, np.array(time))
    return 1e6 * x, 1e3 * v


@pytest.mark.slow
def test_zooming_in_shows_every_sample_of_a_stretch(played):
    exact = played["exact"]
    assert len(exact["t"]) == pytest.approx(0.1 * synthetic.RATE, abs=2)
    assert min(exact["t"]) >= BEGIN
    for mesh in ("II_1", "III"):
        assert exact[mesh] == pytest.approx(expected(mesh, exact["t"])[0], abs=2e-3)
    t = np.array(played["forces"]["t"])
    radial = np.hypot(9.0 + 0.2 * np.sin(50.0 * t), 12.0)  # the third of the bearings of `synthetic`
    assert played["forces"]["F_sb"] == pytest.approx(radial, abs=1e-3)


@pytest.mark.slow
def test_zooming_in_refines_the_envelope_and_keeps_its_extremes(played):
    fine = played["fine"]
    assert min(fine["t"]) >= 7.99
    assert max(fine["t"]) <= 10.01
    assert len(fine["t"]) > 4 * played["whole"] * 2.0 / SECONDS
    top, bottom = (1e6 * (synthetic.OFFSET["I"] + s * synthetic.AMPLITUDE["I"]) for s in (1, -1))
    assert max(fine["high_I_1"]) == pytest.approx(top, abs=2e-3)
    assert min(fine["low_I_1"]) == pytest.approx(bottom, abs=2e-3)
    assert played["nothing"] == 0  # too many to be drawn


@pytest.mark.slow
def test_another_stretch_is_shown_where_one_is_chosen(played):
    assert played["options"][0].startswith(f"1. {BEGIN - 0.5:g} to {BEGIN + 0.5:g} s")
    chosen = played["chosen"]
    assert chosen["t"][0] == pytest.approx(BEGIN - 0.5, abs=1e-3)
    assert chosen["t"][-1] == pytest.approx(BEGIN + 0.5, abs=1e-3)
    assert chosen["II_2"] == pytest.approx(expected("II_2", chosen["t"])[0], abs=0.03)


@pytest.mark.slow
def test_the_phase_diagram_follows_the_stretch(played):
    amplitude = 1e6 * synthetic.AMPLITUDE["II"]
    speed = 1e-3 * amplitude * 2.0 * math.pi * synthetic.FREQUENCY["II"]
    radius = np.hypot(np.array(played["path"]["x"]) / amplitude, np.array(played["path"]["v"]) / speed)
    assert len(radius) >= 20 * 50 - 1
    assert radius == pytest.approx(np.ones(len(radius)), abs=0.02)


@pytest.mark.slow
def test_the_section_follows_its_time(played):
    assert len(played["points"]["x"]) == pytest.approx(2.0 * synthetic.FREQUENCY["II"], abs=2)
    # once per mesh cycle, at one phase: one point, up to the slow mean that is taken out
    assert np.ptp(played["points"]["x"]) < 0.1
    assert np.ptp(played["points"]["v"]) < 1e-3


def test_stretches_that_are_worth_a_look_are_found(tmp_path):
    items = []
    for topic, at, payload in synthetic.stream(8, monitor=False):
        if topic == "waveform" and 3.0 <= at - 0.05 < 3.2:
            payload.data[:, payload.index("x_II_3")] *= 1.3
        items.append((topic, at, payload))
    recorded.write(tmp_path / "recording", items)
    run = read(tmp_path / "recording", lambda _words: None)
    event = next(w for w in run.windows if re.search(r"stage II\b", w.title))
    time = event.samples.column("time")
    assert time[0] < 3.0 - 0.2
    assert time[-1] > 3.2 + 0.2
    assert event.samples.column("x_II_3").max() == run.waveform.highest["II_3"]
    assert np.diff(time) == pytest.approx(np.full(len(time) - 1, 1.0 / synthetic.RATE), rel=1e-6)


@pytest.mark.parametrize("wrong", [(20.0, 21.0), (0.0, 60.0)])
def test_a_stretch_that_cant_be_shown_is_refused(folder, wrong, monkeypatch):
    monkeypatch.setattr(windows, "MOST_ROWS", 40_000)
    with pytest.raises(InputError, match="--zoom"):
        read(folder, lambda _words: None, [wrong])


def test_the_wavelet_map_of_a_stretch_has_its_ridge_at_the_mesh_frequency(run):
    window = run.windows[0].samples
    x = window.column("x_III") - window.column("x_III").mean()
    found = wavelet_map(x, run.waveform.rate, low=50.0, high=2000.0)
    ridge = found.frequency[np.argmax(found.amplitude[:, 100:500], axis=0)]
    assert ridge == pytest.approx(np.full(400, synthetic.FREQUENCY["III"]), rel=0.03)


def test_extremes_of_the_envelope_are_those_of_the_data_at_every_width():
    rng = np.random.default_rng(11)
    time = np.sort(rng.uniform(0.0, 40.0, 20_000))
    values = rng.standard_t(2, size=(20_000, 3))
    envelope = Envelope(("a", "b", "c"), bins=1024)
    for part in np.array_split(np.arange(20_000), 37):
        envelope.add(time[part], values[part])
    band = envelope.result()
    for bins in (1024, 100, 7, 1):
        coarse = band.coarser(bins)
        assert len(coarse.time) <= bins + 1
        assert np.array_equal(coarse.low.min(axis=0), values.min(axis=0))
        assert np.array_equal(coarse.high.max(axis=0), values.max(axis=0))
        inside = np.abs(time - coarse.time[0]) < 0.5 * coarse.width - 1e-9
        assert np.array_equal(coarse.high[0] >= values[inside].max(axis=0), [True] * 3)


def test_columns_chosen_from_a_wider_table_give_the_same_envelope():
    rng = np.random.default_rng(12)
    time, data = np.arange(5000) / 512.0, rng.normal(size=(5000, 9))
    data[40, 5] = np.nan
    whole, chosen = Envelope(("a", "b"), bins=64), Envelope(("a", "b"), bins=64)
    whole.add(time, data[:, [5, 2]])
    chosen.add(time, data, np.array([5, 2]))
    one, other = whole.result(), chosen.result()
    assert np.array_equal(one.low, other.low)
    assert np.array_equal(one.mean, other.mean)
    kept = np.delete(data[:, [5, 2]], 40, axis=0)
    assert np.array_equal(one.high.max(axis=0), kept.max(axis=0))


def test_stretches_keep_neighbours_together_and_the_end():
    kept = Stretches(rows=500, seconds=2.0)
    blocks = [np.column_stack([np.arange(k, k + 1, 0.05), np.full(20, k)]) for k in range(100)]
    for block in blocks:
        kept.add(block)
    rows = kept.result()
    assert np.all(np.diff(rows[:, 0]) > 0.0)
    assert len(rows) <= 500 + 60
    assert rows[-1, 0] == blocks[-1][-1, 0]
    assert np.sum(rows[:, 0] >= rows[-1, 0] - 2.0) == 41
    for number in np.unique(rows[:, 1])[:-3]:
        assert np.array_equal(rows[rows[:, 1] == number], blocks[int(number)])
    assert len(np.unique(np.round(rows[:, 0] // 25))) == 4  # from all quarters of the run
