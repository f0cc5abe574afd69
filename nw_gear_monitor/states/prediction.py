"""Is the rest predictable, and for how long: neighbours against a linear predictor, one cycle and many ahead."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array

Whole = npt.NDArray[np.int64]
MOST = 2000
THEILER = 3
DELAYS = (1, 2, 4)
FAR_DELAYS = (1, 4)
NEIGHBOURS = 12
CLOSEST = 5
RIDGES = (0.1, 1e-3)
MOST_COORDINATES = 12
"""Of a local linear predictor with NEIGHBOURS neighbours."""
AUTOREGRESSIVE = 10
LONG_MEMORY = 80
"""Coefficients of the linear predictor over many cycles: two for each line it can follow."""
HORIZONS = (0.15, 0.2, 0.25, 0.3, 0.35)
"""Shares of the record."""
SILENT = 0.93
ENOUGH = 0.1
"""A linear prediction over many cycles that good makes all others idle."""


@dataclass(frozen=True)
class Predictability:
    """Mean square errors of prediction over the variance of the rest; 1 is no better than the periodic part alone.

    Attributes:
        near: one cycle ahead, by neighbours.
        linear: one cycle ahead, by the best linear predictor.
        far: many cycles ahead, by neighbours or by the best linear predictor; median of several horizons.
        expansion: mean square distance of the images of neighbours over that of the neighbours.
    """

    near: float
    linear: float
    far: float
    expansion: float


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _neighbours(states: Array, usable: int, count: int, theiler: int) -> Whole:
    """Numbers of the `count` nearest states of each, among the first `usable`, in order of distance."""
    size, dimension = states.shape
    found = np.zeros((size, count), dtype=np.int64)
    best = np.empty(count)
    for i in range(size):
        best[:] = np.inf
        for j in range(usable):
            if abs(i - j) <= theiler:
                continue
            total = 0.0
            for d in range(dimension):
                total += (states[i, d] - states[j, d]) ** 2
            if total < best[count - 1]:
                place = count - 1
                while place > 0 and best[place - 1] > total:
                    best[place] = best[place - 1]
                    found[i, place] = found[i, place - 1]
                    place -= 1
                best[place] = total
                found[i, place] = j
    return found


def predictability(states: Array, targets: Array, rest: Array) -> Predictability:
    """Predict the next cycles.

    Args:
        states: (cycles, coordinates) what is known at a cycle, in units in which noise is alike.
        targets: (cycles, components) what is predicted of later cycles.
        rest: (cycles, components) the targets less their periodic part: its variance is the unit of the errors.
    """
    states, targets, rest = states[-MOST:], targets[-MOST:], rest[-MOST:]
    unit = float(np.mean(np.sum(rest**2, axis=1)))
    horizons = tuple(int(len(targets) * share) for share in HORIZONS)
    linear = _linear(rest)
    far = _linear_far(rest, horizons)
    near, expansion = _near(states, targets, local=False)
    if min(linear, far, near) > SILENT * unit:  # noise in the simplest view: no better one is looked for
        return Predictability(near / unit, linear / unit, far / unit, expansion)
    if far < ENOUGH * unit:
        return Predictability(near / unit, linear / unit, far / unit, expansion)
    for delays in DELAYS:
        error, widening = _near(_delayed(states, delays), targets[delays - 1 :], local=True)
        if error < near:
            near, expansion = error, widening
    for delays in FAR_DELAYS:
        far = min(far, _far(_delayed(states, delays), targets[delays - 1 :], horizons))
    return Predictability(near / unit, linear / unit, far / unit, expansion)


def _delayed(states: Array, delays: int) -> Array:
    size = len(states) - delays + 1
    return np.ascontiguousarray(np.hstack([states[d : d + size] for d in range(delays)]))


def _near(states: Array, targets: Array, *, local: bool) -> tuple[float, float]:
    """Mean square error one cycle ahead, and how neighbours part."""
    found = _neighbours(states, len(targets) - 1, NEIGHBOURS, THEILER)[:-1]
    images, wanted = targets[found + 1], targets[1:]
    errors = [_error(images[:, :CLOSEST].mean(axis=1), wanted)]
    if local and states.shape[1] <= MOST_COORDINATES:
        errors += [_error(_local_linear(states, found, images, ridge), wanted) for ridge in RIDGES]
    apart = _error(states[found[:, -1]], states[:-1])
    return min(errors), _error(images[:, -1], wanted) / apart if apart > 0.0 else 1.0


def _far(states: Array, targets: Array, horizons: tuple[int, ...]) -> float:
    size = len(targets)
    found = _neighbours(states, size - max(horizons), CLOSEST, THEILER)
    errors = [_error(targets[found[: size - ahead] + ahead].mean(axis=1), targets[ahead:]) for ahead in horizons]
    return float(np.median(errors))


def _local_linear(states: Array, found: Whole, images: Array, ridge: float) -> Array:
    count = len(images)
    near = states[found[:count]]
    middle = near.mean(axis=1, keepdims=True)
    offsets = near - middle
    across = np.swapaxes(offsets, 1, 2)
    gram = across @ offsets
    scale = np.einsum("kaa->k", gram)[:, None, None]
    gram += ridge * (scale + 1e-3 * np.mean(scale)) * np.eye(states.shape[1])
    slopes = np.linalg.solve(gram, across @ (images - images.mean(axis=1, keepdims=True)))
    return np.asarray(images.mean(axis=1) + ((states[:count, None, :] - middle) @ slopes)[:, 0, :])


def _error(predicted: Array, wanted: Array) -> float:
    return float(np.mean(np.sum((wanted - predicted) ** 2, axis=1)))


def _linear(rest: Array) -> float:
    """Mean square error of the best linear prediction by one cycle, corrected for what its coefficients overfit."""
    past = _delayed(rest, AUTOREGRESSIVE)[:-1]
    return _regression(past, rest[AUTOREGRESSIVE:])


def _linear_far(rest: Array, horizons: tuple[int, ...]) -> float:
    """The same by many cycles: a sum of lines obeys a linear recursion for ever, chaos doesn't."""
    size = len(rest)
    delays = max(min(LONG_MEMORY, size // 8) // rest.shape[1], 1)
    past = _delayed(rest, delays)
    wanted = rest[delays - 1 :]
    return float(np.median([_regression(past[:-ahead], wanted[ahead:]) for ahead in horizons]))


def _regression(past: Array, wanted: Array) -> float:
    gram = past.T @ past
    gram += 1e-13 * np.trace(gram) * np.eye(len(gram))
    weights = np.linalg.solve(gram, past.T @ wanted)
    freedom = max(len(past) - past.shape[1], 1) / len(past)
    return float(_error(past @ weights, wanted) / freedom**2)
