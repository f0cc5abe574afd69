"""States of gearboxes whose motion is known by construction, at constant and at changing speed."""

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.pipeline import Pipeline, Windows
from nw_gear_monitor.stage_state import Persistence, State
from test.monitor.gear_signal import blocks, duffing, logistic, paper, waveform

SECONDS = 11.0
"""The first label comes with the third window, after 10 s."""


def run(table, windows=None):
    pipeline = Pipeline(paper(), windows)
    return [hop for block in blocks(table) for hop in pipeline.feed(block)], pipeline


def labels(hop):
    return {stage: report.state.label for stage, report in hop.stages.items()}


def half_order(_time, phase):
    return 6e-6 * np.cos(0.5 * phase) + 2e-6 * np.cos(1.5 * phase)


def quarter_order(time, phase):
    return half_order(time, phase) + sum(3e-6 * np.cos(q * phase + q) for q in (0.25, 0.75, 1.25))


def third_order(_time, phase):
    return 5e-6 * np.cos(phase / 3 + 0.1)


def foreign_line(_time, phase):
    return 1e-5 * np.cos(1.2360679 * phase)


def chaos(_time, phase):
    return duffing(phase / (2 * np.pi), 15e-6)


def chaotic_steps(_time, phase):
    """A sine whose amplitude is drawn anew each mesh period by the logistic map at r = 4."""
    return 3e-5 * logistic(4.0, 5000)[((phase - phase[0]) / (2 * np.pi)).astype(int)] * np.sin(phase)


def wind(time):
    return 1.0 + 0.05 * np.sin(2 * np.pi * time / 9.0)


def gusts(time):
    return 1.0 + 0.3 * np.sin(2 * np.pi * time / 7.0)


@pytest.mark.parametrize("speed", [None, wind], ids=["constant", "wave +-5 %"])
@pytest.mark.parametrize(
    ("extra", "label"),
    [
        (None, "period-1"),
        (half_order, "period-2"),
        (quarter_order, "period-4"),
        (third_order, "period-3"),
        (foreign_line, names.QUASI_PERIODIC),
        (chaos, names.CHAOTIC),
        (chaotic_steps, names.CHAOTIC),
    ],
    ids=["regular", "f/2", "f/4", "f/3", "foreign line", "Duffing", "logistic"],
)
def test_stage_two_gets_its_label_and_the_others_stay_regular(extra, label, speed):
    table = waveform(
        SECONDS, speed=speed, load=gusts if speed else None, noise=0.01, extra={"II": extra} if extra else None
    )
    hops, _ = run(table)
    assert labels(hops[-1]) == {"I": "period-1", "II": label, "III": "period-1"}


@pytest.mark.parametrize("stage", ["I", "III"])
def test_chaos_is_seen_in_the_other_stages_too(stage):
    hops, _ = run(waveform(SECONDS, extra={stage: chaos}))
    assert labels(hops[-1]) == {**dict.fromkeys(names.STAGES, "period-1"), stage: names.CHAOTIC}


@pytest.mark.parametrize("noise", [0.1, 0.01], ids=["20 dB", "40 dB"])
@pytest.mark.parametrize("extra", [None, half_order], ids=["regular", "f/2"])
def test_noise_on_a_periodic_signal_is_never_chaos(noise, extra):
    hops, _ = run(waveform(16.0, noise=noise, extra={"II": extra} if extra else None, seed=5))
    assert names.CHAOTIC not in {label for hop in hops for label in labels(hop).values()}
    assert labels(hops[-1])["II"] == ("period-2" if extra else "period-1")


def test_white_noise_as_strong_as_the_vibration_is_told_from_chaos():
    hops, _ = run(waveform(SECONDS, noise=1.0, seed=3))
    assert labels(hops[-1]) == dict.fromkeys(names.STAGES, "period-1")
    assert hops[-1].stages["I"].evidence.noise == pytest.approx(0.5, abs=0.05)


def test_a_drifting_level_is_no_chaos():
    hops, _ = run(waveform(SECONDS, load=lambda time: 1.0 + 0.1 * time, noise=0.01))
    assert labels(hops[-1]) == dict.fromkeys(names.STAGES, "period-1")


def test_a_foreign_line_is_named_by_its_order():
    hops, _ = run(waveform(SECONDS, extra={"II": foreign_line}))
    assert hops[-1].stages["II"].evidence.unlisted_order == pytest.approx(1.2361, abs=1e-3)


def test_a_transmitted_subharmonic_is_named_and_not_taken_for_ones_own():
    hops, _ = run(waveform(SECONDS, extra={"II": half_order}))
    assert "transmitted from stage II" in hops[-1].stages["III"].state.reason
    assert hops[-1].stages["II"].evidence.subharmonic_order == 2


def test_a_constant_displacement_is_unknown():
    hops, _ = run(waveform(SECONDS, lines=0.0))
    assert set(labels(hops[-1]).values()) == {names.UNKNOWN}
    assert "no vibration" in hops[-1].stages["I"].state.reason


def test_noise_without_any_mesh_line_is_unknown():
    def noise(time, _phase):
        return 1e-6 * np.random.default_rng(7).standard_normal(time.size)

    hops, _ = run(waveform(SECONDS, lines=0.0, extra=dict.fromkeys(names.STAGES, noise)))
    assert set(labels(hops[-1]).values()) == {names.UNKNOWN}


