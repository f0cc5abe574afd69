"""Simulated against wall time."""

import math

import pytest

from nw_gear_sim.nodes.pacing import Busy, Pace


@pytest.mark.parametrize("factor", [0.5, 1.0, 4.0])
def test_a_tick_is_due_when_the_wall_has_come_so_far(factor):
    pace = Pace(factor, wall=100.0, simulated=2.0)
    assert pace.wait(100.0, 2.0 + factor) == pytest.approx(1.0)
    assert pace.wait(101.0, 2.0 + factor) == pytest.approx(0.0)
    assert pace.lag(103.0, 2.0 + factor) == pytest.approx(2.0)


def test_as_fast_as_possible_neither_waits_nor_lags():
    pace = Pace(0.0, 0.0, 0.0)
    assert pace.wait(0.0, 50.0) == 0.0
    assert pace.lag(1000.0, 1.0) == 0.0
    assert not pace.too_slow(1000.0, 1.0)


def test_a_machine_at_half_the_pace_is_reported_with_its_factor():
    pace = Pace(1.0, 0.0, 0.0)
    for i in range(1, 101):
        pace.note(0.1 * i, 0.05 * i)
    assert pace.reached() == pytest.approx(0.5)
    assert pace.too_slow(10.0, 5.0)
    assert not pace.too_slow(10.0, 9.6)


def test_the_factor_reached_looks_at_the_last_seconds_only():
    pace = Pace(1.0, 0.0, 0.0)
    for i in range(1, 101):
        pace.note(0.1 * i, 0.01 * i)
    for i in range(1, 101):
        pace.note(10.0 + 0.1 * i, 1.0 + 0.1 * i)
    assert pace.reached() == pytest.approx(1.0)


def test_before_any_progress_no_factor_is_claimed():
    assert math.isnan(Pace(1.0, 0.0, 0.0).reached())


def test_share_of_a_core_since_the_last_look():
    busy = Busy(10.0)
    assert math.isnan(busy.share(10.0))
    busy.note(0.2)
    busy.note(0.1)
    assert busy.share(12.0) == pytest.approx(0.15)
    busy.note(0.5)
    assert busy.share(13.0) == pytest.approx(0.5)
