"""Statements and labels of the paper's Sec. 4: what they say, how they are scored, what guessing scores."""

import itertools

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_sim.studies.section4 import scoring
from nw_gear_sim.studies.section4.statements import (
    MOTION,
    Label,
    frequencies,
    incompatible,
    read_labels,
    read_statements,
    seen,
)

STATEMENTS = read_statements()
LABELS = read_labels()


def test_every_statement_of_the_list_is_there():
    assert {statement.id.split(".")[0] for statement in STATEMENTS} == {f"C{n}" for n in range(1, 14)}
    assert len({statement.id for statement in STATEMENTS}) == len(STATEMENTS)


def test_labels_are_what_their_statements_say():
    known = {statement.id: statement for statement in STATEMENTS}
    assert len(LABELS) == 39
    for label in LABELS:
        statement = known[label.statement]
        assert statement.covers(label.omega_e)
        assert (statement.stage, statement.expected) == (label.stage, label.expected)
    motions = {statement.id for statement in STATEMENTS if statement.kind == MOTION}
    assert {label.statement for label in LABELS} == motions
    assert len(frequencies(LABELS)) == 13


def test_contradictions_are_those_of_figures_within_intervals_of_other_motions():
    motions = [statement for statement in STATEMENTS if statement.kind == MOTION]
    found = set()
    for point, interval in itertools.product(motions, motions):
        within = point.low == point.high and interval.low < interval.high and interval.covers(point.low)
        if within and point.stage == interval.stage and incompatible(point.expected, interval.expected):
            found.add((point.id, interval.id))
    assert found == {("C2.I", "C5"), ("C4.III", "C9.5")}
    listed = {(s.id, other) for s in motions for other in s.contradicts if s.low == s.high}
    assert listed == found | {("C4.III", "C10.4.III")}  # a single line is no chaos
    known = {statement.id: statement for statement in STATEMENTS}
    for statement in STATEMENTS:
        assert all(statement.id in known[other].contradicts for other in statement.contradicts)


def test_intervals_of_a_stage_follow_each_other():
    for stage in names.STAGES:
        own = [s for s in STATEMENTS if s.kind == MOTION and s.stage == stage and s.low < s.high]
        assert own[0].low == 0.160
        assert own[-1].high == 0.270
        assert all(one.high == other.low for one, other in itertools.pairwise(own))


def test_guesses_by_hand():
    labels = [
        Label("a", "I", 0.17, "period-1"),
        Label("b", "I", 0.20, "chaotic"),
        Label("c", "II", 0.17, "multi"),
        Label("d", "II", 0.20, "period-2"),
        Label("e", "III", 0.17, "chaotic"),
    ]
    found = scoring.guesses(labels)
    assert found["always period-1"] == 1 / 5
    assert found["always period-2"] == 2 / 5
    assert found["always period-3"] == 1 / 5
    assert found["always chaotic"] == 2 / 5
    assert found["the best constant guess"] == 2 / 5
    assert found["the best constant guess for each stage"] == pytest.approx(4 / 5)  # 1 of I, 2 of II, 1 of III


def test_guesses_at_the_papers_labels():
    found = scoring.guesses(LABELS)
    assert found["always period-1"] == 16 / 39
    assert found["always chaotic"] == 13 / 39


def test_chance_knows_what_it_can_reach():
    labels = [Label("", "I", k / 100, "period-1" if k < 4 else "chaotic") for k in range(8)]
    perfect = {("I", label.omega_e): label.expected for label in labels}
    found = scoring.chance(labels, [perfect])
    assert found.mean == pytest.approx(0.5, abs=0.02)  # a shuffle puts half of them right
    assert found.probability == pytest.approx(1 / 70, abs=0.01)  # of 8! / (4! 4!) assignments one is all right
    constant = {place: "period-1" for place in perfect}
    found = scoring.chance(labels, [constant])
    assert (found.mean, found.upper, found.probability) == (0.5, 0.5, 1.0)


def test_more_draws_have_a_better_best_by_chance():
    labels = [Label("", "I", k / 100, "period-1" if k % 2 else "chaotic") for k in range(20)]
    rng = np.random.default_rng(1)
    draws = [{("I", w.omega_e): str(rng.choice(["period-1", "chaotic"])) for w in labels} for _ in range(50)]
    assert scoring.chance(labels, draws).mean > scoring.chance(labels, draws[:1]).mean + 0.15
    assert scoring.chance(labels, draws).probability > 0.01


def test_few_dots_are_periodic_in_a_chaotic_gearbox():
    rng = np.random.default_rng(0)
    dots = np.tile([1.0, 3.0, 2.0], 60) + 0.01 * rng.standard_normal(180)
    assert seen(dots, 1.0, names.CHAOTIC) == "period-3"
    assert seen(dots, 1.0, "period-1") == "period-1"
    assert seen(dots, 0.01, names.CHAOTIC) == names.CHAOTIC
    assert seen(rng.standard_normal(180), 1.0, names.CHAOTIC) == names.CHAOTIC
    assert seen(dots, 1.0, "diverged") == "diverged"
    assert seen(np.full(3, np.nan), 1.0, names.UNKNOWN) == names.UNKNOWN


def test_motions_of_a_piece_by_both_readings():
    dots = np.tile([1.0, 2.0], 50)
    noise = np.random.default_rng(2).standard_normal(100)
    piece = {
        "omega_e": np.array([0.17, 0.2]),
        "rate": np.array([9.0, -9.0]),
        "error": np.ones(2),
        "diverged": np.full(2, np.nan),
        "period": np.array([[1, 1, 1], [1, 2, 4]]),
        "deviation": np.ones((2, 3)),
        "x": np.array([[dots, noise, dots], [dots, dots, dots]]),
    }
    section = scoring.motions(piece)
    assert [section[s, 0.17] for s in names.STAGES] == ["period-2", "chaotic", "period-2"]
    exponent = scoring.motions(piece, "exponent")
    assert [exponent[s, 0.17] for s in names.STAGES] == ["chaotic"] * 3
    assert [exponent[s, 0.2] for s in names.STAGES] == ["period-1", "period-2", "period-4"]
    labels = [Label("", "I", 0.17, "multi"), Label("", "II", 0.17, "period-1"), Label("", "III", 0.2, "multi")]
    assert scoring.held(labels, section) == [True, False, True]
    assert scoring.held(labels, exponent) == [False, False, True]
