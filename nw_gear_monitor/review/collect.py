"""Collectors: one per kind of topic, fed message by message, each with bounded memory."""

from __future__ import annotations

from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.review.decimate import Band, Envelope, Tail
from nw_gear_monitor.review.kernels import moments
from nw_gear_monitor.review.rundata import Gap, Waveform

TAIL_SECONDS = 4.0
SECTION_SECONDS = 16.0
SECTION_POINTS = 24_000
"""Points of a stage's Poincaré section that are kept of a long run, in stretches of a second spread over it."""
BATCH = 256
TOGETHER = 4096
"""Samples that are worked on at once."""
FINE = 16384
"""Bins of the envelopes of samples: a quarter of a second each in an hour."""
LONGEST_HISTORY = 4000
"""Rows of indicators kept per mesh; every second one is dropped when there are more."""


class Series:
    """Samples that come one at a time (wind, shafts, views), reduced to an envelope."""

    def __init__(self, channels: tuple[str, ...]) -> None:
        self._envelope = Envelope(channels)
        self._rows: list[list[float]] = []
        self._last = -np.inf

    def add_rows(self, time: Array, values: Array) -> None:
        """Take samples, shapes (n,) and (n, channels); one that isn't later than all before is left out."""
        self._flush()
        latest = np.maximum.accumulate(np.append(self._last, time))
        later = time > latest[:-1]
        self._last = float(latest[-1])
        self._envelope.add(time[later], values[later])

    def add(self, time: float, values: list[float]) -> None:
        """Take one sample; a sample that isn't later than the one before is left out."""
        if time <= self._last:
            return
        self._last = time
        self._rows.append([time, *values])
        if len(self._rows) >= BATCH:
            self._flush()

    def _flush(self) -> None:
        if self._rows:
            block = np.array(self._rows)
            self._envelope.add(block[:, 0], block[:, 1:])
            self._rows = []

    def result(self) -> Band | None:
        """The envelope, None where nothing came."""
        self._flush()
        return self._envelope.result()


def missing_columns(columns: tuple[str, ...]) -> list[str]:
    """Columns of the built-in gearbox's waveform that aren't there; any means that it is another machine's."""
    wanted = [f"phase_{s}" for s in names.STAGES] + [f"x_{m}" for m in names.MESHES]
    return [name for name in wanted if name not in columns]


class WaveformCollector:
    """Envelopes, statistics, gaps and the last seconds of `waveform`."""

    def __init__(self, columns: tuple[str, ...]) -> None:
        self.columns = columns
        self._x = np.array([columns.index(f"x_{m}") for m in names.MESHES])
        self._phase = [columns.index(f"phase_{s}") for s in names.STAGES]
        self.bearings = tuple(b for b in names.BEARINGS if f"fx_{b}" in columns)
        self._fx = [columns.index(f"fx_{b}") for b in self.bearings]
        self._fy = [columns.index(f"fy_{b}") for b in self.bearings]
        self._displacement = Envelope(names.MESHES, FINE)
        self._bearing = Envelope(self.bearings, FINE)
        self._frequency = Envelope(names.STAGES)
        self._tail = Tail(TAIL_SECONDS)
        self.chunks: list[tuple[float, float, Any]] = []
        self._waiting: list[Array] = []
        self._together: Array = np.empty((0, len(columns)))
        self._rows = 0
        self._turns: list[list[float]] = []
        self._gaps: list[Gap] = []
        self._intervals = np.zeros(2)
        self.last = -np.inf
        self._count = 0
        self._shift: Array | None = None
        self._sums = np.zeros((2, len(names.MESHES)))

    def add(self, data: Array, place: Any = None) -> None:
        """Take the rows of one block; `place` is where it can be read again."""
        if not len(data):
            return
        first, last = float(data[0, 0]), float(data[-1, 0])
        if len(data) > 1:
            self._intervals += len(data) - 1, last - first
            turns = (data[-1, self._phase] - data[0, self._phase]) / (2.0 * np.pi * (last - first))
            self._turns.append([first, *turns.tolist()])
        if first - self.last > 1.5 / self._rate() and np.isfinite(self.last):
            self._gaps.append(Gap(self.last, first - self.last))
        self.last = last
        self._remember(first, place)
        self._shift = data[0, self._x] if self._shift is None else self._shift
        self._count += len(data)
        self._waiting.append(data)
        self._rows += len(data)
        if self._rows >= TOGETHER:
            self._fold()

    def _fold(self) -> None:
        """Work on the blocks that came since the last time, all at once."""
        if not self._waiting or self._shift is None:
            return
        if len(self._together) < self._rows:  # kept from time to time: fresh memory costs more than the work on it
            self._together = np.empty((self._rows, len(self.columns)))
        data: Array = self._together[: self._rows]
        np.concatenate(self._waiting, out=data)
        for block in self._waiting:
            self._tail.add(block)
        self._waiting, self._rows = [], 0
        if self._turns:
            turns = np.array(self._turns)
            self._turns = []
            self._frequency.add(turns[:, 0], turns[:, 1:])
        self._displacement.add(data[:, 0], data, self._x)
        if self.bearings:
            self._bearing.add(data[:, 0], np.hypot(data[:, self._fx], data[:, self._fy]))
        moments(data, self._x, self._shift, self._sums[0], self._sums[1])

    def _remember(self, first: float, place: Any) -> None:
        """Note which stretch of time stands where."""
        if self.chunks and self.chunks[-1][2] == place:
            self.chunks[-1] = (self.chunks[-1][0], self.last, place)
        elif place is not None:
            self.chunks.append((first, self.last, place))

    def _rate(self) -> float:
        """Samples per second within blocks; far more exact than a single step of stamps near the time of day."""
        return float(self._intervals[0] / self._intervals[1]) if self._intervals[1] > 0.0 else np.inf

    def result(self) -> Waveform | None:
        """What was collected, None where nothing came."""
        self._fold()
        displacement, frequency, tail = self._displacement.result(), self._frequency.result(), self._tail.result()
        if displacement is None or frequency is None or tail is None:
            return None
        mean = self._sums[0] / self._count
        rms = np.sqrt(np.maximum(self._sums[1] / self._count - mean**2, 0.0))
        return Waveform(
            rate=self._rate(),
            samples=self._count,
            displacement=displacement,
            bearing=self._bearing.result(),
            mesh_frequency=frequency,
            rms=dict(zip(names.MESHES, rms.tolist(), strict=True)),
            lowest=dict(zip(names.MESHES, displacement.low.min(axis=0).tolist(), strict=True)),
            highest=dict(zip(names.MESHES, displacement.high.max(axis=0).tolist(), strict=True)),
            tail=Table(names.ROW_SAMPLE, self.columns, tail),
            gaps=tuple(self._gaps),
        )


class RowsCollector:
    """Rows of indicators of one mesh, thinned evenly when there are too many."""

    def __init__(self, columns: tuple[str, ...]) -> None:
        self.columns = columns
        self._rows: list[Array] = []
        self._stride = 1
        self._seen = 0

    def add(self, data: Array) -> None:
        """Take the rows of one message."""
        for row in data:
            if self._seen % self._stride == 0:
                self._rows.append(row.copy())
            self._seen += 1
        if len(self._rows) > LONGEST_HISTORY:
            self._rows = self._rows[::2]
            self._stride *= 2

    def result(self) -> Table:
        """The rows that were kept."""
        return Table(names.ROW_ROW, self.columns, np.array(self._rows).reshape(-1, len(self.columns)))
