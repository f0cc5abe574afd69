"""Delay vectors, strobed points, and the lengths that settings of chaos indicators are taken from."""

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.embedding import correlation_lag, embed, mean_period, points, strobed


def test_delay_vectors():
    assert embed(np.arange(6.0), 3, 2).tolist() == [[0.0, 2.0, 4.0], [1.0, 3.0, 5.0]]


def test_strobed_points_do_not_depend_on_units():
    x, v = np.random.default_rng(1).standard_normal((2, 50))
    assert strobed(1e-6 * x, 1e-3 * v) == pytest.approx(strobed(x, v))
    assert strobed(x, v).std(axis=0) == pytest.approx([1.0, 1.0])


def test_mean_period_and_lag_of_a_cosine():
    """The autocorrelation of a cosine is a cosine: 1 - 1/e is passed at arccos(1 - 1/e) / 2 pi = 0.141 of a period."""
    x = 3.0 + np.cos(2 * np.pi * np.arange(20_000) / 100)
    assert mean_period(x) in (100, 101)
    assert correlation_lag(x) == 15


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (np.full(50, np.nan), "finite"),
        (np.append(np.arange(50.0), np.inf), "inf at sample 50"),
        (np.ones(50), "a constant"),
        (np.arange(4.0), "at least 6 samples"),
        (np.ones((5, 5)), "one dimension"),
        (np.array(["a"]), "real numbers"),
    ],
)
def test_what_is_no_signal_is_refused(given, expected):
    with pytest.raises(InputError, match=expected):
        embed(given, 3, 2)


def test_what_are_no_points_is_refused():
    good = np.random.default_rng(1).standard_normal((50, 2))
    for given, expected in (
        (good[:, 0], "shape"),
        (good[:3], "at least 10 points"),
        (np.where(good > 2, np.nan, good), "coordinate .: expected finite"),
        (np.ones((50, 2)), "same point"),
    ):
        with pytest.raises(InputError, match=expected):
            points("points", given, 10)
    with pytest.raises(InputError, match="one value for each of 50 x"):
        strobed(good[:, 0], good[:49, 1])
    with pytest.raises(InputError, match="lag"):
        embed(good[:, 0], 2, 0)
