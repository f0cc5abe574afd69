"""The Weibull process against the closed forms of its distribution and the theory of its correlation."""

import math

import numpy as np
import pytest
from scipy import integrate, special, stats

from nw_gear_sim.noise import CHUNK, GaussianNodes, cubic_weights, unit_variance_weights
from nw_gear_sim.physics.wind_weibull import WeibullWind, from_normal

SHAPE, SCALE, INTERVAL, TAU = 5.0, 11.5, 1.0, 10.0
MEAN = SCALE * special.gamma(1 + 1 / SHAPE)
VARIANCE = SCALE**2 * (special.gamma(1 + 2 / SHAPE) - special.gamma(1 + 1 / SHAPE) ** 2)


def correlation(rho: float) -> float:
    """Autocorrelation of the wind where that of the underlying normal numbers is rho, by Gauss-Hermite quadrature."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(60)
    weights = weights / math.sqrt(2 * math.pi)
    v = np.array([[from_normal(x, SHAPE, SCALE) for x in rho * a + math.sqrt(1 - rho**2) * nodes] for a in nodes])
    first = np.array([from_normal(a, SHAPE, SCALE) for a in nodes])
    return float((weights * first) @ v @ weights - MEAN**2) / VARIANCE


def effective_size(samples: int) -> float:
    """Number of independent samples worth as much for a mean as `samples` correlated ones, 1 s apart."""
    return samples / (1 + 2 * sum(correlation(math.exp(-lag / TAU)) for lag in range(1, 80)))


@pytest.fixture(scope="module")
def series() -> np.ndarray:
    """Two days of wind, at moments that aren't nodes, in steps of 1 s."""
    wind = WeibullWind(SHAPE, SCALE, INTERVAL, TAU, seed=7)
    return np.array([wind.at(i + 0.37) for i in range(2 * 86400)])


def test_figures_of_the_default_distribution() -> None:
    assert pytest.approx(10.56, abs=0.005) == MEAN
    assert math.sqrt(VARIANCE) == pytest.approx(2.42, abs=0.005)


@pytest.mark.parametrize("z", [-8.0, -3.0, -1e-9, 0.0, 0.5, 3.0, 8.0])
def test_map_from_normal_numbers_is_that_of_scipy(z: float) -> None:
    weibull = stats.weibull_min(SHAPE, scale=SCALE)
    expected = weibull.isf(stats.norm.sf(z)) if z > 0 else weibull.ppf(stats.norm.cdf(z))
    assert from_normal(z, SHAPE, SCALE) == pytest.approx(expected, rel=1e-9)


def test_mean_within_its_standard_error(series: np.ndarray) -> None:
    error = math.sqrt(VARIANCE / effective_size(len(series)))
    assert error < 0.03  # the test can tell 10.56 from 10.66
    assert abs(series.mean() - MEAN) < 3.5 * error


def test_deviation_and_share_above_rated(series: np.ndarray) -> None:
    size = effective_size(len(series))
    # Squares and indicators of the process decorrelate faster than it does: its effective size is on the safe side.
    kurtosis = float(stats.weibull_min.stats(SHAPE, moments="k")) + 3
    assert abs(series.var() - VARIANCE) < 4 * VARIANCE * math.sqrt((kurtosis - 1) / size)
    share = math.exp(-1.0)
    assert abs((series > SCALE).mean() - share) < 4 * math.sqrt(share * (1 - share) / size)


@pytest.mark.parametrize("moment", [0.0, 0.25, 0.5])
def test_distribution_is_weibull_at_and_between_the_draws(moment: float) -> None:
    wind = WeibullWind(SHAPE, SCALE, INTERVAL, TAU, seed=3)
    # Six correlation times apart the samples are as good as independent (correlation 0.0025).
    apart = np.array([wind.at(60.0 * i + moment) for i in range(4000)])
    assert stats.kstest(apart, stats.weibull_min(SHAPE, scale=SCALE).cdf).pvalue > 1e-3


