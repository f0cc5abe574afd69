"""Repetition ratio and noise floor against closed forms; what judge() makes of them."""

import math

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_monitor.indicators.noise_floor import noise_floor
from nw_gear_monitor.indicators.repetition import change_after, common_period, detrended
from nw_gear_monitor.stage_state import Evidence, judge
from test.monitor.gear_signal import paper

RATE = 5120


def evidence(**values):
    base = {"seconds": 16, "rho": 0.01, "noise": 0.0, "repetition": 0.01, "tau": math.nan, "k": math.nan,
            "subharmonic_stage": "", "subharmonic_order": 1, "subharmonic_share": 0.0, "unlisted_order": 0.0,
            "deviation": 1e-6, "level": 1e-4, "speed_spread": 0.0, "speed_rate": 0.0, "load_spread": 0.0,
            "lines": 107}  # fmt: skip
    return Evidence(**(base | values))


def test_the_gearbox_repeats_after_five_turns_of_the_sun():
    frequency = paper().rated_frequency
    cycles = common_period(frequency) * frequency / frequency[0]
    assert cycles == pytest.approx([53.012, 200.0, 655.0], abs=1e-3)


def test_meshes_without_a_common_period_have_none():
    assert math.isnan(common_period(np.sqrt([2.0, 3.0, 5.0, 7.0, 11.0, 13.0])))


def ratio(noise, order=1.0):
    """R of a line at an order of the stage's phase with white noise, while the speed changes by 6 %."""
    time = np.arange(6 * RATE) / RATE
    turned = 2 * np.pi * np.cumsum(100.0 * (1 + 0.03 * np.sin(2 * np.pi * time / 5.0))) / RATE
    x = np.cos(order * turned) + noise * np.random.default_rng(4).standard_normal(time.size) + 0.5 * time
    v = np.gradient(np.cos(order * turned), 1 / RATE)
    change = change_after(turned, x[:, None], v[:, None], RATE, 2 * np.pi * 200, RATE)
    return 0.5 * change[0] / detrended(x[-RATE:, None]).var()


def test_a_locked_line_repeats_whatever_the_speed_does():
    assert ratio(0.0) < 1e-4


def test_white_noise_adds_its_share_of_the_variance():
    """The earlier sample is interpolated, which takes up to half of its noise away or leaves it whole."""
    share = 0.09 / (0.5 + 0.09)
    assert 0.7 * share < ratio(0.3) < 1.1 * share


@pytest.mark.parametrize(("order", "known"), [(1.00125, 1.0), (1.0025, 2.0), (1.0005, 1 - np.cos(0.2 * np.pi))])
def test_a_line_that_the_period_misses_reads_one_less_the_cosine_of_the_miss(order, known):
    assert ratio(0.0, order) == pytest.approx(known, rel=0.02)


def test_the_past_must_reach_back_far_enough():
    phase = np.linspace(0.0, 100.0, 2 * RATE)
    x = np.zeros((2 * RATE, 1))
    assert change_after(phase, x, x, RATE, 60.0, RATE) is None


@pytest.mark.parametrize("sd", [0.0, 0.1, 3.0])
def test_the_floor_is_the_variance_of_white_noise_beside_lines(sd):
    time = np.arange(RATE) / RATE
    noise = sd * np.random.default_rng(2).standard_normal((RATE, 2))
    x = noise + sum(np.cos(2 * np.pi * f * time) for f in (26.2, 99.0, 2301.0))[:, None]
    assert noise_floor(x) == pytest.approx(sd**2, rel=0.15, abs=1e-6)


def test_white_noise_alone_is_no_reason_for_chaos():
    assert judge("II", evidence(rho=0.4, noise=0.39, repetition=0.41, tau=0.0, k=0.99)).label == names.PERIODS[0]


@pytest.mark.parametrize(
    ("values", "label"),
    [
        ({"repetition": 0.3}, names.CHAOTIC),
        ({"repetition": math.nan}, names.CHAOTIC),
        ({"repetition": 0.01}, names.UNKNOWN),
        ({"repetition": 0.3, "load_spread": 3.0}, names.TRANSIENT),
        ({"repetition": 0.3, "load_spread": math.inf}, names.TRANSIENT),
        ({"repetition": 0.3, "speed_rate": 0.07}, names.TRANSIENT),
        ({"repetition": 0.3, "load_spread": 0.6, "speed_spread": 0.1}, names.CHAOTIC),
    ],
)
def test_an_irregular_residual_is_chaos_only_where_the_motion_does_not_repeat(values, label):
    assert judge("II", evidence(rho=0.3, tau=0.1, k=0.99, **values)).label == label


def test_lines_and_repetition_that_disagree_are_undecided_at_constant_speed():
    assert judge("II", evidence(repetition=0.3)).label == names.UNKNOWN
    assert judge("II", evidence(repetition=0.3, speed_spread=0.05)).label == names.PERIODS[0]
    third = evidence(repetition=0.3, subharmonic_order=3, subharmonic_stage="II")
    assert judge("II", third).label == names.PERIODS[2]
