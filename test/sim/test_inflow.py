"""The wind between its samples, and when the simulator has to wait for it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nw_gear_sim.nodes.inflow import Inflow


def inflow(samples):
    result = Inflow()
    for time, speed in samples:
        result.add(time, speed)
    return result


def test_a_linear_wind_is_reproduced_between_samples():
    wind = inflow([(0.1 * i, 5.0 + 0.3 * i) for i in range(20)])
    for time in (0.0, 0.05, 0.333, 1.2345, 1.9):
        assert wind.at(time) == pytest.approx(5.0 + 3.0 * time, abs=1e-12)


def test_it_is_held_beyond_both_ends():
    wind = inflow([(1.0, 7.0), (2.0, 9.0)])
    assert wind.at(0.0) == 7.0
    assert wind.at(5.0) == 9.0


@given(st.lists(st.floats(0.0, 40.0), min_size=2, max_size=30), st.floats(0.0, 1.0))
def test_interpolation_stays_within_its_neighbours(speeds, share):
    wind = inflow(list(enumerate(speeds)))
    time = share * (len(speeds) - 1)
    left = min(int(time), len(speeds) - 2)
    low, high = sorted(speeds[left : left + 2])
    assert low - 1e-9 <= wind.at(time) <= high + 1e-9


def test_lock_step_waits_until_the_whole_interval_is_known():
    wind = inflow([(0.0, 8.0), (0.1, 8.0)])
    assert wind.covers(0.05, 0.1)
    assert not wind.covers(0.05, 0.11)
    assert not wind.covers(-0.01, 0.1)


def test_a_stamp_that_jumps_back_begins_a_new_epoch():
    wind = inflow([(30.0, 8.0), (30.1, 8.0), (0.0, 12.0)])
    assert list(wind.times) == [0.0]
    assert wind.at(0.0) == 12.0


def test_in_wall_time_the_wind_is_late_by_one_and_a_half_intervals():
    assert inflow([(0.0, 8.0)]).delay == 0.0
    assert inflow([(0.0, 8.0), (0.1, 8.0)]).delay == pytest.approx(0.15)
    assert inflow([(0.0, 8.0), (600.0, 8.0)]).delay == 2.0
