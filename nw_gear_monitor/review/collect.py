"""Collectors: one per kind of topic, fed message by message, each with bounded memory."""

from __future__ import annotations

import contextlib
import dataclasses
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.review.decimate import Band, Envelope, Tail, Waterfall
from nw_gear_monitor.review.rundata import Gap, Span, Spectra, Waveform

TAIL_SECONDS = 4.0
SECTION_SECONDS = 16.0
BATCH = 256
AFTER_END = 1.0
"""Seconds after the last sample in which a status may still tell of the run."""
LONGEST_HISTORY = 4000
"""Rows of indicators kept per mesh; every second one is dropped when there are more."""


class Series:
    """Samples that come one at a time (wind, shafts, views), reduced to an envelope."""

    def __init__(self, channels: tuple[str, ...]) -> None:
        self._envelope = Envelope(channels)
        self._rows: list[list[float]] = []
        self._last = -np.inf

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


class WaveformCollector:
    """Envelopes, statistics, gaps and the last seconds of `waveform`."""

    def __init__(self, columns: tuple[str, ...]) -> None:
        self.columns = columns
        self._x = [columns.index(f"x_{m}") for m in names.MESHES]
        self._phase = [columns.index(f"phase_{s}") for s in names.STAGES]
        self.bearings = tuple(b for b in names.BEARINGS if f"fx_{b}" in columns)
        self._fx = [columns.index(f"fx_{b}") for b in self.bearings]
        self._fy = [columns.index(f"fy_{b}") for b in self.bearings]
        self._displacement = Envelope(names.MESHES)
        self._bearing = Envelope(self.bearings)
        self._frequency = Envelope(names.STAGES)
        self._tail = Tail(TAIL_SECONDS)
        self._gaps: list[Gap] = []
        self._step = np.inf
        self.last = -np.inf
        self._count = 0
        self._shift: Array | None = None
        self._sums = np.zeros((2, len(names.MESHES)))

    def add(self, data: Array) -> None:
        """Take the rows of one block."""
        time = data[:, 0]
        if not len(time):
            return
        if len(time) > 1:
            self._step = min(self._step, float(np.median(np.diff(time))))
            turns = (data[-1, self._phase] - data[0, self._phase]) / (2.0 * np.pi * (time[-1] - time[0]))
            self._frequency.add(time[:1], turns[None, :])
        if np.isfinite(self.last) and time[0] - self.last > 1.5 * self._step:
            self._gaps.append(Gap(self.last, float(time[0] - self.last)))
        self.last = float(time[-1])
        x = data[:, self._x]
        self._displacement.add(time, x)
        if self.bearings:
            self._bearing.add(time, np.hypot(data[:, self._fx], data[:, self._fy]))
        self._shift = x[0] if self._shift is None else self._shift
        self._sums += (x - self._shift).sum(axis=0), ((x - self._shift) ** 2).sum(axis=0)
        self._count += len(time)
        self._tail.add(data)

    def result(self) -> Waveform | None:
        """What was collected, None where nothing came."""
        displacement, frequency, tail = self._displacement.result(), self._frequency.result(), self._tail.result()
        if displacement is None or frequency is None or tail is None:
            return None
        mean = self._sums[0] / self._count
        rms = np.sqrt(np.maximum(self._sums[1] / self._count - mean**2, 0.0))
        return Waveform(
            rate=1.0 / self._step,
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


class SpectraCollector:
    """The last spectrum, the mean one, and a thinned map over time."""

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

    def add(self, time: float, data: Array) -> None:
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
            time, np.stack([amplitude[:, s].max(axis=1) for s in self._of_stage if s], axis=1).astype(np.float32)
        )

    def result(self) -> Spectra | None:
        """What was collected, None where nothing came."""
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


class TruthCollector:
    """The last values of the simulator's truth, and the mean over the run of those that are numbers."""

    def __init__(self) -> None:
        self.message = ""
        self.last: dict[str, str] = {}
        self._sums: dict[str, list[float]] = {}

    def add(self, status: Any) -> None:
        """Take one DiagnosticStatus."""
        self.message = status.message
        self.last = {pair.key: pair.value for pair in status.values}
        for key, value in self.last.items():
            with contextlib.suppress(ValueError):
                total = self._sums.setdefault(key, [0.0, 0.0])
                total[0] += float(value)
                total[1] += 1.0

    def means(self) -> dict[str, float]:
        """Mean of every number over all messages."""
        return {key: total / count for key, (total, count) in self._sums.items() if count}


class DiagnosticsCollector:
    """Stretches of constant level and state of every status, with the reason given when they began."""

    def __init__(self) -> None:
        self._spans: dict[str, list[Span]] = {}
        self.values: dict[str, dict[str, str]] = {}

    def add(self, time: float, array: Any) -> None:
        """Take one DiagnosticArray."""
        for status in array.status:
            values = {pair.key: pair.value for pair in status.values}
            self.values[status.name] = values
            level = status.level[0] if isinstance(status.level, bytes) else int(status.level)
            state = values.get("state", "")
            reason = status.message.removeprefix(state).lstrip(": ")
            spans = self._spans.setdefault(status.name, [])
            begin, same = time, bool(spans) and (spans[-1].level, spans[-1].state) == (level, state)
            if same:
                begin, reason = spans[-1].start, spans[-1].reason
                spans.pop()
            elif spans:
                before = spans[-1]
                spans[-1] = Span(before.name, before.start, time, before.level, before.state, before.reason)
            spans.append(Span(status.name, begin, time, level, state, reason))

    def result(self, start: float, end: float) -> dict[str, tuple[Span, ...]]:
        """The history of every status between two times (s); what was said before the run and after it is left out."""
        found = {}
        for name, spans in sorted(self._spans.items()):
            kept = [span for span in spans if span.end >= start and span.start <= end + AFTER_END]
            found[name] = tuple(
                dataclasses.replace(span, start=max(span.start, start), end=min(span.end, end + AFTER_END))
                for span in kept
            )
        return {name: spans for name, spans in found.items() if spans}
