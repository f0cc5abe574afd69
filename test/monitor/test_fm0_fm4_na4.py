"""FM0, FM4 and NA4 against closed forms."""

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.fm0 import fm0
from nw_gear_monitor.indicators.fm4 import fm4
from nw_gear_monitor.indicators.na4 import na4
from nw_gear_monitor.signals.average import separate, synchronous_average

TEETH = 40
THETA = 2 * np.pi * np.arange(8192) / 8192
MESH = np.cos(TEETH * THETA)


def test_fm0_of_a_mesh_line_is_two_whatever_its_size():
    assert fm0(MESH, TEETH) == pytest.approx(2.0)
    assert fm0(1e-7 * MESH, TEETH) == pytest.approx(2.0)


def test_fm0_of_a_modulated_mesh_line():
    """(1 + m cos theta) cos(z theta): the highest value is 1 + m, the lowest lies half a tooth beside it."""
    m = 0.3
    height = 2.0 + m + m * np.cos(np.pi / TEETH)
    assert fm0((1 + m * np.cos(THETA)) * MESH, TEETH) == pytest.approx(height, rel=1e-4)


def test_fm0_sums_the_amplitudes_of_the_harmonics():
    """cos + cos/2 of twice the angle, in phase: from -3/4 to 3/2."""
    assert fm0(MESH + 0.5 * np.cos(2 * TEETH * THETA), TEETH) == pytest.approx(2.25 / 1.5, rel=1e-4)


def test_fm4_of_normal_noise_is_three():
    parts = separate(MESH + 0.1 * np.random.default_rng(3).standard_normal(THETA.size), TEETH)
    assert fm4(parts.difference, parts.regular) == pytest.approx(3.0, abs=5 * np.sqrt(24 / THETA.size))


@pytest.mark.parametrize("period", [2, 16, 1024])
def test_fm4_of_spikes(period):
    """Of the two values 0 and 1 with share p of ones: 1/(p (1 - p)) - 3."""
    p = 1.0 / period
    spikes = (np.arange(8192) % period == 0).astype(float)
    assert fm4(spikes) == pytest.approx(1.0 / (p * (1.0 - p)) - 3.0)
    assert fm4(1e-200 * spikes) == pytest.approx(1.0 / (p * (1.0 - p)) - 3.0)


def test_fm4_finds_one_damaged_tooth_that_the_kurtosis_of_the_average_misses():
    hurt = MESH * (1.0 - 0.5 * np.exp(-0.5 * ((THETA - np.pi) / 0.08) ** 2))
    parts = separate(hurt, TEETH)
    assert fm4(parts.difference, parts.regular) > 6.0
    assert fm4(hurt) < 2.0


def test_na4_of_one_record_is_its_kurtosis():
    r = np.random.default_rng(5).laplace(size=200_000)
    assert na4(r) == pytest.approx(fm4(r))
    assert na4(r) == pytest.approx(6.0, abs=0.3)  # kurtosis of the Laplace distribution


def test_na4_of_an_unchanged_normal_residual_is_three_and_rises_with_the_variance():
    records = np.random.default_rng(7).standard_normal((10, 100_000))
    earlier = [float(np.var(r)) for r in records[:-1]]
    assert na4(records[-1], earlier) == pytest.approx(3.0, abs=0.1)
    g = 4.0  # the variance of the last record over that of the others
    assert na4(2.0 * records[-1], earlier) == pytest.approx(3.0 * g**2 / ((9 + g) / 10) ** 2, rel=0.05)
    assert fm4(2.0 * records[-1]) == pytest.approx(3.0, abs=0.1)


def test_the_floor_holds_na4_down_where_the_residual_is_next_to_nothing():
    r = np.random.default_rng(9).standard_normal(50_000)
    assert na4(1e-3 * r, floor=1.0) == pytest.approx(3.0e-12, rel=0.1)
    assert na4(1e3 * r, floor=1.0) == pytest.approx(3.0, rel=0.1)


def test_from_samples_at_changing_speed_to_fm0():
    t = np.linspace(0.0, 1.0, 60_000)
    phase = 2 * np.pi * 30 * (0.9 * t + 0.1 * t * t)
    average = synchronous_average(phase, 2.0 * (1 + 0.3 * np.cos(phase)) * np.cos(TEETH * phase))
    assert fm0(average.values, TEETH) == pytest.approx(2.6, rel=2e-3)


@pytest.mark.parametrize("bad", [np.r_[np.nan, MESH], np.r_[np.inf, MESH], np.ones(8192), MESH[:4], MESH[None]])
def test_bad_input_is_refused(bad):
    for call in (lambda: fm0(bad, TEETH), lambda: fm4(bad), lambda: na4(bad)):
        with pytest.raises(InputError):
            call()


def test_what_isnt_there_gives_no_number():
    with pytest.raises(InputError, match="a line at 40 orders"):
        fm0(np.cos(7 * THETA), TEETH)
    with pytest.raises(InputError, match="beside the regular lines"):
        fm4(*(getattr(separate(MESH, TEETH), name) for name in ("difference", "regular")))
    for keywords in ({"earlier": [np.nan]}, {"earlier": [-1.0]}, {"floor": np.inf}, {"floor": -1.0}):
        with pytest.raises(InputError):
            na4(MESH, **keywords)
