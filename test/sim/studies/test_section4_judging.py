"""Statements of the paper's Sec. 4 judged on made-up motions that are known."""

from dataclasses import replace

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_sim.studies.section4 import judging, space, study
from nw_gear_sim.studies.section4.judging import Evidence
from nw_gear_sim.studies.section4.statements import frequencies, read_labels, read_statements
from nw_gear_sim.studies.section4.waveforms import MULTIPLES, lines

STATEMENTS = {statement.id: statement for statement in read_statements()}
PERIODS = {"period-1": 1, "period-2": 2, "multi": 4, "period-3": 3}


def piece(omega_e, motion):
    """Return a piece in which stage and frequency move as motion(stage, omega_e) says."""
    noise = np.random.default_rng(0).standard_normal(96)
    places = [[motion(stage, w) for stage in names.STAGES] for w in omega_e]
    dots = [[np.arange(96.0) % PERIODS.get(m, 1) if m != "chaotic" else noise for m in row] for row in places]
    chaotic = np.array([any(m == "chaotic" for m in row) for row in places])
    return {
        "omega_e": np.array(omega_e),
        "rate": np.where(chaotic, 9.0, -9.0),
        "error": np.ones(len(omega_e)),
        "diverged": np.full(len(omega_e), np.nan),
        "period": np.array([[PERIODS.get(m, 1) for m in row] for row in places]),
        "deviation": np.ones((len(omega_e), 3)),
        "x": np.array(dots),
    }


def spectra(dominant):
    omega_e = np.array(study.FIGURES)
    amplitudes = np.zeros((3, 3, len(MULTIPLES)))
    amplitudes[..., MULTIPLES.index(1.0)] = 1.0
    return {"omega_e": omega_e, "lines": amplitudes, "dominant": np.full((3, 3), dominant),
            "others": np.full((3, 3), 0.5)}  # fmt: skip


def paper(stage, omega_e):
    """What the paper says; where it contradicts itself, what its Figs 13-15 say."""
    fitting = [s for s in STATEMENTS.values() if s.kind == "motion" and s.stage == stage and s.covers(omega_e)]
    if not fitting:
        return "period-1"
    return min(fitting, key=lambda s: s.high - s.low).expected


def evidence(motion, dominant=1.0):
    places = frequencies(read_labels())
    labels = piece(places, motion)
    rk4 = {w: {name: labels[name][places.index(w)] for name in ("period", "deviation", "x")} for w in study.FIGURES}
    rigid = {**labels, "deviation": 1.2 * labels["deviation"]}
    grid = (piece(study.GRID, motion),)
    tied, own = spectra(dominant), spectra(0.305)
    return Evidence(labels, grid, labels, rigid, labels, tied, own, rk4)


def judged(evidence):
    return {verdict.statement.id: verdict for verdict in judging.judge(evidence)}


def test_motions_as_the_paper_has_them_hold_but_where_it_contradicts_itself():
    found = judged(evidence(paper))
    contradicting = {id for id, verdict in found.items() if verdict.holds == "contradicts"}
    assert contradicting == {"C2.I", "C5", "C4.III", "C9.5", "C10.4.III"}
    for id, verdict in found.items():
        if STATEMENTS[id].kind == "motion" and id not in contradicting:
            assert verdict.holds is True, (id, verdict.value)
    assert found["C2.I"].agrees
    assert not found["C5"].agrees
    assert "not together with C2.I" in found["C5"].value
    assert found["C1"].holds is True
    assert judging.holding(tuple(found.values())) == sum(v.holds is True for v in found.values())


def test_a_gearbox_that_does_nothing_but_mesh():
    found = judged(evidence(lambda *_: "period-1"))
    assert found["C1"].holds is False
    assert found["C8.1"].holds is True
    assert found["C8.2"].holds is False
    assert found["C8.2"].value.startswith("at 0 of ")
    assert found["C5"].holds == "contradicts"
    assert found["C5"].agrees


