"""Rosenstein's exponent against known exponents and against nolds."""

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.embedding import embed, strobed
from nw_gear_monitor.indicators.rosenstein import rosenstein
from test.monitor.chaotic import henon, lorenz, peer, roessler
from test.monitor.gear_signal import logistic


@pytest.mark.parametrize("units", [1.0, 1e-9, 1e200])
def test_same_as_nolds(units):
    x = lorenz(1200)[:, 0]
    settings = {"emb_dim": 3, "lag": 11, "min_tsep": 75, "tau": 0.01, "trajectory_len": 200, "fit": "poly"}
    theirs, (_, curve, _) = peer().lyap_r(x, **settings, debug_data=True)
    ours = rosenstein(units * embed(x, 3, 11), theiler=75, horizon=199, rate=100.0, fit=(0, 199))
    assert ours.exponent == pytest.approx(theirs, rel=1e-9)
    assert ours.curve - np.log(units) == pytest.approx(curve, abs=1e-9)


def test_distances_of_zero_are_left_out_as_in_nolds():
    x = np.round(logistic(4.0, 600), 2)
    settings = {"emb_dim": 2, "lag": 1, "min_tsep": 2, "trajectory_len": 8, "fit": "poly"}
    ours = rosenstein(embed(x, 2), theiler=2, horizon=7, fit=(0, 7))
    assert ours.exponent == pytest.approx(peer().lyap_r(x, **settings), rel=1e-9)


def test_maps():
    """Logistic map at r = 4: ln 2; Hénon map: 0.41922 (Sprott, Chaos and Time-Series Analysis, 2003)."""
    found = rosenstein(embed(logistic(4.0, 4096), 1), theiler=5, horizon=20)
    assert found.exponential
    assert found.exponent == pytest.approx(np.log(2.0), rel=0.01)
    found = rosenstein(henon(4096), theiler=5, horizon=20)
    assert found.exponential
    assert found.exponent == pytest.approx(0.41922, rel=0.04)


def test_flows():
    """Lorenz 0.9056, Rössler 0.0714 (Sprott); the errors are those to be expected from so few samples."""
    found = rosenstein(embed(lorenz(16384)[:, 0], 5, 8), theiler=75, horizon=500, rate=100.0)
    assert found.exponential
    assert found.exponent == pytest.approx(0.9056, rel=0.10)
    found = rosenstein(embed(roessler(16384)[:, 0], 3, 28), theiler=120, horizon=500, rate=20.0, fit=(120, 500))
    assert found.exponential
    assert found.exponent == pytest.approx(0.0714, rel=0.15)


def test_a_sample_of_the_points_says_the_same():
    points = embed(lorenz(16384)[:, 0], 3, 11)
    settings = {"theiler": 75, "horizon": 300, "rate": 100.0}
    every, some = (rosenstein(points, **settings, references=wanted) for wanted in (None, 2000))
    assert some.references == 2000
    assert some.exponent == pytest.approx(every.exponent, rel=0.03)


def test_a_strobed_section():
    """The Hénon map is a section: same exponent from (x, v) in any units."""
    points = henon(4096)
    found = rosenstein(strobed(1e-6 * points[:, 0], 1e-3 * points[:, 1]), theiler=5, horizon=20)
    assert found.exponent == pytest.approx(0.41922, rel=0.04)


def test_what_does_not_part_exponentially_is_not_called_so():
    n = np.arange(4096)
    noise = np.random.default_rng(3).standard_normal(4096)
    sine, torus = np.sin(0.1234 * n), np.sin(0.1234 * n) + np.sin(0.1234 * np.sqrt(5.0) * n)
    for x, dimension in ((noise, 3), (sine, 3), (sine + 7e-4 * noise, 3), (sine + 0.07 * noise, 3), (torus, 5)):
        found = rosenstein(embed(x, dimension, 8), theiler=60, horizon=200)
        assert not found.exponential
    assert abs(rosenstein(embed(sine, 3, 8), theiler=60, horizon=200).exponent) < 1e-5


def test_bad_input_is_refused():
    points = henon(400)
    for changed, settings, expected in (
        (np.where(points > 1.2, np.nan, points), {}, "finite"),
        (np.where(points > 1.2, np.inf, points), {}, "finite"),
        (np.ones((400, 2)), {}, "points that differ"),
        (points[:30], {}, "at least 32 points"),
        (points, {"theiler": -1}, "theiler"),
        (points, {"theiler": 2.5}, "theiler"),
        (points, {"horizon": 1}, "horizon"),
        (points, {"rate": 0.0}, "rate"),
        (points, {"fit": (0, 21)}, "fit"),
        (points, {"fit": (5, 6)}, "fit"),
        (points, {"references": 0}, "references"),
        (np.tile(points[:20], (20, 1)), {}, "repeats itself exactly"),
    ):
        with pytest.raises(InputError, match=expected):
            rosenstein(changed, **{"theiler": 5, "horizon": 20, **settings})
