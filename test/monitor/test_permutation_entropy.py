"""Permutation entropy against closed forms and against antropy."""

import itertools
from math import factorial, log2

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.permutation_entropy import permutation_entropy
from test.monitor.chaotic import shuffled
from test.monitor.gear_signal import logistic

ANTROPY = {(3, 1): 2.582003322686389, (4, 1): 4.575103669728394, (5, 2): 6.858631178323661, (6, 1): 9.219083439461071}
"""perm_entropy of antropy 0.2.3 by (order, delay): shuffled(2000) rounded to 2 digits."""


@pytest.mark.parametrize(("order", "lag"), ANTROPY)
def test_same_as_antropy(order, lag):
    x = np.round(shuffled(2000), 2)
    assert permutation_entropy(x, order, lag) == pytest.approx(ANTROPY[order, lag], abs=1e-9)


@pytest.mark.parametrize(("order", "lag"), [(2, 1), (3, 1), (4, 2), (6, 3)])
def test_the_definition(order, lag):
    x = np.round(np.random.default_rng(order).standard_normal(300), 1)  # with equal values
    size = x.size - (order - 1) * lag
    found = [tuple(np.argsort(x[i : i + (order - 1) * lag + 1 : lag], kind="stable")) for i in range(size)]
    share = np.array([found.count(p) for p in itertools.permutations(range(order))]) / size
    share = share[share > 0]
    assert permutation_entropy(x, order, lag) == pytest.approx(-np.sum(share * np.log2(share)), abs=1e-12)


@pytest.mark.parametrize("order", [2, 3, 4, 5])
def test_white_noise_has_all_patterns_alike(order):
    noise = np.random.default_rng(7).standard_normal(100_000)
    assert permutation_entropy(noise, order) == pytest.approx(log2(factorial(order)), abs=2e-3)
    assert permutation_entropy(noise, order, normalised=True) == pytest.approx(1.0, abs=1e-3)


def test_the_logistic_map():
    """Order 3 at r = 4: x = sin^2 u, u uniform; the patterns have 1/3, 1/15, 4/15, 2/15, 1/5 and 0: 2.14926 bits."""
    share = np.array([1 / 3, 1 / 15, 4 / 15, 2 / 15, 1 / 5])
    exact = -np.sum(share * np.log2(share))
    assert exact == pytest.approx(2.14926, abs=1e-5)
    assert permutation_entropy(logistic(4.0, 100_000)) == pytest.approx(exact, abs=5e-3)


def test_what_always_rises_has_none():
    assert permutation_entropy(np.arange(100.0), 4) == 0.0


def test_bad_input_is_refused():
    x = shuffled(100)
    for given, settings, expected in (
        (np.where(x > 0.9, np.nan, x), {}, "finite"),
        (np.full(100, 3.0), {}, "constant"),
        (x[:6], {"order": 4, "lag": 2}, "at least 7"),
        (x, {"order": 1}, "order"),
        (x, {"order": 9}, "2 to 8"),
        (x, {"lag": 0}, "lag"),
    ):
        with pytest.raises(InputError, match=expected):
            permutation_entropy(given, **settings)
