"""What is gathered from a made-up run, and what the summary says of it, against the run's closed form."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
from bokeh.models import Range1d

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.indicators import bearing_registry
from nw_gear_monitor.review import summary
from nw_gear_monitor.review.figures import indicators
from nw_gear_monitor.review.gather import Gatherer
from nw_gear_monitor.review.rundata import WARN
from test.monitor import synthetic

SECONDS = 12
ORIGIN = 1.75e9


def feed(gatherer, items):
    for topic, at, payload in items:
        gatherer.take(topic, at, payload)


def gathered(items, seconds=SECONDS, origin=ORIGIN):
    gatherer = Gatherer()
    feed(gatherer, items)
    return gatherer.result(Path("run/recording"), True, (origin, origin + seconds), {}, synthetic.PROVENANCE)


@pytest.fixture(scope="module")
def run():
    return gathered(synthetic.stream(SECONDS, origin=ORIGIN))


def test_duration_and_start_are_those_of_the_samples(run):
    assert run.start == ORIGIN
    assert run.duration == pytest.approx(SECONDS - 1 / synthetic.RATE, abs=1e-6)
    assert run.wall_time
    assert run.monitored


def test_waveform_statistics_have_their_closed_form(run):
    wave = run.waveform
    assert wave.samples == SECONDS * synthetic.RATE
    assert wave.rate == pytest.approx(synthetic.RATE, rel=1e-6)
    assert not wave.gaps
    for mesh in names.MESHES:
        stage = names.STAGE_OF_MESH[mesh]
        assert wave.rms[mesh] == pytest.approx(synthetic.AMPLITUDE[stage] / math.sqrt(2.0), rel=1e-3)
        assert wave.highest[mesh] == pytest.approx(synthetic.OFFSET[stage] + synthetic.AMPLITUDE[stage], rel=1e-5)
        assert wave.lowest[mesh] == pytest.approx(synthetic.OFFSET[stage] - synthetic.AMPLITUDE[stage], rel=1e-5)
    for stage in names.STAGES:
        frequency = wave.mesh_frequency.select((stage,)).mean
        assert np.allclose(frequency, synthetic.FREQUENCY[stage], rtol=1e-4)


def test_summary_says_what_the_run_was(run):
    found = summary.summarise(run)
    assert found.speed.mean == pytest.approx(synthetic.RING_SPEED)
    assert found.torque.mean == pytest.approx(synthetic.TORQUE)
    assert found.power.mean == pytest.approx(synthetic.RING_SPEED * synthetic.TORQUE)
    assert found.wind.low >= synthetic.WIND - 1.0
    assert found.wind.high <= synthetic.WIND + 1.0
    row = found.stages[1]
    assert row.frequency.mean == pytest.approx(synthetic.FREQUENCY["II"], rel=1e-4)
    assert row.peak_to_peak == pytest.approx(2.0 * synthetic.AMPLITUDE["II"], rel=1e-3)
    assert found.turning


def test_shares_of_states_follow_their_spans(run):
    found = summary.summarise(run)
    stage, worst = found.worst
    assert (stage, worst.state, worst.level) == ("II", names.CHAOTIC, WARN)
    # chaotic from second 6 until the label changes at second 9, labels from second 1 to 12
    assert worst.start - ORIGIN == pytest.approx(6.0)
    assert worst.duration == pytest.approx(3.0)
    assert found.stages[1].shares == pytest.approx({"period-1": 8.0 / 11.0, names.CHAOTIC: 3.0 / 11.0})
    assert [span.name for span in found.alarms] == ["gear_monitor_node: stage II"]
    assert "chaotic (stage II 27 % of the time watched)" in summary.headline(run, found)
    assert "unexplained variance 0.31" in summary.headline(run, found)


def test_contact_is_the_mean_of_the_truth(run):
    assert run.contact("open", "II_2") == pytest.approx(0.3)
    assert run.contact("back-flank", "II_2") == 0.0
    assert [row.contact_lost for row in summary.summarise(run).stages] == pytest.approx([0.0, 0.3, 0.0])


def test_a_fixed_operating_point_is_told_from_one_driven_by_the_wind(run):
    assert run.wind_drove
    assert not dataclasses.replace(run, values={"gear_sim_node: integration": {"input torque (N m)": "1"}}).wind_drove
    assert dataclasses.replace(run, values={"gear_sim_node: integration": {"wind speed (m/s)": "11"}}).wind_drove


def test_unknown_is_not_worse_than_what_is_known():
    said = [(0.1, (0, names.UNKNOWN, "5 of at least 8 s seen")), (1.8, (0, "period-2", "f_II/2"))]
    items = list(synthetic.stream(2, origin=ORIGIN, monitor=False))
    items += [(names.DIAGNOSTICS, ORIGIN, synthetic.diagnostics(ORIGIN + at, {"II": status})) for at, status in said]
    _stage, worst = summary.summarise(gathered(items)).worst
    assert worst.state == "period-2"
    assert worst.reason == "f_II/2"


def test_what_was_said_before_the_run_and_after_it_does_not_count():
    said = [(-5.0, "waiting"), (1.0, "period-1"), (2.0, "period-1"), (9.0, names.STALE)]
    items = list(synthetic.stream(2, origin=ORIGIN, monitor=False))
    items += [
        (names.DIAGNOSTICS, ORIGIN, synthetic.diagnostics(ORIGIN + at, {"II": (0, state, "because")}))
        for at, state in said
    ]
    spans = gathered(items).stage_spans("II")
    assert [(s.state, s.start - ORIGIN) for s in spans] == [("waiting", 0.0), ("period-1", 1.0)]
    assert spans[-1].end - ORIGIN == pytest.approx(3.0, abs=0.001)


def test_lost_blocks_are_counted_as_gaps():
    items = [
        (topic, at, payload)
        for topic, at, payload in synthetic.stream(2, monitor=False)
        if topic != names.WAVEFORM or not 0.5 < payload.data[0, 0] + 0.001 < 0.7
    ]
    run = gathered(items, 2, 0.0)
    assert len(run.waveform.gaps) == 1
    gap = run.waveform.gaps[0]
    assert gap.start == pytest.approx(0.5 - 1 / synthetic.RATE)
    assert gap.seconds == pytest.approx(0.2 + 1 / synthetic.RATE)
    assert run.waveform.samples == 2 * synthetic.RATE - 4 * synthetic.BLOCK


def test_a_restart_shows_the_last_run_and_says_so():
    run = gathered([*synthetic.stream(5), *synthetic.stream(2)], 5, 0.0)
    assert run.duration == pytest.approx(2.0, abs=0.01)
    assert run.waveform.samples == 2 * synthetic.RATE
    assert "restarted while recording (1x)" in run.remarks[0]


def test_spectra_and_sections_are_those_that_were_published(run):
    assert run.spectra.count == SECONDS
    column = run.spectra.meshes.index("II_1")
    assert run.spectra.last[:, column].max() == synthetic.AMPLITUDE["II"]
    assert run.spectra.axis[run.spectra.last[:, column].argmax()] == pytest.approx(synthetic.FREQUENCY["II"], abs=0.13)
    assert np.allclose(run.spectra.mean, run.spectra.last)
    assert run.spectra.times[-1] - run.start == pytest.approx(SECONDS, abs=0.01)
    points = run.sections["I"]
    assert set(points[:, 1]) == {1.0, 2.0, 3.0}
    assert len(points) == pytest.approx(3 * SECONDS * synthetic.FREQUENCY["I"], abs=4)


def test_indicators_of_bearings_are_gathered_and_drawn_where_there_is_a_value(run):
    rows = run.bearing_indicators["sb"]
    assert rows.column("bpfo_prominence").tolist() == [4.0] * len(rows)
    assert set(run.bearing_indicators) == set(names.WAVEFORM_BEARINGS)
    drawn = indicators.bearing_columns(run)
    assert drawn == ["rms", "mean", "bpfo_prominence"]
    words = indicators.wording("mean", bearing_registry.COLUMNS)
    assert (words.axis, words.scale) == ("Mean (kN)", 1e-3)
    figure = indicators.bearing_history(run, "mean", Range1d(0.0, run.duration))
    drawn_values = figure.renderers[0].data_source.data["y"]
    assert float(np.asarray(drawn_values)[-1]) == pytest.approx(5.0)


def test_spectra_stand_at_the_time_they_were_made_for_however_late_they_came():
    late = np.random.default_rng(1).uniform(0.0, 0.8, SECONDS + 1)
    published = {names.SPECTRUM, names.ORDERS, *map(names.indicators_topic, names.MESHES)}
    items = [
        (topic, at + late[int(at - ORIGIN)] if topic in published else at, payload)
        for topic, at, payload in synthetic.stream(SECONDS, origin=ORIGIN)
    ]
    run = gathered(items)
    assert run.spectra.times - ORIGIN == pytest.approx(np.arange(1.0, SECONDS + 1.0), abs=1e-6)


def test_spectra_that_were_recorded_at_once_keep_their_own_times():
    published = {names.SPECTRUM, names.ORDERS, *map(names.indicators_topic, names.MESHES)}
    items = [
        (topic, max(at, 7.06) if topic in published and 4.5 < at < 7.5 else at, payload)
        for topic, at, payload in synthetic.stream(SECONDS)
    ]
    assert gathered(items, origin=0.0).spectra.times == pytest.approx(np.arange(1.0, SECONDS + 1.0), abs=1e-6)


def test_spectra_without_indicators_stand_where_the_samples_were():
    dropped = {*map(names.indicators_topic, names.MESHES)}
    run = gathered([item for item in synthetic.stream(SECONDS) if item[0] not in dropped], origin=0.0)
    assert run.spectra.times == pytest.approx(np.arange(1.0, SECONDS + 1.0), abs=1e-3)


def test_silence_that_begins_with_the_end_of_a_simulated_run_is_no_alarm():
    items = list(synthetic.stream(2))
    end = 2.0 - 1.0 / synthetic.RATE
    items.append((names.DIAGNOSTICS, end, synthetic.diagnostics(end, {"I": (3, names.STALE, "no samples for 2 s")})))
    run = gathered(items, 2, 0.0)
    assert [span.state for span in run.stage_spans("I")] == ["period-1"]


def test_the_command_is_the_one_that_started_the_run_where_it_is_known(run):
    assert summary.command(run) == "nw_gear demo --duration 10"
    given = {
        "nw_gear.run": {"command_line": "recorder_node", "provenance": '{"command_line": [".venv/bin/nw_gear", "a b"]}'}
    }
    assert summary.command(dataclasses.replace(run, provenance=given)) == "nw_gear 'a b'"
    assert summary.command(dataclasses.replace(run, provenance={})) == "not recorded"


def test_without_a_monitor_nothing_is_invented():
    run = gathered(synthetic.stream(2, monitor=False), 2, 0.0)
    assert not run.monitored
    assert run.spectra is None
    assert "No monitor" in summary.headline(run, summary.summarise(run))


def test_memory_of_the_history_is_bounded():
    gatherer = Gatherer()
    columns = ("time", "rms")
    for i in range(30_000):
        gatherer.take(names.indicators_topic("III"), 0.0, Table("row", columns, np.array([[float(i), 1.0]])))
    run = gatherer.result(Path("x"), True, (0.0, 1.0), {}, {})
    rows = run.indicators["III"]
    assert 2000 <= len(rows) <= 4001
    assert np.all(np.diff(rows.column("time")) == np.diff(rows.column("time"))[0])
