"""Is the rest predictable, and for how long: neighbours against a linear predictor, one cycle and many ahead."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array

MOST = 2000
THEILER = 3
DELAYS = (1, 2, 3)
NEIGHBOURS = 6
AUTOREGRESSIVE = 10
RIDGE = 1e-6


@dataclass(frozen=True)
class Predictability:
    """Mean square errors of prediction over the variance predicted; 1 is no better than the mean.

    Attributes:
        near: one cycle ahead, by neighbours.
        linear: one cycle ahead, by the best linear predictor.
        far: many cycles ahead, by neighbours; median of several horizons.
    """

    near: float
    linear: float
    far: float


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _neighbours(states: Array, usable: int, count: int, theiler: int) -> npt.NDArray[np.int64]:
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
                if total >= best[count - 1]:
                    break
            if total < best[count - 1]:
                place = count - 1
                while place > 0 and best[place - 1] > total:
                    best[place] = best[place - 1]
                    found[i, place] = found[i, place - 1]
                    place -= 1
                best[place] = total
                found[i, place] = j
    return found


def predictability(states: Array, targets: Array) -> Predictability:
    """Predict targets from states.

    Args:
        states: (cycles, coordinates) what is known at a cycle, in units in which noise is alike.
        targets: (cycles, components) what is predicted of later cycles.
    """
    states, targets = states[-MOST:], targets[-MOST:]
    near = min(_by_neighbours(_delayed(states, w), targets[w - 1 :], (1,)) for w in DELAYS)
    size = len(targets)
    horizons = tuple(int(size * share) for share in (0.15, 0.2, 0.25, 0.3, 0.35))
    far = min(_by_neighbours(_delayed(states, w), targets[w - 1 :], horizons) for w in (*DELAYS, 6))
    return Predictability(near, _linear(states, targets), far)


def _delayed(states: Array, delays: int) -> Array:
    size = len(states) - delays + 1
    return np.ascontiguousarray(np.hstack([states[d : d + size] for d in range(delays)]))


def _by_neighbours(states: Array, targets: Array, horizons: tuple[int, ...]) -> float:
    size = len(targets)
    found = _neighbours(states, size - max(horizons), NEIGHBOURS, THEILER)
    errors = []
    for ahead in horizons:
        wanted = targets[ahead:]
        images = targets[found[: size - ahead] + ahead]
        constant = images.mean(axis=1)
        errors.append(_share(constant, wanted))
        if max(horizons) == 1:
            errors[-1] = min(errors[-1], _share(_local_linear(states, found, images), wanted))
    return float(np.median(errors))


def _local_linear(states: Array, found: npt.NDArray[np.int64], images: Array) -> Array:
    count = len(images)
    near = states[found[:count]]
    middle = near.mean(axis=1, keepdims=True)
    offsets = near - middle
    gram = np.einsum("kia,kib->kab", offsets, offsets)
    scale = np.einsum("kaa->k", gram)[:, None, None]
    gram += (0.05 * scale + RIDGE * np.mean(scale)) * np.eye(states.shape[1])
    values = images - images.mean(axis=1, keepdims=True)
    slopes = np.linalg.solve(gram, np.einsum("kia,kic->kac", offsets, values))
    step = states[:count, None, :] - middle
    return np.asarray(images.mean(axis=1) + np.einsum("kia,kac->kc", step, slopes))


def _share(predicted: Array, wanted: Array) -> float:
    return float(np.sum((wanted - predicted) ** 2) / np.sum((wanted - wanted.mean(axis=0)) ** 2))


def _linear(states: Array, targets: Array) -> float:
    past = _delayed(states, AUTOREGRESSIVE)[:-1]
    design = np.column_stack([past, np.ones(len(past))])
    wanted = targets[AUTOREGRESSIVE:]
    weights = np.linalg.lstsq(design, wanted, rcond=None)[0]
    freedom = max(len(past) - design.shape[1], 1) / len(past)
    return float(_share(design @ weights, wanted) / freedom)