def test_standstill_is_unknown_whatever_the_signal_does():
    table = waveform(SECONDS, extra={"II": chaos})
    table.data[:, 1:4] = 0.3
    hops, _ = run(table)
    assert {(label, hop.turning) for hop in hops for label in labels(hop).values()} == {(names.UNKNOWN, False)}
    assert "not turning" in hops[-1].stages["II"].state.reason
    assert hops[-1].sections == {}
    assert hops[-1].orders is None
    assert hops[-1].spectrum is not None


@pytest.mark.parametrize("share", [0.3, 0.1, 0.02])
def test_a_slowly_turning_gearbox_is_labelled_too(share):
    """Lines crowd together and sink into the slow trend; the fit has to stay solvable."""
    hops, _ = run(waveform(SECONDS, noise=0.01, speed=lambda time: share + 0.0 * time))
    assert set(labels(hops[-1]).values()) == {"period-1"}


def test_nothing_is_known_before_three_windows_of_eight_seconds():
    hops, _ = run(waveform(SECONDS))
    assert [labels(hop)["II"] for hop in hops] == [names.UNKNOWN] * 9 + ["period-1"] * 2


def test_a_gap_flushes_every_window():
    pieces = blocks(waveform(16.0))
    del pieces[11 * 20 + 5]
    pipeline = Pipeline(paper())
    hops = [hop for piece in pieces for hop in pipeline.feed(piece)]
    after = next(hop for hop in hops if hop.time > 12.5)
    assert after.restarted
    assert set(labels(after).values()) == {names.UNKNOWN}
    assert after.spectrum is None
    assert np.isnan(after.indicators["I_1"].data[0, 1:]).all()
    assert pipeline.continuity.gaps == 1
    assert labels(hops[-1])["II"] == names.UNKNOWN  # 4 of at least 8 s seen since


def test_reset_flushes_and_starts_again():
    table = waveform(22.0)
    pieces = blocks(table)
    pipeline = Pipeline(paper())
    before = [hop for piece in pieces[:220] for hop in pipeline.feed(piece)]
    pipeline.reset()
    after = [hop for piece in pieces[220:] for hop in pipeline.feed(piece)]
    assert labels(before[-1])["II"] == "period-1"
    assert labels(after[0])["II"] == names.UNKNOWN
    assert labels(after[-1])["II"] == "period-1"


def test_results_do_not_depend_on_the_cut_or_on_when_it_started_to_listen():
    """A replay in other blocks, and one that joined later, give the same numbers once windows are full (NA4 apart)."""
    table = waveform(13.0, noise=0.02, extra={"II": chaos})
    short = Windows(label_seconds=8)
    first, _ = run(table, short)
    again = Pipeline(paper(), short)
    second = [hop for block in blocks(table, 1000) for hop in again.feed(block)]
    late = Pipeline(paper(), short)
    joined = [h for b in blocks(Table(table.row, table.columns, table.data[12000:])) for h in late.feed(b)]
    for other in (second[-1], joined[-1]):
        assert other.time == first[-1].time
        for name in ("spectrum", "orders"):
            assert getattr(other, name).data == pytest.approx(getattr(first[-1], name).data, rel=1e-9, abs=1e-18)
        for mesh in names.MESHES:
            mine, theirs = (hop.indicators[mesh] for hop in (first[-1], other))
            own = [c for c in mine.columns if other is second[-1] or not c.startswith("na4")]
            assert theirs.select(own) == pytest.approx(mine.select(own), rel=1e-9, abs=1e-18, nan_ok=True)
        for bearing, mine in first[-1].bearing_indicators.items():
            assert other.bearing_indicators[bearing].data == pytest.approx(mine.data, rel=1e-9, abs=1e-18, nan_ok=True)
        for stage in names.STAGES:
            assert other.sections[stage].data == pytest.approx(first[-1].sections[stage].data, rel=1e-9)


def test_a_faster_waveform_gives_the_same_labels():
    hops, _ = run(waveform(SECONDS, rate=20480, extra={"II": half_order}))
    assert labels(hops[-1]) == {"I": "period-1", "II": "period-2", "III": "period-1"}
    assert len(hops[-1].spectrum) == 4 * 20480 // 2 + 1


def test_a_label_changes_after_three_windows_in_a_row_only():
    persistence = Persistence()
    shown = [
        persistence.add(State(word, "")).label for word in ["a", "a", "a", "b", "a", "b", "b", "b", "c", "d", "c", "d"]
    ]
    assert shown == [names.UNKNOWN] * 2 + ["a"] * 5 + ["b"] * 3 + [names.UNKNOWN] * 2


def test_a_gearbox_that_starts_from_rest_is_watched_and_no_chaos():
    """Just after the start a cycle takes as long as one likes, which must not become as many points."""
    hops, pipeline = run(waveform(SECONDS, speed=lambda time: 0.02 * np.maximum(time - 1.5, 0.0) ** 2, noise=0.01))
    assert len(hops) == SECONDS
    assert pipeline.continuity.restarts == 0
    assert names.CHAOTIC not in {label for hop in hops for label in labels(hop).values()}


def test_a_gearbox_that_comes_to_rest_is_transient_or_unknown():
    """Its lines end up so slow that nothing but rounding of them is left beside the trend."""

    def falling(time):
        return np.maximum(0.57 - 0.035 * time, 0.02)

    hops, _ = run(waveform(17.0, speed=falling, noise=0.01, extra={"II": chaos}))
    seen = {label for hop in hops[9:] for label in labels(hop).values()}
    assert seen <= {names.TRANSIENT, names.UNKNOWN, "period-1"}
    assert names.TRANSIENT in seen
    assert np.isfinite([report.evidence.rho for report in hops[-1].stages.values()]).all()
