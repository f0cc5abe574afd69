"""Surrogate windows through the alarms: the compiled code that runs in the monitor, in a compiled loop."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from health.statistics import WINDOWS
from health.surrogate import Surrogate
from nw_gear_common.tables import Array
from nw_gear_monitor.alarms import kernel
from nw_gear_monitor.alarms.baseline import empty
from nw_gear_monitor.alarms.features import LONG, SHORT
from nw_gear_monitor.alarms.settings import AlarmSettings

PIECE = 20000
"""Hops that are drawn at once."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """False alarms.

    Attributes:
        names: of the features.
        warn, error: (features,) how often each came.
        judged: (features,) windows that were judged.
        error_seconds: second of each ERROR, in the order of time.
    """

    names: tuple[str, ...]
    warn: Array
    error: Array
    judged: Array
    error_seconds: list[float]


@numba.njit(nogil=True, error_model="numpy")  # no cache: it would keep what it calls as it was
def _run(
    values: Array,
    bins: Array,
    group: Array,
    spacing: Array,
    offsets: Array,
    first: float,
    blocks: Array,
    states: Array,
    deviations: tuple[float, float],
    windows: tuple[float, float],
    learning: bool,
    counts: Array,
    errors: Array,
) -> int:
    """Every hop of `values` in turn; counts rows: WARN, ERROR, judged. Returns how many rows of `errors` it filled."""
    features = values.shape[1]
    which, row, offset = np.empty(features, dtype=np.int64), np.empty(features), np.empty(features)
    filled = 0
    for t in range(values.shape[0]):
        for window in range(spacing.size):
            key = bins[window, t]
            if key < 0:
                continue
            size = 0
            for i in range(features):
                if group[i] == window and values[t, i] + offsets[i] > 0.0:
                    which[size], row[size], offset[size] = i, values[t, i], offsets[i]
                    size += 1
            before = states[:, which[:size]].copy()
            for k in range(size):
                counts[2, which[k]] += blocks[key, kernel.INDEPENDENT, which[k]] >= windows[0]
            kernel.window(
                which[:size], row[:size], offset[:size], spacing[window], first + t, blocks[key], states,
                deviations, windows, learning,
            )  # fmt: skip
            for k in range(size):
                i = which[k]
                counts[0, i] += states[2, i] > before[2, k]
                counts[1, i] += states[5, i] > before[5, k]
                if states[5, i] > before[5, k] and filled < errors.shape[0]:
                    errors[filled, 0], errors[filled, 1] = first + t, i
                    filled += 1
    return filled


def judge(surrogate: Surrogate, seconds: int, settings: AlarmSettings | None = None, learning: bool = True) -> Outcome:
    """Learn and judge from nothing for so many seconds.

    Args:
        surrogate: what is seen.
        seconds: hops.
        settings: of the alarms; as they are by default.
        learning: whether anything is learned (nothing judges otherwise).
    """
    chosen = AlarmSettings() if settings is None else settings
    order = (SHORT, LONG)
    size = len(surrogate.names)
    blocks = np.array([empty(size) for _ in surrogate.keys])
    states, counts = np.zeros((kernel.STATES, size), dtype=np.int64), np.zeros((3, size))
    group = np.array([order.index(window) for window in surrogate.windows])
    spacing = np.array([float(WINDOWS[window]) for window in order])
    errors, when, done = np.zeros((100000, 2)), [], 0
    for piece in surrogate.pieces(seconds, PIECE):
        bins = np.array([piece.bins[window] for window in order])
        filled = _run(
            piece.values, bins, group, spacing, surrogate.offsets, float(done), blocks, states,
            (chosen.warn_deviations, chosen.error_deviations),
            (float(chosen.least_windows), float(chosen.most_windows)), learning, counts, errors,
        )  # fmt: skip
        when += errors[:filled, 0].tolist()
        done += len(piece.values)
    return Outcome(surrogate.names, counts[0], counts[1], counts[2], when)
