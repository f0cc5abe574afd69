"""The tree against all distances."""

import numpy as np
import pytest

from nw_gear_monitor.indicators.neighbours import nearest


def among_all(points, references, window):
    gaps = np.sum((points[references, None] - points[None]) ** 2, axis=2)
    gaps[np.abs(references[:, None] - np.arange(len(points))) <= window] = np.inf
    return np.where(np.isfinite(gaps.min(axis=1)), gaps.argmin(axis=1), -1)


@pytest.mark.parametrize(
    ("size", "dimension", "window"), [(700, 1, 0), (700, 3, 40), (500, 7, 3), (13, 2, 0), (5, 2, 4)]
)
def test_the_nearest_of_all(size, dimension, window):
    points = np.random.default_rng(size).standard_normal((size, dimension))
    walk = np.cumsum(points, axis=0)  # neighbours in time are neighbours in space
    for cloud in (points, walk):
        for references in (np.arange(size), np.arange(0, size, 3)):
            assert np.array_equal(nearest(cloud, references, window), among_all(cloud, references, window))


def test_of_equals_the_first_is_taken():
    points = np.tile(np.arange(7.0), 40)[:, None]
    references = np.arange(280)
    assert np.array_equal(nearest(points, references, 10), among_all(points, references, 10))