def test_one_frequency_elsewhere_makes_an_interval_fail():
    at = [w for w in study.GRID if 0.187 < w < 0.218][3]
    found = judged(evidence(lambda stage, w: "period-2" if (stage, w) == ("II", at) else paper(stage, w)))
    assert found["C8.2"].holds is False
    assert "period-2 1" in found["C8.2"].value
    assert found["C8.1"].holds is True


def test_lines():
    third = judged(evidence(paper, 1 / 3))
    assert third["C11"].holds is True
    assert third["C10.2.I"].holds is False
    mesh = judged(evidence(paper, 1.001))
    assert mesh["C11"].holds is False
    assert mesh["C10.2.I"].holds is True
    assert not mesh["C10.4.III"].agrees  # another line has half of its amplitude
    assert not judged(evidence(paper, 40 / 131))["C11"].agrees  # stage II's own line isn't f_m / 3
    assert "0.305" in mesh["C11"].kinematic


def test_a_minute_an_integrator_and_a_rigid_ring():
    same = evidence(paper)
    found = judged(same)
    assert [found[id].holds for id in ("C12.1", "C12.2", "C13")] == [True, True, True]
    other = judged(replace(same, minute=piece(frequencies(read_labels()), lambda *_: "period-1")))
    assert other["C12.1"].holds is False
    assert judged(replace(same, rigid=same.labels))["C13"].holds is False
    louder = {w: {**run, "deviation": 1.5 * run["deviation"]} for w, run in same.rk4.items()}
    assert judged(replace(same, rk4=louder))["C12.2"].holds is False
    fewer = {w: {**run, "x": np.zeros((3, 96))} for w, run in same.rk4.items()}
    assert judged(replace(same, rk4=fewer))["C12.2"].holds is False


@pytest.mark.parametrize(("order", "share"), [(1 / 3, 0.25), (40 / 131, 0.25), (2.0, 0.5)])
def test_lines_of_a_signal_that_is_known(order, share):
    rate, meshing = 4800.0, 170.0
    time = np.arange(round(200 * rate / meshing)) / rate
    x = 5.0 + 3.0 * np.cos(2 * np.pi * meshing * time) + 3.0 * share * np.cos(2 * np.pi * order * meshing * time + 1)
    amplitudes, dominant, others = lines(x, rate, meshing)
    assert amplitudes[MULTIPLES.index(1.0)] == pytest.approx(3.0, rel=1e-3)
    assert amplitudes[MULTIPLES.index(order)] == pytest.approx(3.0 * share, rel=1e-3)
    assert dominant == pytest.approx(1.0, abs=2e-3)
    assert others == pytest.approx(share, rel=0.02)
    if order < 0.5:  # the two candidates are told from each other
        between = amplitudes[1 - MULTIPLES.index(order)]
        assert between < 0.02 * amplitudes[MULTIPLES.index(order)]


def test_draws_fill_the_ranges_evenly_and_go_on():
    draws = space.shares(64, 3)
    assert np.array_equal(space.shares(20, 3), draws[:20])
    assert not np.array_equal(space.shares(20, 4), draws[:20])
    for column in draws.T:  # a (t, m, s)-net: as many in each sixteenth
        assert np.array_equal(np.histogram(column, 16, (0, 1))[0], np.full(16, 4))
    near = space.around(draws[0], 500, 1)
    assert near.min() >= 0.0
    assert near.max() <= 1.0
    inside = np.flatnonzero((draws[0] > 0.4) & (draws[0] < 0.6))
    assert np.std(near[:, inside]) == pytest.approx(space.SPREAD, rel=0.15)


def test_ranges_are_linear_or_logarithmic():
    load = next(unknown for unknown in space.SPACE if unknown.name == "load")
    assert (load.at(0.0), load.at(1.0)) == (pytest.approx(0.02), pytest.approx(1.0))
    assert load.at(0.5) == pytest.approx(np.sqrt(0.02))
    backlash = next(unknown for unknown in space.SPACE if unknown.name == "backlash_II")
    assert backlash.at(0.5) == pytest.approx(50e-6)
