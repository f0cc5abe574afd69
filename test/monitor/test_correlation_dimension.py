"""Correlation dimension against nolds and against known dimensions."""

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.correlation_dimension import correlation_dimension
from nw_gear_monitor.indicators.embedding import embed
from test.monitor.chaotic import henon, lorenz, peer, roessler


@pytest.mark.parametrize("units", [1.0, 1e-9])
def test_same_pairs_as_nolds(units):
    """nolds 0.6.2 counts each point as its own pair as well, and leaves out no neighbours in time."""
    x = lorenz(900)[:, 0]
    radii = np.std(x) * np.geomspace(0.1, 0.5, 30)
    _, (_, logs, _) = peer().corr_dim(x, 3, lag=11, rvals=radii, fit="poly", debug_data=True)
    size = 900 - 22
    without = np.exp(logs) - 1.0 / (size - 1)
    found = correlation_dimension(units * embed(x, 3, 11), theiler=0, radii=units * radii)
    assert found.sums == pytest.approx(without, rel=1e-9)
    assert found.dimension == pytest.approx(np.polyfit(np.log(radii), np.log(without), 1)[0], rel=1e-9)


def test_the_window():
    points = np.round(np.cumsum(np.random.default_rng(11).standard_normal((300, 2)), axis=0), 1)
    radii = np.array([0.5, 1.0, 2.0, 4.0])
    gaps = np.linalg.norm(points[:, None] - points[None], axis=2)
    i, j = np.triu_indices(300, 21)
    found = correlation_dimension(points, theiler=20, radii=radii)
    assert found.pairs == i.size
    assert found.sums == pytest.approx([np.mean(gaps[i, j] <= r) for r in radii], rel=1e-12)


def test_sets_of_known_dimension():
    """Sprott (2003): Hénon 1.220 ± 0.036, Lorenz 2.068 ± 0.086, Rössler 1.991 ± 0.065."""
    assert correlation_dimension(henon(16384), theiler=5).dimension == pytest.approx(1.220, abs=0.036)
    assert correlation_dimension(lorenz(65536)[::4], theiler=20).dimension == pytest.approx(2.068, abs=0.086)
    assert correlation_dimension(roessler(65536)[::4], theiler=30).dimension == pytest.approx(1.991, abs=0.065)


def test_cycle_and_torus():
    a, b = 2.0 * np.pi * np.random.default_rng(14).random((2, 8192))
    cycle, torus = (
        np.column_stack([np.cos(a), np.sin(a)]),
        np.column_stack([np.cos(a), np.sin(a), np.cos(b), np.sin(b)]),
    )
    assert correlation_dimension(cycle, theiler=0).dimension == pytest.approx(1.0, abs=0.02)
    assert correlation_dimension(torus, theiler=0).dimension == pytest.approx(2.0, abs=0.06)


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_white_noise_fills_the_space(dimension):
    noise = np.random.default_rng(12).standard_normal((8192, dimension))
    found = correlation_dimension(noise, theiler=1)
    assert found.dimension == pytest.approx(dimension, rel=0.03)
    assert found.steepest - found.flattest < 0.1 * dimension


def test_the_window_takes_away_what_is_only_near_in_time():
    """A random walk sampled finely looks like a line without the window."""
    walk = np.cumsum(np.random.default_rng(13).standard_normal((3000, 3)), axis=0)
    radii = np.geomspace(2.0, 8.0, 10)
    near = correlation_dimension(walk, theiler=0, radii=radii).sums
    assert np.all(near > 1.5 * correlation_dimension(walk, theiler=100, radii=radii).sums)


def test_bad_input_is_refused():
    points = henon(300)
    for changed, settings, expected in (
        (np.where(points > 1.2, np.nan, points), {}, "finite"),
        (np.ones((300, 2)), {}, "points that differ"),
        (points[:7], {}, "at least 8"),
        (points[:12], {}, "radii with pairs"),
        (points, {"theiler": -1}, "theiler"),
        (points, {"radii": np.array([0.1, 0.2])}, "radii"),
        (points, {"radii": np.array([0.1, 0.3, 0.2])}, "increasing"),
        (points, {"radii": np.array([0.0, 0.3, 0.4])}, "above zero"),
        (points, {"radii": np.array([1e-9, 2e-9, 3e-9])}, "0 of 3"),
    ):
        with pytest.raises(InputError, match=expected):
            correlation_dimension(changed, **{"theiler": 5, **settings})
