"""Brings new rows of a ring to a data source of the browser: a stream of binary columns that drops the oldest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from bokeh.models import ColumnDataSource, DataRange1d
from bokeh.models.renderers import GlyphRenderer

from nw_gear_common.tables import Array
from nw_gear_monitor.dashboard.buffers import Ring
from nw_gear_monitor.review.figures.style import small


class Follower:
    """A data source that follows a ring whose first column is time.

    Args:
        columns: names of the source's columns; the first is the time since the run's begin (s).
        scales: factors from the ring's values to what is shown, one per column but the time.
        rollover: rows that the browser keeps.
    """

    def __init__(self, columns: Sequence[str], scales: Sequence[float], rollover: int) -> None:
        self.source = ColumnDataSource({name: np.empty(0, np.float32) for name in columns})
        self._columns, self._scales, self._rollover = tuple(columns), tuple(scales), rollover
        self._seen, self._epoch = 0, -1

    def update(self, ring: Ring, epoch: int, origin: float) -> None:
        """Send what is new; everything where a run has begun anew or too much is new."""
        fresh = epoch != self._epoch or ring.count < self._seen
        missed = ring.count - self._seen > self._rollover
        rows = ring.since(0 if fresh or missed else self._seen)[-self._rollover :]
        self._seen, self._epoch = ring.count, epoch
        if fresh or missed:
            self.source.data = self._shown(rows, origin)
        elif len(rows):
            self.source.stream(self._shown(rows, origin), rollover=self._rollover)

    def _shown(self, rows: Array, origin: float) -> dict[str, npt.NDArray[Any]]:
        data: dict[str, npt.NDArray[Any]] = {self._columns[0]: np.ascontiguousarray(rows[:, 0] - origin)}
        for i, (name, scale) in enumerate(zip(self._columns[1:], self._scales, strict=True), start=1):
            data[name] = small(rows[:, i] * scale)
        return data


def follow(history: float) -> DataRange1d:
    """The last seconds of a scrolling figure; panning or zooming stops it, the tool `reset` lets it scroll again."""
    return DataRange1d(
        follow="end", follow_interval=history, default_span=history, range_padding=0.0, only_visible=False
    )


def fit_to(shared: DataRange1d, renderers: Sequence[GlyphRenderer]) -> None:
    """Let a shared range look at some lines alone."""
    shared.renderers = [*(shared.renderers or []), *renderers]
