"""Latches against their rule in words, false alarms against closed forms, statistics against numpy."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from nw_gear_monitor.alarms import kernel
from nw_gear_monitor.alarms.baseline import empty
from nw_gear_monitor.alarms.settings import LEAST_SPREAD

LOW, NEAR, HIGH = 0.5, 0.95, 1.5
"""Values under 0.9 of a limit of 1, between that and the limit, over it."""


def by_the_rule(values, bound, needed=3):
    """Set when so many of the last five are over the limit; released when the last five are under 0.9 of it."""
    shown, is_set = [], False
    for end in range(1, len(values) + 1):
        last = values[max(0, end - 5) : end]
        if len([x for x in last if x > bound]) >= needed:
            is_set = True
        elif len(last) == 5 and all(x < 0.9 * bound for x in last):
            is_set = False
        shown.append(is_set)
    return shown


def by_the_latch(values, bound, needed=3):
    shown, state = [], (0, 0, False)
    for x in values:
        state = kernel.latch(*state, x, bound, needed)
        shown.append(state[2])
    return shown


def test_the_latch_follows_the_rule_on_every_sequence_of_nine_windows():
    for values in itertools.product((LOW, NEAR, HIGH), repeat=9):
        for needed in (3, 4):
            assert by_the_latch(values, 1.0, needed) == by_the_rule(values, 1.0, needed), values


@given(st.lists(st.sampled_from((LOW, NEAR, HIGH)), min_size=10, max_size=80))
def test_the_latch_follows_the_rule_on_long_sequences(values):
    assert by_the_latch(values, 1.0) == by_the_rule(values, 1.0)
    assert by_the_latch(values, 1.0, 4) == by_the_rule(values, 1.0, 4)


def known(mean=0.0, deviation=1.0, features=1, count=1e12):
    """Statistics as of so many windows of a known distribution that their limits are exact."""
    block = empty(features)
    block[kernel.COUNT] = block[kernel.INDEPENDENT] = count
    block[kernel.MEAN] = mean
    block[kernel.M2] = deviation**2 * count
    return block


def run(block, rows, deviations=(3.0, 6.0), learning=False, least=20.0, spacing=1.0):
    """Levels of the features after each window of `rows` (windows, features), which are logarithms."""
    states = np.zeros((kernel.STATES, rows.shape[1]), dtype=np.int64)
    which, offsets = np.arange(rows.shape[1]), np.zeros(rows.shape[1])
    shown = []
    for tick, row in enumerate(np.exp(rows), start=1):
        kernel.window(which, row, offsets, spacing, float(tick), block, states, deviations, (least, 1e15), learning)
        shown.append(kernel.levels(states))
    return np.array(shown)


@settings(deadline=None)
@given(st.lists(st.floats(-2.0, 8.0), min_size=1, max_size=60))
def test_levels_follow_from_both_rules(values):
    x = np.exp(values)
    warn, error = by_the_rule(x, math.exp(3.0)), by_the_rule(x, math.exp(6.0), 4)
    wanted = [2 if e else 1 if w else 0 for w, e in zip(warn, error, strict=True)]
    assert run(known(), np.array(values)[:, None])[:, 0].tolist() == wanted


def test_limits_of_a_known_bin():
    block = known(mean=math.log(2.0), deviation=0.1)
    assert kernel.limit(block, 0, 0.0, 3.0) == pytest.approx(2.0 * math.exp(0.3), rel=1e-9)
    assert kernel.limit(block, 0, 0.5, 6.0) == pytest.approx(2.0 * math.exp(0.6) - 0.5, rel=1e-9)
    steady = known(mean=0.0, deviation=0.0)
    assert kernel.limit(steady, 0, 0.0, 3.0) == pytest.approx(math.exp(3 * LEAST_SPREAD), rel=1e-9)
    assert 0.9 * kernel.limit(steady, 0, 0.0, 3.0) > 1.0  # else an alarm could never be cleared


@pytest.mark.parametrize("deviations", [0.5, 1.0, 1.5])
def test_share_of_windows_that_set_the_latch_is_binomial(deviations):
    rng = np.random.default_rng(5)
    values = np.exp(rng.normal(size=120000))
    over = stats.norm.sf(deviations)
    state, sets = (0, 0), []
    for x in values:
        bits, under, is_set = kernel.latch(*state, False, x, math.exp(deviations), 3)
        state = bits, under
        sets.append(is_set)
    wanted = stats.binom.sf(2, 5, over)
    # every fifth window shares none with the one before, which gives at least so many independent trials
    assert np.mean(sets) == pytest.approx(wanted, abs=4.0 * math.sqrt(wanted / (len(values) / 5)))


@pytest.mark.parametrize("z", [1.0, 3.0, 6.0])
@pytest.mark.parametrize("freedom", [19.0, 29.0, 99.0, 999.0])
def test_quantiles_are_students(z, freedom):
    assert kernel.student(z, freedom) == pytest.approx(stats.t.isf(stats.norm.sf(z), freedom), rel=0.02)


@pytest.mark.parametrize("deviations", [1.0, 2.0, 3.0])
def test_a_learned_limit_is_exceeded_as_often_as_a_known_one(deviations):
    """Whatever few windows were learned from; what the deviations upwards add makes it rarer, never more frequent."""
    rng = np.random.default_rng(1)
    n, features = 30, 40000
    block = empty(features)
    run(block, rng.normal(size=(n, features)), learning=True, least=1e9)
    wanted = stats.norm.sf(deviations)
    limits = np.log([kernel.limit(block, i, 0.0, deviations) for i in range(features)])
    assert 0.5 * wanted < np.mean(stats.norm.sf(limits)) < wanted
    block[kernel.ABOVE] = 0.0
    limits = np.log([kernel.limit(block, i, 0.0, deviations) for i in range(features)])
    assert np.mean(stats.norm.sf(limits)) == pytest.approx(wanted, rel=0.03)


def test_statistics_are_those_of_numpy():
    rng = np.random.default_rng(2)
    rows = rng.gamma(2.0, size=(400, 3)) + rng.normal(size=3)
    block = empty(3)
    run(block, rows, learning=True, least=1e9, spacing=4.0)
    assert block[kernel.COUNT].tolist() == [400.0] * 3
    assert block[kernel.INDEPENDENT].tolist() == [100.0] * 3
    assert block[kernel.MEAN] == pytest.approx(rows.mean(axis=0), rel=1e-12)
    assert block[kernel.M2] / 400 == pytest.approx(rows.var(axis=0), rel=1e-10)
    for k in range(3):
        above = rows[:, k][rows[:, k] > rows[:, k].mean()] - rows[:, k].mean()
        assert block[kernel.M2_ABOVE, k] / block[kernel.ABOVE, k] == pytest.approx(np.mean(above**2), rel=0.05)
        assert block[kernel.M2_ABOVE, k] / block[kernel.ABOVE, k] > 1.2 * rows[:, k].var()  # skewed: it matters


@pytest.mark.parametrize("length", [4, 16])
def test_spread_of_overlapping_windows_is_corrected_on_average(length):
    """Means of `length` values, hop 1: the variance of a new window about the learned mean comes out right."""
    rng = np.random.default_rng(3)
    features, independent = 3000, 20
    raw = rng.normal(size=(length * independent + length, features))
    sums = np.cumsum(raw, axis=0)
    rows = (sums[length:] - sums[:-length]) / math.sqrt(length)  # unit variance each
    block = empty(features)
    run(block, rows, learning=True, least=1e9, spacing=float(length))
    assert set(block[kernel.INDEPENDENT]) == {float(independent)}
    n = independent
    predicted = np.mean(block[kernel.M2] / block[kernel.COUNT]) * (n + 1) / (n - 1)
    actual = 1.0 + np.mean(block[kernel.MEAN] ** 2)
    assert predicted == pytest.approx(actual, rel=0.05)


def test_nothing_is_judged_before_the_bin_has_seen_enough():
    rows = np.concatenate([np.zeros((19, 1)), np.full((20, 1), 9.0)])
    shown = run(empty(1), rows, learning=True, least=20.0)
    assert not shown[:21].any()  # the twentieth window is learned, the next ones judged
    rows = np.concatenate([np.random.default_rng(0).normal(scale=0.1, size=(20, 1)), np.full((5, 1), 9.0)])
    assert run(empty(1), rows, learning=True, least=20.0)[:, 0].tolist() == [0] * 22 + [1] + [2] * 2


def test_what_raises_an_alarm_is_not_learned():
    rng = np.random.default_rng(4)
    healthy, block = rng.normal(scale=0.1, size=(100, 1)), empty(1)
    run(block, healthy, learning=True)
    before = block.copy()
    shown = run(block, np.full((1000, 1), 2.0), learning=True)
    assert shown[-1, 0] == 2
    assert np.array_equal(block, before, equal_nan=True)
    run(block, healthy, learning=False)
    assert np.array_equal(block, before, equal_nan=True)


def learned(extra):
    """Statistics of 100 windows in which the spread is 0.1, and of further ones (nan: one at the limit of WARN)."""
    block = empty(1)
    run(block, np.random.default_rng(4).normal(scale=0.1, size=(100, 1)), learning=True)
    bound = math.log(kernel.limit(block, 0, 0.0, 3.0))
    values = np.where(np.isnan(extra), bound, extra)
    states = np.zeros((kernel.STATES, 1), dtype=np.int64)
    for tick, value in enumerate(values, start=101):
        x = np.array([math.exp(value)])
        kernel.window(np.array([0]), x, np.zeros(1), 1.0, float(tick), block, states, (3.0, 6.0), (20.0, 1e9), True)
    return block


def test_a_single_value_over_the_limit_is_learned_as_the_limit_and_those_after_it_are_not():
    assert learned([0.45]) == pytest.approx(learned([math.nan]), rel=1e-9)
    assert learned([0.45, 0.45, 0.0]) == pytest.approx(learned([math.nan, 0.0]), rel=1e-2)
    assert learned([0.45, 0.45])[kernel.COUNT, 0] == 101
    assert learned([0.45, 0.0, 0.0, 0.0, 0.0, 0.45])[kernel.COUNT, 0] == 106
    assert learned([50.0])[kernel.COUNT, 0] == 100  # over the limit of ERROR


def test_learning_ends_where_enough_is_known():
    block = empty(1)
    states = np.zeros((kernel.STATES, 1), dtype=np.int64)
    for tick in range(100):
        kernel.window(
            np.array([0]), np.ones(1), np.zeros(1), 1.0, float(tick), block, states, (3.0, 6.0), (20.0, 30.0), True
        )
    assert block[kernel.INDEPENDENT, 0] == block[kernel.COUNT, 0] == 30.0
