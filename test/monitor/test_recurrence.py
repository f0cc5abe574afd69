"""Recurrence quantification against its definition, AccRQA and closed forms."""

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.embedding import embed
from nw_gear_monitor.indicators.recurrence import recurrence
from test.monitor.chaotic import henon, shuffled

ACCRQA = {
    (1, 1, 2, 0.1, "maximum"): [
        0.344498359831,
        2.26345326218,
        7,
        0.591398880643,
        0.190834,
        0.34305731683,
        2.26631356666,
    ],
    (1, 3, 2, 0.2, "maximum"): [
        0.603674865076,
        2.66152029788,
        11,
        1.02977539074,
        0.0487407681094,
        0.117496807152,
        2.31493506494,
    ],
    (1, 3, 2, 0.2, "euclidean"): [
        0.495944879064,
        2.56353181228,
        8,
        0.81083470114,
        0.0279777992859,
        0.0629799755975,
        2.2821846554,
    ],
    (2, 2, 3, 0.1, "maximum"): [
        0.044197103955,
        8.30456852792,
        5,
        0.649501650003,
        0.0371645093795,
        0.00640263669764,
        3.03846153846,
    ],
    (2, 2, 3, 0.1, "euclidean"): [
        0.0449136018288,
        12.4859813084,
        5,
        0.557436987998,
        0.0298653419063,
        0.00352988637128,
        3.0,
    ],
}
"""DET, L, Lmax, ENTR, RR, LAM, TT of AccRQA 1.0.3: shuffled(1000) by delay, embedding, least line, threshold, norm."""


@pytest.mark.parametrize("case", ACCRQA)
def test_same_as_accrqa(case):
    lag, dimension, least, radius, norm = case
    found = recurrence(embed(shuffled(1000), dimension, lag), radius=radius, theiler=None, least=least, norm=norm)
    ours = [
        found.determinism,
        found.mean_diagonal,
        found.longest_diagonal,
        found.entropy,
        found.rate,
        found.laminarity,
        found.trapping_time,
    ]
    assert ours == pytest.approx(ACCRQA[case], rel=1e-9)


def runs(line):
    edges = np.flatnonzero(np.diff(np.concatenate([[0], line.astype(int), [0]])))
    return list(edges[1::2] - edges[::2])


@pytest.mark.parametrize("norm", ["maximum", "euclidean"])
@pytest.mark.parametrize(("theiler", "least"), [(0, 2), (5, 3)])
def test_the_definition(theiler, least, norm):
    points = np.round(np.cumsum(np.random.default_rng(15).standard_normal((150, 2)), axis=0), 1)
    gaps = points[:, None] - points[None]
    distance = np.abs(gaps).max(axis=2) if norm == "maximum" else np.sqrt((gaps**2).sum(axis=2))
    apart = np.abs(np.subtract.outer(np.arange(150), np.arange(150))) > theiler
    matrix = (distance <= 1.5) & apart
    diagonals = np.array([n for k in range(-149, 150) for n in runs(np.diagonal(matrix, k))])
    verticals = np.array([n for column in matrix.T for n in runs(column)])
    long = diagonals[diagonals >= least]
    share = np.unique(long, return_counts=True)[1] / long.size
    found = recurrence(points, radius=1.5, theiler=theiler, least=least, norm=norm)
    assert found.rate == pytest.approx(matrix.sum() / apart.sum())
    assert found.determinism == pytest.approx(long.sum() / matrix.sum())
    assert found.laminarity == pytest.approx(verticals[verticals >= least].sum() / matrix.sum())
    assert found.entropy == pytest.approx(-np.sum(share * np.log(share)))
    assert found.mean_diagonal == pytest.approx(long.mean())
    assert found.longest_diagonal == diagonals.max()
    assert found.trapping_time == pytest.approx(verticals[verticals >= least].mean())


def test_white_noise():
    """A recurrent point is alone on its diagonal with the chance (1 - RR)^2; columns are alike."""
    noise = np.random.default_rng(16).random((4000, 1))
    found = recurrence(noise, radius=0.05, theiler=0)
    assert found.rate == pytest.approx(2 * 0.05 - 0.05**2, rel=0.02)
    assert found.determinism == pytest.approx(1.0 - (1.0 - found.rate) ** 2, rel=0.02)
    assert found.laminarity == pytest.approx(1.0 - (1.0 - found.rate) ** 2, rel=0.02)


def test_a_sine_is_determined():
    x = np.sin(2 * np.pi * np.arange(2000) / 100)
    found = recurrence(embed(x, 2, 25), radius=0.01, theiler=0)
    assert found.determinism == pytest.approx(1.0, abs=1e-3)
    assert found.longest_diagonal == 2000 - 25 - 100


def test_it_does_not_depend_on_units():
    points = henon(800)
    assert recurrence(1e-9 * points, radius=1e-10, theiler=0) == recurrence(points, radius=0.1, theiler=0)


def test_bad_input_is_refused():
    points = henon(300)
    for changed, settings, expected in (
        (np.where(points > 1.2, np.nan, points), {}, "finite"),
        (np.where(points > 1.2, np.inf, points), {}, "finite"),
        (np.ones((300, 2)), {}, "points that differ"),
        (points[:4], {"theiler": 2}, "at least 5"),
        (points, {"theiler": -1}, "theiler"),
        (points, {"radius": 0.0}, "radius"),
        (points, {"radius": 1e-12}, "come back"),
        (points, {"least": 1}, "least"),
        (points, {"norm": "city"}, "norm"),
    ):
        with pytest.raises(InputError, match=expected):
            recurrence(changed, **{"theiler": 0, "radius": 0.1, **settings})
