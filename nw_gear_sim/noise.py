"""Correlated Gaussian noise that is a function of its seed and of time: the common ground of the random winds.

A stationary first-order autoregressive process (an Ornstein-Uhlenbeck process seen at regular nodes) and the weights
that interpolate smoothly between the nodes without touching mean and variance.
"""

from __future__ import annotations

import math

import numpy as np

from nw_gear_common.tables import Array

CHUNK = 1024


class GaussianNodes:
    """A stationary Gaussian process of zero mean and unit variance at the nodes 0, 1, 2, ...

    z_0 = e_0, z_j = rho z_(j-1) + sqrt(1 - rho^2) e_j with independent standard normal e_j, hence an autocorrelation of
    exactly rho^|lag|. Numbers come from numpy's PCG64, so that a node is a function of seed and number whatever was
    asked for before. Two chunks of nodes are kept; going back further draws again from the start.

    Args:
        seed: whole number >= 0.
        correlation: rho, correlation of neighbouring nodes, 0 <= rho < 1.
    """

    def __init__(self, seed: int, correlation: float) -> None:
        self._seed = seed
        self._rho = correlation
        self._restart()

    def _restart(self) -> None:
        self._random = np.random.Generator(np.random.PCG64(self._seed))
        self._last: float | None = None
        self._chunks: dict[int, Array] = {}
        self._count = 0

    def __getitem__(self, node: int) -> float:
        wanted, place = divmod(node, CHUNK)
        if wanted not in self._chunks and wanted < self._count:
            self._restart()
        while wanted >= self._count:
            self._draw()
        return float(self._chunks[wanted][place])

    def take(self, first: int, count: int) -> Array:
        """Return the nodes first, first + 1, ... as an array of shape (count,)."""
        return np.array([self[node] for node in range(first, first + count)])

    def _draw(self) -> None:
        fresh = self._random.standard_normal(CHUNK)
        share = math.sqrt(1.0 - self._rho**2)
        chunk = np.empty(CHUNK)
        last = self._last
        for i in range(CHUNK):
            last = float(fresh[i]) if last is None else self._rho * last + share * float(fresh[i])
            chunk[i] = last
        self._last = last
        self._chunks.pop(self._count - 2, None)
        self._chunks[self._count] = chunk
        self._count += 1


def cubic_weights(share: float) -> tuple[float, float, float, float]:
    """Catmull-Rom weights of the nodes -1, 0, 1, 2 at 0 <= share < 1 of the way from node 0 to node 1; sum 1."""
    s, s2, s3 = share, share**2, share**3
    return (
        0.5 * (-s + 2.0 * s2 - s3),
        0.5 * (2.0 - 5.0 * s2 + 3.0 * s3),
        0.5 * (s + 4.0 * s2 - 3.0 * s3),
        0.5 * (-s2 + s3),
    )


def unit_variance_weights(share: float, correlation: float) -> tuple[float, float, float, float]:
    """Cubic weights, scaled so that the interpolated process has unit variance between the nodes as well.

    The variance of sum w_i z_i is w^T R w with R_ij = rho^|i-j|; dividing by its root keeps a Gaussian process standard
    normal at every moment, so that a marginal distribution made from it holds everywhere and not at the nodes alone.
    """
    w = cubic_weights(share)
    variance = sum(w[i] * w[j] * correlation ** abs(i - j) for i in range(4) for j in range(4))
    scale = 1.0 / math.sqrt(variance)
    return (w[0] * scale, w[1] * scale, w[2] * scale, w[3] * scale)
