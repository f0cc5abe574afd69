"""The 0-1 test against its definition and against what its authors and others found."""

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.zero_one import zero_one, zero_one_test
from test.monitor.chaotic import henon, lorenz
from test.monitor.gear_signal import logistic

GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def by_definition(series):
    """Gottwald and Melbourne (2009), equations 2.1 to 3.4, with c spread by the golden ratio instead of at random."""
    size, lags = series.size, series.size // 10
    found = []
    for c in np.pi / 5 + 3 * np.pi / 5 * np.mod(GOLDEN * np.arange(1, 101), 1.0):
        j = np.arange(1, size + 1)
        p, q = np.cumsum(series * np.cos(j * c)), np.cumsum(series * np.sin(j * c))
        n = np.arange(1, lags + 1)
        walk = np.array(
            [np.mean((p[k:] - p[:-k])[: size - lags] ** 2 + (q[k:] - q[:-k])[: size - lags] ** 2) for k in n]
        )
        swing = series.mean() ** 2 * (1 - np.cos(n * c)) / (1 - np.cos(c))
        found.append(np.corrcoef(n, walk - swing)[0, 1])
    return np.percentile(found, [25, 50, 75])


@pytest.mark.parametrize("series", [logistic(4.0, 500), logistic(3.55, 500), 3.0 + henon(700)[:, 0]])
def test_the_definition(series):
    found = zero_one_test(series)
    assert [found.lower, found.k, found.upper] == pytest.approx(by_definition(series - series.mean()), abs=1e-6)
    assert zero_one(series) == pytest.approx(by_definition(series)[1], abs=1e-6)


@pytest.mark.parametrize(
    ("series", "low", "high"),
    [
        (logistic(4.0, 2000), 0.99, 1.0),
        (logistic(3.97, 2000), 0.97, 1.0),
        (henon(2000)[:, 0], 0.97, 1.0),
        (logistic(3.55, 2000), -0.02, 0.02),
        (np.cos(2 * np.pi * GOLDEN * np.arange(2000)), -0.02, 0.02),
    ],
    ids=["logistic 4", "logistic 3.97", "Hénon", "period 8", "golden torus"],
)
def test_known_motions(series, low, high):
    found = zero_one_test(series)
    assert low < found.k < high
    assert found.lower <= found.k <= found.upper


def test_its_two_known_failures():
    """Why it is never used alone: oversampled chaos reads as regular, a dot with a little noise as chaotic."""
    assert zero_one_test(lorenz(4000)[:, 0]).k < 0.2
    assert zero_one_test(1.0 + 1e-6 * np.random.default_rng(17).standard_normal(4000)).k > 0.9


def test_unit_and_offset_do_not_matter():
    series = logistic(4.0, 1000)
    assert zero_one_test(1e4 + series).k == pytest.approx(zero_one_test(series).k, abs=1e-6)
    assert zero_one_test(1e-200 * series).k == pytest.approx(zero_one_test(series).k, abs=1e-9)


def test_bad_input_is_refused():
    series = logistic(4.0, 300)
    for changed, expected in (
        (np.where(series > 0.99, np.nan, series), "finite"),
        (np.where(series > 0.99, np.inf, series), "finite"),
        (np.ones(300), "constant"),
        (series[:99], "at least 100"),
        (series.reshape(2, -1), "one dimension"),
    ):
        with pytest.raises(InputError, match=expected):
            zero_one_test(changed)
