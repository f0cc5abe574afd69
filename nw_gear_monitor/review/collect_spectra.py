"""Collects the spectra that the monitor published, and finds out what time of the run they belong to."""

from __future__ import annotations

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.review.decimate import Waterfall
from nw_gear_monitor.review.rundata import Spectra

MOST_MOMENTS = 8000


class Moments:
    """What time of the run it was when something was recorded: pairs of log time and stamp, thinned when too many."""

    def __init__(self) -> None:
        self._pairs: list[tuple[float, float]] = []
        self._stride = 1
        self._seen = 0

    @property
    def empty(self) -> bool:
        """Whether nothing is known."""
        return not self._pairs

    def add(self, log_time: float, stamp: float) -> None:
        """Take one pair (s)."""
        if self._seen % self._stride == 0:
            self._pairs.append((log_time, stamp))
        self._seen += 1
        if len(self._pairs) > MOST_MOMENTS:
            self._pairs = self._pairs[::2]
            self._stride *= 2

    def at(self, log_times: Array) -> Array | None:
        """Stamps at some log times, between those known linearly; None where nothing is known."""
        if not self._pairs:
            return None
        log, stamps = np.array(sorted(self._pairs)).T
        found: Array = np.interp(log_times, log, stamps)
        return found


class SpectraCollector:
    """The last spectrum, the mean one, and a thinned map over the time of recording."""

    def __init__(self, columns: tuple[str, ...]) -> None:
        self.columns = columns
        self._meshes = tuple(m for m in names.MESHES if m in columns)
        self._of_mesh = [columns.index(m) for m in self._meshes]
        stages = [[i for i, m in enumerate(self._meshes) if names.STAGE_OF_MESH[m] == s] for s in names.STAGES]
        self._of_stage = stages
        self._axis: Array = np.empty(0)
        self._last: Array = np.empty((0, 0))
        self._sum: Array = np.empty((0, 0))
        self._seen: Array = np.zeros(len(self._meshes))
        self._count = 0
        self._map = Waterfall()

    def add(self, log_time: float, data: Array) -> None:
        """Take one message; a change of its axis starts over, columns of NaN (windows not filled yet) don't count."""
        amplitude = data[:, self._of_mesh]
        if not np.isfinite(amplitude).any():
            return
        if not np.array_equal(self._axis, data[:, 0]):
            self._axis, self._sum, self._last = (
                data[:, 0].copy(),
                np.zeros_like(amplitude),
                np.full_like(amplitude, np.nan),
            )
            self._seen, self._count, self._map = np.zeros(len(self._meshes)), 0, Waterfall()
        filled = np.isfinite(amplitude).all(axis=0)
        self._last[:, filled] = amplitude[:, filled]
        self._sum[:, filled] += amplitude[:, filled]
        self._seen += filled
        self._count += 1
        self._map.add(
            log_time, np.stack([amplitude[:, s].max(axis=1) for s in self._of_stage if s], axis=1).astype(np.float32)
        )

    def result(self, moments: Moments) -> Spectra | None:
        """What was collected, None where nothing came; `moments` turns log times into times of the run."""
        rows = self._map.result()
        if rows is None:
            return None
        times = moments.at(rows[0])
        return Spectra(
            self._axis,
            self._meshes,
            self._last,
            self._sum / np.where(self._seen > 0, self._seen, np.nan),
            rows[0] if times is None else times,
            rows[1],
            self._count,
        )
