"""Collects the spectra that the monitor published, and finds out what time of the run they belong to."""

from __future__ import annotations

from collections import deque

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.review.decimate import Waterfall
from nw_gear_monitor.review.rundata import Spectra

PATIENCE = 0.5
"""Seconds of log time within which a spectrum and the indicators of the same second are recorded."""


class SpectraCollector:
    """The last spectrum, the mean one, and a thinned map over time.

    A spectrum carries no time of its own. The monitor publishes it together with indicators, which do: the two are
    paired in the order in which they were recorded. One without a partner stands where the samples were at that moment.
    """

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
        self._waiting: deque[tuple[float, float, Array]] = deque()
        self._stamps: deque[tuple[float, float]] = deque()

    def add(self, log_time: float, moment: float, data: Array) -> None:
        """Take one message; a change of its axis starts over, columns of NaN (windows not filled yet) don't count.

        Args:
            log_time: when it was recorded (s).
            moment: stamp of the newest sample at that moment (s).
            data: the table.
        """
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
        of_stage = [amplitude[:, stage].max(axis=1) for stage in self._of_stage if stage]
        self._forget(log_time)
        self._waiting.append((log_time, moment, np.stack(of_stage, axis=1).astype(np.float32)))
        self._pair()

    def made(self, log_time: float, stamp: float) -> None:
        """Take the time of indicators (s) that belong to some spectrum."""
        self._forget(log_time)
        self._stamps.append((log_time, stamp))
        self._pair()

    def _pair(self) -> None:
        while self._waiting and self._stamps:
            self._map.add(self._stamps.popleft()[1], self._waiting.popleft()[2])

    def _forget(self, log_time: float) -> None:
        """Give up waiting for partners that should have come by now."""
        while self._stamps and log_time - self._stamps[0][0] > PATIENCE:
            self._stamps.popleft()
        while self._waiting and log_time - self._waiting[0][0] > PATIENCE:
            _log_time, moment, row = self._waiting.popleft()
            self._map.add(moment, row)

    def result(self) -> Spectra | None:
        """What was collected, None where nothing came."""
        self._forget(np.inf)
        rows = self._map.result()
        if rows is None:
            return None
        return Spectra(
            self._axis,
            self._meshes,
            self._last,
            self._sum / np.where(self._seen > 0, self._seen, np.nan),
            rows[0],
            rows[1],
            self._count,
        )
