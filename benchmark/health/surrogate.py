"""Long series that have the recorded statistics: drawn anew, in pieces, from a seed.

Normal scores are innovations, correlated between features, through one autoregressive filter per feature (Yule and
Walker, from the recorded autocorrelation). They are bent to the recorded distribution, scaled to the bin of the second,
and brought back through the logarithm. Operating points are the recorded ones in random blocks.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import linalg, signal

from health.statistics import WINDOWS, keys_of
from nw_gear_common.tables import Array
from nw_gear_monitor.alarms.features import rule_of
from nw_gear_monitor.alarms.operating import Bin

ORDER = 20
BLOCK = 600
"""Seconds of operating points that are drawn together."""
SMALLEST = 1e-3
"""Least eigenvalue of a correlation, so that rounding leaves it positive."""


@dataclass(frozen=True, eq=False)
class Piece:
    """Some hours.

    Attributes:
        values: (seconds, features) in the features' units.
        bins: window -> (seconds,) index into the bins, -1 where nothing is compared.
    """

    values: Array
    bins: dict[str, Array]


class Surrogate:
    """Draws from statistics.

    Args:
        statistics: of `statistics.describe`.
        seed: of everything random.

    Attributes:
        names: of the features; windows, offsets: of their rules; keys: the bins.
    """

    def __init__(self, statistics: Mapping[str, Any], seed: int) -> None:
        features = statistics["features"]
        self.names = tuple(features)
        rules = [rule_of(name) for name in self.names]
        self.windows = [rule.window for rule in rules if rule is not None]
        self.offsets = np.array([rule.offset for rule in rules if rule is not None])
        self.keys = sorted({Bin(b[0], b[1]) for f in features.values() for b in f["bins"]})
        self._random = np.random.default_rng(seed)
        self._sequences = [
            {window: self._indices(keys) for window, keys in keys_of(np.array(s), np.array(t)).items()}
            for s, t in zip(statistics["speed"], statistics["load"], strict=True)
        ]
        self._mean, self._deviation = self._tables(features)
        self._g = np.array([f["g"] for f in features.values()])
        self._h = np.array([f["h"] for f in features.values()])
        filters = [yule_walker(np.array(f["autocorrelation"])[: ORDER + 1]) for f in features.values()]
        self._filters = [f[0] for f in filters]
        self._states = np.zeros((len(filters), ORDER))
        self._root = innovations(np.array(statistics["correlation"]), filters)
        self._middle, self._scale = standard(self._g, self._h)
        self._next(5 * ORDER)  # runs the filters in

    def pieces(self, seconds: int, at_once: int) -> Iterator[Piece]:
        """So many seconds, cut into pieces."""
        for start in range(0, seconds, at_once):
            size = min(at_once, seconds - start)
            bins = self._operate(size)
            score = (bend(self._next(size), self._g, self._h) - self._middle) / self._scale
            logarithm = np.zeros_like(score)
            for column, window in enumerate(self.windows):
                at = bins[window]
                logarithm[:, column] = self._mean[at, column] + self._deviation[at, column] * score[:, column]
            yield Piece(np.exp(logarithm) - self.offsets, bins)

    def _indices(self, keys: list[Bin | None]) -> Array:
        place = {key: i for i, key in enumerate(self.keys)}
        return np.array([-1 if key is None else place.get(key, -1) for key in keys])

    def _tables(self, features: Mapping[str, Any]) -> tuple[Array, Array]:
        """Means and deviations by (bin, feature); where a feature wasn't met in a bin: nan."""
        mean = np.full((len(self.keys), len(self.names)), np.nan)
        deviation = mean.copy()
        for column, feature in enumerate(features.values()):
            for speed, load, m, s, _count in feature["bins"]:
                row = self.keys.index(Bin(speed, load))
                mean[row, column], deviation[row, column] = m, s
        return mean, deviation

    def _operate(self, seconds: int) -> dict[str, Array]:
        parts: dict[str, list[Array]] = {window: [] for window in WINDOWS}
        have = 0
        while have < seconds:
            source = self._sequences[self._random.integers(len(self._sequences))]
            start = int(self._random.integers(max(next(iter(source.values())).size - BLOCK, 1)))
            for window, indices in source.items():
                parts[window].append(indices[start : start + BLOCK])
            have += parts[next(iter(parts))][-1].size
        return {window: np.concatenate(found)[:seconds] for window, found in parts.items()}

    def _next(self, seconds: int) -> Array:
        """(seconds, features) normal scores."""
        noise = self._random.standard_normal((seconds, len(self.names))) @ self._root.T
        found = np.empty_like(noise)
        for column, coefficients in enumerate(self._filters):
            found[:, column], self._states[column] = signal.lfilter(
                [1.0], coefficients, noise[:, column], zi=self._states[column]
            )
        return found


def yule_walker(correlation: Array) -> tuple[Array, Array]:
    """Autoregressive filter with a given autocorrelation: denominator (order + 1,), and its response to an impulse.

    Where the autocorrelation is no possible one (its matrix has eigenvalues below SMALLEST), white noise is added.
    """
    usable = correlation.copy()
    usable[0] += max(SMALLEST - float(np.linalg.eigvalsh(linalg.toeplitz(usable))[0]), 0.0)
    coefficients = linalg.solve_toeplitz(usable[:-1], usable[1:])
    denominator = np.concatenate([[1.0], -coefficients])
    impulse = np.zeros(4000)
    impulse[0] = 1.0
    return denominator, signal.lfilter([1.0], denominator, impulse)


def innovations(correlation: Array, filters: list[tuple[Array, Array]]) -> Array:
    """Root of the innovations' covariance that gives filtered series of unit variance the correlation between them."""
    responses = np.array([response for _, response in filters])
    overlap = responses @ responses.T
    size = np.sqrt(np.diagonal(overlap))
    wanted = positive(correlation) / (overlap / np.outer(size, size))
    wanted = np.clip(wanted, -1.0, 1.0)
    np.fill_diagonal(wanted, 1.0)
    root: Array = np.linalg.cholesky(positive(wanted)) / size[:, None]
    return root


def positive(matrix: Array) -> Array:
    """The matrix with eigenvalues of SMALLEST at least and ones on its diagonal."""
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2.0)
    found = (vectors * np.maximum(values, SMALLEST)) @ vectors.T
    size = np.sqrt(np.diagonal(found))
    result: Array = found / np.outer(size, size)
    return result


def bend(normal: Array, g: Array, h: Array) -> Array:
    """Tukey's g-and-h distribution of normal numbers (..., features)."""
    steep = np.where(np.abs(g) > 1e-3, g, 1e-3)
    found: Array = np.expm1(steep * normal) / steep * np.exp(h * normal**2 / 2.0)
    return found


def standard(g: Array, h: Array) -> tuple[Array, Array]:
    """Mean and standard deviation of the bent distribution, by quadrature."""
    grid = np.linspace(-9.0, 9.0, 3601)
    weight = np.exp(-(grid**2) / 2.0)
    weight /= weight.sum()
    values = bend(grid[:, None], g, h)
    mean = weight @ values
    return mean, np.sqrt(weight @ (values - mean) ** 2)
