"""Sample entropy against a closed form and against nolds and antropy."""

from math import erf, log

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.sample_entropy import sample_entropy
from test.monitor.chaotic import lorenz, peer, shuffled
from test.monitor.gear_signal import logistic


@pytest.mark.parametrize(("dimension", "lag"), [(2, 1), (1, 1), (3, 2), (2, 3)])
@pytest.mark.parametrize("x", [logistic(4.0, 900), lorenz(900)[:, 0], np.round(shuffled(900), 1)])
def test_same_as_nolds(x, dimension, lag):
    theirs = peer().sampen(x, emb_dim=dimension, lag=lag, tolerance=0.2 * np.std(x))
    assert sample_entropy(x, dimension, 0.2, lag) == pytest.approx(theirs, rel=1e-12)


def test_white_noise():
    """-ln erf(0.1) = 2.1851 at 0.2 sd: the chance that two normal values differ by less."""
    noise = np.random.default_rng(6).standard_normal(20_000)
    assert sample_entropy(noise) == pytest.approx(-log(erf(0.1)), abs=0.02)
    assert sample_entropy(1e-9 * noise + 1e-9) == pytest.approx(sample_entropy(noise), rel=1e-3)


def test_regular_signals_have_little():
    assert sample_entropy(np.sin(0.1234 * np.arange(5000))) < 0.3
    assert sample_entropy(np.sin(0.01234 * np.arange(5000))) < 0.1


def test_bad_input_is_refused():
    x = shuffled(100)
    for given, settings, expected in (
        (np.where(x > 0.9, np.nan, x), {}, "finite"),
        (np.where(x > 0.9, -np.inf, x), {}, "finite"),
        (np.full(100, 3.0), {}, "constant"),
        (x[:3], {}, "at least 4"),
        (2.0 ** np.arange(20), {"tolerance": 1e-9}, "0 such pairs"),
        (x, {"dimension": 0}, "dimension"),
        (x, {"lag": 0}, "lag"),
        (x, {"tolerance": -1.0}, "tolerance"),
    ):
        with pytest.raises(InputError, match=expected):
            sample_entropy(given, **settings)
