"""Dispersion entropy against its definition and closed forms."""

from collections import Counter
from math import erf, log, sqrt

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.dispersion_entropy import dispersion_entropy
from test.monitor.chaotic import lorenz, shuffled


@pytest.mark.parametrize(("classes", "dimension", "lag"), [(6, 2, 1), (3, 3, 2), (5, 1, 1), (4, 4, 1)])
@pytest.mark.parametrize("x", [shuffled(700), lorenz(700)[:, 0]])
def test_the_definition(x, classes, dimension, lag):
    middle, spread = x.mean(), x.std()
    number = [round(classes * 0.5 * (1 + erf((value - middle) / spread / sqrt(2))) + 0.5) for value in x]
    size = x.size - (dimension - 1) * lag
    counts = Counter(tuple(number[i : i + (dimension - 1) * lag + 1 : lag]) for i in range(size))
    entropy = -sum(n / size * log(n / size) for n in counts.values())
    assert dispersion_entropy(x, classes, dimension, lag) == pytest.approx(entropy, abs=1e-12)
    share = dispersion_entropy(x, classes, dimension, lag, normalised=True)
    assert share == pytest.approx(entropy / log(classes**dimension), abs=1e-12)


def test_white_noise_has_all_patterns_alike():
    noise = np.random.default_rng(8).standard_normal(200_000)
    assert dispersion_entropy(noise, 6, 2) == pytest.approx(2 * log(6), abs=1e-3)
    assert dispersion_entropy(1e-9 * noise + 1e-7, 6, 2, normalised=True) == pytest.approx(1.0, abs=1e-3)


def test_a_square_wave_has_two_patterns():
    x = np.tile([-1.0, 1.0], 500)
    assert dispersion_entropy(x, 6, 2) == pytest.approx(log(2), abs=1e-5)


def test_weak_noise_hardly_counts():
    """Unlike in permutation entropy: the reason for the method."""
    x = np.sin(2 * np.pi * np.arange(8000) / 400)
    noise = 1e-3 * np.random.default_rng(9).standard_normal(8000)
    assert dispersion_entropy(x + noise) == pytest.approx(dispersion_entropy(x), rel=0.05)


def test_bad_input_is_refused():
    x = shuffled(100)
    for given, settings, expected in (
        (np.where(x > 0.9, np.nan, x), {}, "finite"),
        (np.where(x > 0.9, np.inf, x), {}, "finite"),
        (np.full(100, 3.0), {}, "constant"),
        (x[:4], {"dimension": 3, "lag": 2}, "at least 5"),
        (x, {"classes": 1}, "classes"),
        (x, {"classes": 100, "dimension": 6}, "patterns"),
        (x, {"lag": 0}, "lag"),
    ):
        with pytest.raises(InputError, match=expected):
            dispersion_entropy(given, **settings)
