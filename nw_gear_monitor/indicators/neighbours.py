"""Nearest neighbours outside a Theiler window, by a k-d tree with boxes."""

from __future__ import annotations

import numba
import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array

LEAF = 12
"""Points in a leaf, at most."""

Whole = npt.NDArray[np.int64]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _select(order: Whole, key: Array, start: int, stop: int, middle: int) -> None:
    """Reorder order[start:stop] so that keys before `middle` aren't above and keys after it aren't below its own."""
    low, high = start, stop - 1
    while low < high:
        pivot = key[order[(low + high) // 2]]
        i, j = low, high
        while i <= j:
            while key[order[i]] < pivot:
                i += 1
            while key[order[j]] > pivot:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i += 1
                j -= 1
        if middle <= j:
            high = j
        elif middle >= i:
            low = i
        else:
            break


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _tree(columns: Array, leaf: int) -> tuple[Whole, Whole, Array]:
    """Halve points along the widest side of their box, level by level; node n has the children 2 n + 1 and 2 n + 2."""
    dimension, size = columns.shape
    levels = 0
    while (size >> levels) > leaf:
        levels += 1
    inner = (1 << levels) - 1
    nodes = 2 * inner + 1
    order = np.arange(size)
    limits = np.zeros((nodes, 2), dtype=np.int64)
    boxes = np.zeros((nodes, 2, dimension))
    limits[0, 1] = size
    for node in range(nodes):
        start, stop = limits[node]
        widest, width = 0, -1.0
        for k in range(dimension):
            low, high = np.inf, -np.inf
            for position in range(start, stop):
                value = columns[k, order[position]]
                low = min(low, value)
                high = max(high, value)
            boxes[node, 0, k] = low
            boxes[node, 1, k] = high
            if high - low > width:
                widest, width = k, high - low
        if node < inner:
            middle = (start + stop) // 2
            _select(order, columns[widest], start, stop, middle)
            limits[2 * node + 1] = start, middle
            limits[2 * node + 2] = middle, stop
    return order, limits, boxes


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _outside(boxes: Array, node: int, point: Array) -> float:
    """Square of the distance of a point from a node's box."""
    total = 0.0
    for k in range(point.size):
        gap = max(boxes[node, 0, k] - point[k], point[k] - boxes[node, 1, k], 0.0)
        total += gap * gap
    return total


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _descend(boxes: Array, point: Array, best: float, waiting: Whole, bounds: Array, top: int) -> tuple[int, int]:
    """Go down from the last waiting node to the nearest leaf; the boxes passed by are left waiting.

    Returns the leaf, -1 if it is farther than `best`, and the number of nodes that wait.
    """
    top -= 1
    node = waiting[top] if bounds[top] <= best else -1
    inner = boxes.shape[0] // 2
    while 0 <= node < inner:
        left, right = 2 * node + 1, 2 * node + 2
        near, far = _outside(boxes, left, point), _outside(boxes, right, point)
        node = left
        if far < near:
            near, far, node = far, near, right
        if far <= best:
            waiting[top], bounds[top] = left + right - node, far
            top += 1
        if near > best:
            node = -1
    return node, top


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _square(a: Array, b: Array) -> float:
    total = 0.0
    for k in range(a.size):
        total += (a[k] - b[k]) ** 2
    return total


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _nearest(points: Array, references: Whole, window: int, leaf: int) -> Whole:
    size = points.shape[0]
    order, limits, boxes = _tree(np.ascontiguousarray(points.T), leaf)
    placed = points[order]
    found = np.empty(references.size, dtype=np.int64)
    waiting = np.empty(128, dtype=np.int64)
    bounds = np.empty(128)
    guess = -1
    for number in range(references.size):
        i = references[number]
        best, where = np.inf, size
        if 0 <= guess < size and abs(guess - i) > window:
            best, where = _square(points[guess], points[i]), guess
        waiting[0], bounds[0] = 0, 0.0
        top = 1
        while top > 0:
            node, top = _descend(boxes, points[i], best, waiting, bounds, top)
            for position in range(limits[node, 0] if node >= 0 else 0, limits[node, 1] if node >= 0 else 0):
                distance = _square(placed[position], points[i])
                index = order[position]
                if distance <= best and abs(index - i) > window and (distance < best or index < where):
                    best, where = distance, index
        found[number] = where if where < size else -1
        if number + 1 < references.size:  # the neighbour, moved on, is a good start for the next search
            guess = found[number] + references[number + 1] - i if where < size else -1
    return found


def nearest(points: Array, references: Whole, window: int) -> Whole:
    """The nearest neighbour (Euclidean) of some points among all of them.

    Args:
        points: (points, coordinates) finite.
        references: (references,) numbers of the points whose neighbours are wanted, increasing.
        window: neighbours j of i have abs(i - j) > window.

    Returns:
        (references,) numbers of the neighbours, the lowest where several are equally near; -1 where there's none.
    """
    found: Whole = _nearest(np.ascontiguousarray(points), np.asarray(references, dtype=np.int64), window, LEAF)
    return found