@pytest.mark.parametrize("lag", [1, 5, 10, 20])
def test_autocorrelation(series: np.ndarray, lag: int) -> None:
    wind = WeibullWind(SHAPE, SCALE, INTERVAL, TAU, seed=11)
    values = np.array([wind.at(float(i)) for i in range(100_000)]) - MEAN
    found = float((values[lag:] * values[:-lag]).mean()) / VARIANCE
    # Bartlett: the variance of an autocorrelation estimate of exp(-lag/tau) is at most (1 + 2 tau/interval)/n.
    assert found == pytest.approx(correlation(math.exp(-lag / TAU)), abs=4 * math.sqrt((1 + 2 * TAU) / len(values)))


def test_half_way_between_draws_the_variance_would_fall_without_scaling() -> None:
    rho = math.exp(-INTERVAL / TAU)
    powers = rho ** np.abs(np.subtract.outer(np.arange(4), np.arange(4)))
    plain, scaled = np.array(cubic_weights(0.5)), np.array(unit_variance_weights(0.5, rho))
    assert plain @ powers @ plain < 0.99
    assert scaled @ powers @ scaled == pytest.approx(1.0, abs=1e-14)


def test_speed_and_slope_are_continuous_across_a_draw() -> None:
    wind = WeibullWind(SHAPE, SCALE, INTERVAL, TAU, seed=2)
    step = 1e-5
    for node in range(1, 30):
        before, at, after = (wind.at(node + s) for s in (-step, 0.0, step))
        assert abs(after - before) < 1e-3
        assert (at - before) / step == pytest.approx((after - at) / step, abs=1e-2)


def test_a_sample_depends_on_seed_and_time_alone() -> None:
    times = [0.0, 3.3, 5000.0, 2.0 * CHUNK, 1.1, 12345.6, 0.0]
    asked_in_disorder = WeibullWind(SHAPE, SCALE, INTERVAL, TAU, seed=5)
    fresh = [WeibullWind(SHAPE, SCALE, INTERVAL, TAU, seed=5).at(t) for t in times]
    assert [asked_in_disorder.at(t) for t in times] == fresh
    other = WeibullWind(SHAPE, SCALE, INTERVAL, TAU, seed=6)
    assert all(other.at(t) != v for t, v in zip(times, fresh, strict=True))


def test_memory_stays_the_same_on_a_long_run() -> None:
    nodes = GaussianNodes(1, 0.9)
    for node in range(0, 50 * CHUNK, CHUNK // 2):
        nodes[node]
    assert len(nodes._chunks) <= 2


def test_uncorrelated_draws_where_the_correlation_time_is_zero() -> None:
    wind = WeibullWind(SHAPE, SCALE, INTERVAL, 0.0, seed=1)
    values = np.array([wind.at(float(i)) for i in range(20_000)]) - MEAN
    assert abs((values[1:] * values[:-1]).mean() / VARIANCE) < 4 / math.sqrt(len(values))


def test_nodes_follow_their_recursion() -> None:
    rho = 0.8
    values = GaussianNodes(9, rho).take(0, 3 * CHUNK)
    fresh = np.random.Generator(np.random.PCG64(9)).standard_normal(3 * CHUNK)
    assert values[0] == fresh[0]
    np.testing.assert_allclose(values[1:] - rho * values[:-1], math.sqrt(1 - rho**2) * fresh[1:], atol=1e-12)


def test_distribution_function_integrates_the_density_of_equation_1() -> None:
    def density(v: float) -> float:
        return SHAPE / SCALE * (v / SCALE) ** (SHAPE - 1) * math.exp(-((v / SCALE) ** SHAPE))

    for z in (-1.0, 0.3, 2.0):
        probability, _error = integrate.quad(density, 0.0, from_normal(z, SHAPE, SCALE))
        assert probability == pytest.approx(stats.norm.cdf(z), abs=1e-9)
