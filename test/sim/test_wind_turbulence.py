"""Wind from measured series and statistics: what was measured must be what is drawn."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from nw_gear_sim.physics.wind_series import SeriesWind
from nw_gear_sim.physics.wind_turbulence import TRANSITION, TurbulentWind

MAST = Path(__file__).parents[1] / "data" / "mast_wind_10min.csv"
INTERVAL = 600.0


def mast(rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Means and deviations of the first rows of the mast, read with nothing of the project's."""
    with MAST.open(newline="") as stream:
        values = [(float(r["wind_speed_mean"]), float(r["wind_speed_std"])) for r in csv.DictReader(stream)][:rows]
    means, deviations = np.array(values).T
    return means, deviations


def drawn(wind: TurbulentWind, intervals: int) -> np.ndarray:
    """The wind once a second, shape (intervals, 600)."""
    return np.array([wind.at(float(t)) for t in range(int(INTERVAL) * intervals)]).reshape(intervals, -1)


def test_mean_and_deviation_of_every_measured_interval_are_kept() -> None:
    means, deviations = mast(48)
    wind = TurbulentWind(means, deviations, INTERVAL, 10.0, seed=4, loop=False)
    speeds = drawn(wind, 48)
    np.testing.assert_allclose(speeds.mean(axis=1), means, atol=1e-9)
    np.testing.assert_allclose(speeds.std(axis=1), deviations, atol=1e-9)
    assert wind.exceeded == 0


def test_there_is_no_jump_between_intervals() -> None:
    means, deviations = np.array([6.0, 12.0, 7.0]), np.array([1.0, 1.5, 1.2])
    wind = TurbulentWind(means, deviations, INTERVAL, 10.0, seed=1, loop=False)
    fine = np.array([wind.at(t) for t in np.arange(590.0, 610.0, 0.01)])
    inside = np.array([wind.at(t) for t in np.arange(290.0, 310.0, 0.01)])
    assert abs(np.diff(fine)).max() < 4 * abs(np.diff(inside)).max()
    assert abs(np.diff(fine)).max() < 0.06


def test_correlation_time_within_an_interval() -> None:
    wind = TurbulentWind(np.full(60, 10.0), np.full(60, 1.0), INTERVAL, 10.0, seed=8, loop=False)
    noise = drawn(wind, 60)[:, int(TRANSITION) : -int(TRANSITION)] - 10.0
    # Fixing mean and deviation of an interval takes about 2 tau/T = 0.033 off the correlation at all lags.
    for lag in (1, 5, 10, 20):
        found = float((noise[:, lag:] * noise[:, :-lag]).mean())
        assert found == pytest.approx(math.exp(-lag / 10.0), abs=0.06)


def test_noise_is_gaussian_in_between() -> None:
    wind = TurbulentWind(np.full(60, 10.0), np.full(60, 1.0), INTERVAL, 10.0, seed=9, loop=False)
    noise = drawn(wind, 60).ravel() - 10.0
    size = noise.size / 20.0  # effective number of samples at a correlation time of 10 s
    assert abs((noise**3).mean()) < 4 * math.sqrt(6 / size)
    assert abs((noise**4).mean() - 3.0) < 4 * math.sqrt(24 / size)


def test_calm_intervals_are_calm() -> None:
    wind = TurbulentWind(np.array([5.0, 5.0]), np.array([0.0, 0.0]), INTERVAL, 10.0, seed=1, loop=False)
    np.testing.assert_allclose(drawn(wind, 2), 5.0, atol=1e-12)


def test_an_impossible_deviation_is_counted_and_the_mean_kept() -> None:
    means = np.array([5.0, 15.0, 5.0])
    wind = TurbulentWind(means, np.zeros(3), INTERVAL, 10.0, seed=1, loop=False)
    speeds = drawn(wind, 3)
    assert wind.exceeded == 3
    np.testing.assert_allclose(speeds.mean(axis=1), means, atol=1e-9)
    assert (speeds.std(axis=1) < 1.2).all()


def test_negative_wind_is_never_drawn() -> None:
    wind = TurbulentWind(np.array([0.5]), np.array([0.6]), INTERVAL, 10.0, seed=1, loop=False)
    assert drawn(wind, 3).min() == 0.0


def test_last_interval_holds_or_the_first_follows() -> None:
    means, deviations = np.array([5.0, 10.0]), np.array([0.5, 1.0])
    hold = drawn(TurbulentWind(means, deviations, INTERVAL, 10.0, seed=1, loop=False), 4)
    loop = drawn(TurbulentWind(means, deviations, INTERVAL, 10.0, seed=1, loop=True), 4)
    np.testing.assert_allclose(hold.mean(axis=1), [5, 10, 10, 10], atol=1e-9)
    np.testing.assert_allclose(loop.mean(axis=1), [5, 10, 5, 10], atol=1e-9)
    assert abs(loop[0] - loop[2]).max() > 0.1  # the turbulence goes on, it doesn't repeat


def test_a_sample_depends_on_seed_and_time_alone() -> None:
    means, deviations = mast(20)
    times = [0.0, 599.9, 600.0, 9000.5, 1200.0, 3.3]

    def make(seed: int) -> TurbulentWind:
        return TurbulentWind(means, deviations, INTERVAL, 10.0, seed, loop=False)

    wind = make(5)
    assert [wind.at(t) for t in times] == [make(5).at(t) for t in times]
    assert make(6).at(100.0) != wind.at(100.0)


@pytest.mark.parametrize(("time", "speed"), [(0.0, 4.0), (0.5, 5.0), (1.0, 6.0), (3.0, 7.0), (5.0, 8.0), (99.0, 8.0)])
def test_series_is_followed_in_straight_lines_and_its_end_holds(time: float, speed: float) -> None:
    wind = SeriesWind(np.array([0.0, 1.0, 5.0]), np.array([4.0, 6.0, 8.0]), loop=False, interval=1.0)
    assert wind.at(time) == pytest.approx(speed)


def test_series_begins_again_one_interval_after_its_end() -> None:
    wind = SeriesWind(np.array([0.0, 1.0, 2.0]), np.array([4.0, 6.0, 8.0]), loop=True, interval=1.0)
    assert [wind.at(t) for t in (2.0, 2.5, 3.0, 4.0, 7.0)] == pytest.approx([8.0, 6.0, 4.0, 6.0, 6.0])
