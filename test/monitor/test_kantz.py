"""Kantz' exponent against its definition and against known exponents."""

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.embedding import embed
from nw_gear_monitor.indicators.kantz import kantz
from test.monitor.chaotic import henon, lorenz
from test.monitor.gear_signal import logistic


def by_definition(points, radius, theiler, horizon):
    size = len(points) - horizon
    logs = []
    for i in range(size):
        near = np.flatnonzero(np.linalg.norm(points[:size] - points[i], axis=1) <= radius)
        near = near[np.abs(near - i) > theiler]
        if near.size >= 5:
            means = [np.linalg.norm(points[near + k] - points[i + k], axis=1).mean() for k in range(horizon + 1)]
            logs.append(np.log(means))
    return np.mean(logs, axis=0), len(logs)


@pytest.mark.parametrize("units", [1.0, 1e-9])
@pytest.mark.parametrize(
    ("points", "radius", "theiler"), [(henon(600), 0.05, 3), (embed(lorenz(600)[:, 0], 3, 11), 2.0, 20)]
)
def test_the_definition(points, radius, theiler, units):
    curve, used = by_definition(points, radius, theiler, 12)
    found = kantz(units * points, radius=units * radius, theiler=theiler, horizon=12)
    assert found.references == used
    assert found.curve - np.log(units) == pytest.approx(curve, abs=1e-9)


def test_maps():
    """Logistic map at r = 4: ln 2; Hénon map: 0.41922 (Sprott)."""
    found = kantz(embed(logistic(4.0, 8192), 1), radius=1e-3, theiler=5, horizon=20)
    assert found.exponential
    assert found.exponent == pytest.approx(np.log(2.0), rel=0.02)
    found = kantz(henon(8192), radius=5e-3, theiler=5, horizon=20)
    assert found.exponential
    assert found.exponent == pytest.approx(0.41922, rel=0.06)


def test_a_flow():
    """Lorenz: 0.9056 (Sprott), after the first mean period."""
    found = kantz(embed(lorenz(16384)[:, 0], 5, 8), radius=0.4, theiler=75, horizon=300, rate=100.0, fit=(75, 240))
    assert found.exponent == pytest.approx(0.9056, rel=0.20)


def test_noise_does_not_move_the_exponent_while_it_is_smaller_than_the_radius():
    noise = 1e-2 * np.random.default_rng(5).standard_normal((8192, 2))
    found = kantz(henon(8192) + noise, radius=0.05, theiler=5, horizon=20)
    assert found.exponent == pytest.approx(0.41922, rel=0.15)


def test_what_does_not_part_exponentially_is_not_called_so():
    n = np.arange(4096)
    noise = np.random.default_rng(3).standard_normal(4096)
    sine, torus = np.sin(0.1234 * n), np.sin(0.1234 * n) + np.sin(0.1234 * np.sqrt(5.0) * n)
    for x in (noise, sine, sine + 0.07 * noise, torus):
        assert not kantz(embed(x, 3, 8), radius=0.3, theiler=60, horizon=200).exponential


def test_bad_input_is_refused():
    points = henon(400)
    for changed, settings, expected in (
        (np.where(points > 1.2, np.nan, points), {}, "finite"),
        (np.ones((400, 2)), {}, "points that differ"),
        (points[:30], {}, "at least 32 points"),
        (points, {"radius": 0.0}, "radius"),
        (points, {"radius": 1e-9}, "5 neighbours"),
        (points, {"radius": float("nan")}, "radius"),
        (points, {"most": 1}, "most"),
        (np.tile(points[:20], (20, 1)), {"radius": 1e-9}, "neighbours at a distance"),
    ):
        with pytest.raises(InputError, match=expected):
            kantz(changed, **{"radius": 0.1, "theiler": 5, "horizon": 20, **settings})
