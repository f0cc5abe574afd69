"""Constant, step and the extreme operating gust, against the formula of IEC 61400-1 and a worked example."""

import math

import numpy as np
import pytest

from nw_gear_sim.physics.wind_deterministic import ConstantWind, StepWind
from nw_gear_sim.physics.wind_gust import DURATION, GustWind, gust_magnitude


def test_magnitude_of_the_standards_example() -> None:
    """Figure 2 of IEC 61400-1 ed. 3 (V_hub 25 m/s, class I A, D 42 m) rises to a little over 33 m/s (from memory)."""
    # By hand: sigma_1 = 0.16 (0.75 * 25 + 5.6) = 3.896; 3.3 * 3.896 / (1 + 0.1 * 42/42) = 11.688; 1.35 * 31 = 41.85.
    size = gust_magnitude(25.0, 50.0, 0.16, 42.0, 80.0)
    assert size == pytest.approx(11.688, abs=1e-9)
    assert 33.0 < GustWind(25.0, size, 0.0, 0.0).at(DURATION / 2) < 34.0


def test_magnitude_is_limited_by_the_wind_of_a_year() -> None:
    assert gust_magnitude(40.0, 37.5, 0.16, 42.0, 80.0) == pytest.approx(1.35 * (0.8 * 1.4 * 37.5 - 40.0))
    assert gust_magnitude(45.0, 37.5, 0.16, 42.0, 80.0) == 0.0


def test_low_hubs_have_a_shorter_scale() -> None:
    assert gust_magnitude(10.0, 50.0, 0.14, 20.0, 40.0) == pytest.approx(3.3 * 0.14 * 13.1 / (1 + 2.0 / 28.0))


def test_shape_of_the_gust() -> None:
    wind = GustWind(mean=12.0, magnitude=8.0, start=3.0, period=0.0)
    moments = np.linspace(0.0, 20.0, 40001)
    speeds = np.array([wind.at(t) for t in moments])
    assert speeds.max() == pytest.approx(12.0 + 0.74 * 8.0, abs=1e-6)
    assert moments[speeds.argmax()] == pytest.approx(3.0 + DURATION / 2, abs=1e-3)
    assert wind.at(3.0 + DURATION / 3) == pytest.approx(12.0)  # sin(pi) = 0
    # The dips: extrema of sin 3x (1 - cos 2x), found on a fine grid.
    x = np.linspace(0.0, math.pi, 100_001)
    deepest = float((np.sin(3.0 * x) * (1.0 - np.cos(2.0 * x))).max())
    assert speeds.min() == pytest.approx(12.0 - 0.37 * 8.0 * deepest, abs=1e-6)
    for t in (0.7, 2.0, 4.4):
        assert wind.at(3.0 + t) == pytest.approx(wind.at(3.0 + DURATION - t))
    outside = (moments < 3.0) | (moments > 3.0 + DURATION)
    assert (speeds[outside] == 12.0).all()
    # sin 3x (1 - cos 2x) = sin 3x - (sin 5x + sin x)/2, whose integral over 0..pi is 2/3 - (2/5 + 2)/2 = -8/15.
    area = float(np.trapezoid(speeds - 12.0, moments))
    assert area == pytest.approx(0.37 * 8.0 * (8.0 / 15.0) * DURATION / math.pi, rel=1e-5)


def test_gusts_repeat() -> None:
    wind = GustWind(mean=12.0, magnitude=8.0, start=5.0, period=30.0)
    for t in (5.0 + DURATION / 2, 7.3, 29.0):
        assert wind.at(t + 60.0) == pytest.approx(wind.at(t))
    assert wind.at(0.0) == 12.0  # no gust before the first


def test_a_gust_never_blows_backwards() -> None:
    wind = GustWind(mean=1.0, magnitude=8.0, start=0.0, period=0.0)
    assert min(wind.at(t) for t in np.linspace(0, DURATION, 500)) == 0.0


def test_constant_and_step() -> None:
    assert ConstantWind(7.5).at(1e6) == 7.5
    step = StepWind(before=8.0, after=12.0, time=10.0)
    assert [step.at(t) for t in (0.0, 9.999, 10.0, 11.0)] == [8.0, 8.0, 12.0, 12.0]
