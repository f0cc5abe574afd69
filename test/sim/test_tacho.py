"""Pulses of a tacho against the times at which a closed form passes the marks."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from nw_gear_common.errors import InputError
from nw_gear_sim.sensors.tacho import Tacho

RATE = 20480.0
TURN = 2 * math.pi
W, A, DEPTH, TWIST = 100.0, 3.0, 2e-4, TURN * 324.0
"""Speed (rad/s), acceleration (rad/s^2), amplitude (rad) and frequency (rad/s) of a torsional vibration."""


def angle(t):
    return 0.3 + W * t + 0.5 * A * t * t + DEPTH * np.sin(TWIST * t)


def speed(t):
    return W + A * t + DEPTH * TWIST * np.cos(TWIST * t)


def pulses(count: int, seconds: float, cuts: list[int] | None = None) -> np.ndarray:
    time = np.arange(int(seconds * RATE)) / RATE
    tacho = Tacho(count)
    parts = [tacho.advance(t, angle(t), speed(t)) for t in np.split(time, sorted(set(cuts or []))) if len(t)]
    return np.concatenate(parts)


@pytest.mark.parametrize("count", [1, 60, 777])
def test_pulses_come_when_the_angle_passes_the_marks(count: int) -> None:
    found = pulses(count, 2.0)
    last = (int(2.0 * RATE) - 1) / RATE
    marks = np.arange(math.floor(0.3 * count / TURN) + 1, math.floor(angle(last) * count / TURN) + 1)
    exact = [brentq(lambda t, m=m: angle(t) - m * TURN / count, 0.0, 2.0, xtol=1e-15, rtol=1e-14) for m in marks]
    assert len(found) == len(exact)
    assert np.abs(found - exact).max() < 1e-9


def test_a_chirp_is_exact() -> None:
    """theta = w t + a t^2 / 2 passes 2 pi k at (sqrt(w^2 + 4 pi k a) - w) / a."""
    time = np.arange(0, 3.0, 1 / 5120.0)
    found = Tacho(1).advance(time, W * time + 0.5 * A * time**2, W + A * time)
    k = np.arange(1, len(found) + 1)
    assert len(found) == math.floor((W * time[-1] + 0.5 * A * time[-1] ** 2) / TURN)
    assert np.abs(found - (np.sqrt(W * W + 2 * TURN * k * A) - W) / A).max() < 1e-12


@settings(max_examples=30, deadline=None)
@given(st.lists(st.integers(1, 4095), max_size=10), st.sampled_from([1, 60, 5000]))
def test_pulses_dont_depend_on_how_samples_are_cut(cuts: list[int], count: int) -> None:
    assert np.array_equal(pulses(count, 0.2), pulses(count, 0.2, cuts))


def test_a_shaft_that_swings_about_a_mark_gives_one_pulse() -> None:
    time = np.arange(0, 2.0, 1 / RATE)
    swing = 0.5 + 0.6 * time + 0.3 * np.sin(20 * time)
    tacho = Tacho(6)
    found = tacho.advance(time, swing, 0.6 + 6 * np.cos(20 * time))
    marks = np.arange(1, math.floor(swing.max() * 6 / TURN) + 1) * TURN / 6
    assert len(found) == len(marks) == 1
    assert swing[time < found[0]].max() < marks[0]
    assert np.interp(found[0], time, swing) == pytest.approx(marks[0], abs=1e-6)


def test_a_shaft_at_rest_or_turning_back_gives_none() -> None:
    time = np.arange(0, 1.0, 1 / RATE)
    assert not Tacho(60).advance(time, np.full_like(time, TURN), np.zeros_like(time)).size
    assert not Tacho(60).advance(time, -5 * time, np.full_like(time, -5.0)).size


@pytest.mark.parametrize("start", [0.0, TURN / 6, 3 * TURN / 6, -7 * TURN / 6, 1e5])
def test_a_shaft_that_stands_on_a_mark_and_then_turns(start: float) -> None:
    """At rest for a second, then half a turn: the mark it stands on doesn't count, the next three do."""
    time = np.arange(0, 2.0, 1 / RATE)
    moving = np.maximum(time - 1.0, 0.0)
    tacho, pieces = Tacho(6), np.split(np.arange(time.size), range(9, time.size, 997))
    found = np.concatenate([tacho.advance(time[k], start + 3.3 * moving[k], 3.3 * (moving[k] > 0)) for k in pieces])
    marks = np.arange(np.floor(start * 6 / TURN + 1e-9) + 1, np.floor((start + 3.3) * 6 / TURN) + 1) * TURN / 6
    assert found == pytest.approx(1.0 + (marks - start) / 3.3, abs=1e-4)


def test_a_checkpoint_goes_on_bit_for_bit() -> None:
    time = np.arange(int(0.5 * RATE)) / RATE
    first, second = Tacho(60), Tacho(60)
    first.advance(time[:3333], angle(time[:3333]), speed(time[:3333]))
    second.restore(first.state())
    rest = time[3333:]
    expected = first.advance(rest, angle(rest), speed(rest))
    assert expected.size > 200
    assert np.array_equal(second.advance(rest, angle(rest), speed(rest)), expected)
    with pytest.raises(InputError, match="tacho"):
        second.restore({"last": np.zeros(2), "next": 3, "pulses": 60})
    with pytest.raises(InputError, match="expected 1 pulses, got 60"):
        Tacho(1).restore(first.state())
    second.forget()
    assert second.advance(time, angle(time), speed(time))[0] < 0.01
