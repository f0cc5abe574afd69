"""Points between samples."""

import numpy as np
import pytest

from nw_gear_monitor.pipeline import Pipeline
from nw_gear_monitor.signals.hermite import interpolate
from nw_gear_monitor.signals.section import section
from test.monitor.gear_signal import blocks, paper, waveform


def test_points_of_an_analytic_signal_are_exact_to_1e_6():
    step = 1 / 5120
    time = np.arange(5120) * step
    w = 2 * np.pi * 324.2
    phase = w * time + 0.7
    x, v = 3e-6 * np.cos(phase - 0.2), -3e-6 * w * np.sin(phase - 0.2)
    points = section(time, phase, x, v, at=0.5, low=0.0, high=5119.0)
    assert len(points) == 324
    assert points[:, 0] == pytest.approx((0.5 + 2 * np.pi * np.arange(1, 325) - 0.7) / w, abs=1e-12)
    inner = slice(1, -1)  # the ends are interpolated from two samples alone
    assert points[inner, 1] == pytest.approx(np.full(322, 3e-6 * np.cos(0.3)), rel=1e-6)
    assert points[inner, 2] == pytest.approx(np.full(322, -3e-6 * w * np.sin(0.3)), rel=1e-6)


def test_interpolation_is_exact_for_a_polynomial_of_degree_seven():
    t = np.arange(10.0)
    polynomial = np.polynomial.Polynomial([1.0, -2.0, 0.5, 0.3, -0.1, 0.02, -0.003, 0.0002])
    position = np.array([1.0, 2.25, 4.5, 6.75])
    x, v = interpolate(position, polynomial(t)[:, None], polynomial.deriv()(t)[:, None], 1.0)
    assert x[:, 0] == pytest.approx(polynomial(position), rel=1e-11)
    assert v[:, 0] == pytest.approx(polynomial.deriv()(position), rel=1e-10)


def test_a_phase_that_does_not_grow_has_no_points():
    still = np.zeros(100)
    assert len(section(np.arange(100.0), still, still, still, 0.0, 0.0, 99.0)) == 0


def test_streamed_sections_miss_no_point_and_repeat_none():
    """Stage II turns 99 times a second, each planet at its own shift of a third of a cycle."""
    pipeline = Pipeline(paper())
    hops = [hop for block in blocks(waveform(6.0)) for hop in pipeline.feed(block)]
    points = np.vstack([hop.sections["II"].data for hop in hops])
    f = paper().rated_frequency[1]
    for planet in (1, 2, 3):
        times = points[points[:, 1] == planet, 0]
        assert np.diff(times) == pytest.approx(np.full(times.size - 1, 1 / f), abs=1e-9)
        assert times.size == pytest.approx(6 * f, abs=1.01)
    shift = (points[points[:, 1] == 2, 0][5] - points[points[:, 1] == 1, 0][5]) * f % 1.0
    assert shift == pytest.approx(-paper().planet_phase["II_2"] / (2 * np.pi) % 1.0, abs=1e-6)
    on_planet_1 = points[points[:, 1] == 1]
    assert np.ptp(on_planet_1[2:-2, 2]) > 0  # other stages' lines: the section isn't one dot
