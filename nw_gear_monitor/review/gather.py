"""Gathers what the report shows from the messages of a recording, in one pass and with bounded memory."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.records.stamped import JOINTS, VECTOR, WRENCH, Rows
from nw_gear_monitor.review import windows
from nw_gear_monitor.review.collect import (
    SECTION_POINTS,
    SECTION_SECONDS,
    RowsCollector,
    Series,
    WaveformCollector,
    missing_columns,
)
from nw_gear_monitor.review.collect_spectra import SpectraCollector
from nw_gear_monitor.review.collect_status import DiagnosticsCollector, TruthCollector
from nw_gear_monitor.review.decimate import Stretches
from nw_gear_monitor.review.rundata import RunData

BACKWARD = 0.5
"""Seconds by which the waveform must step back to count as a restart of the run."""
BEARING_OF_TOPIC = {names.bearing_topic(b): b for b in names.BEARINGS}
VIEWS = {
    names.WIND_SPEED: VECTOR,
    names.SHAFTS_TOPIC: JOINTS,
    names.MESH_TOPIC: JOINTS,
    **dict.fromkeys(BEARING_OF_TOPIC, WRENCH),
}
"""Topics of stamped numbers, which come often and may be taken in bulk, and their types."""


def _stamp(message: Any) -> float:
    stamp = message.header.stamp
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def _vector(value: Any) -> list[float]:
    return [value.x, value.y, value.z]


class Gatherer:
    """Sorts messages, by topic relative to the suite's namespace, into collectors.

    The run that the report shows is the last one in the recording: a waveform that steps back in time (reset, restart)
    starts over, and a remark says so.

    Attributes:
        namespace: of the suite, where known: diagnostics of other ones are left out.
    """

    def __init__(self) -> None:
        self.namespace = ""
        self.remarks: list[str] = []
        self._place: Any = None
        self._restarts = 0
        self._fresh()
        self._handlers: dict[str, Callable[[float, Any], None]] = {
            names.TRUTH: self._truth,
            names.DIAGNOSTICS: self._diagnostics,
            **{topic: self._view(topic) for topic in VIEWS},
        }
        self._table_handlers: dict[str, Callable[[float, Table], None]] = {
            names.WAVEFORM: self._samples,
            names.SPECTRUM: self._spectrum,
            names.ORDERS: self._orders,
            **{names.section_topic(s): self._section(s) for s in names.STAGES},
            **{names.indicators_topic(m): self._indicators(m) for m in names.MESHES},
            **{names.indicators_topic(b): self._bearing_row(b) for b in names.BEARINGS},
        }

    @property
    def topics(self) -> frozenset[str]:
        """The topics that are of use, relative to the namespace."""
        return frozenset(self._handlers) | frozenset(self._table_handlers)

    @property
    def chunks(self) -> list[tuple[float, float, Any]]:
        """First and last stamp (s) of the waveform in every place of the recording."""
        return [] if self._waveform is None else self._waveform.chunks

    def _fresh(self) -> None:
        self._first, self._last = np.inf, -np.inf
        self._wind = Series(("wind",))
        self._speed, self._torque = Series(names.SHAFTS), Series(names.SHAFTS)
        self._mesh_force = Series(names.MESHES)
        self._radial = {b: Series((b,)) for b in names.BEARINGS}
        self._axial = {b: Series((b,)) for b in names.BEARINGS}
        self._waveform: WaveformCollector | None = None
        self._spectra: dict[str, SpectraCollector] = {}
        self._sections = {s: Stretches(SECTION_POINTS, SECTION_SECONDS) for s in names.STAGES}
        self._rows: dict[str, RowsCollector] = {}
        self._bearing_rows: dict[str, RowsCollector] = {}
        self._states = DiagnosticsCollector()
        self._known = TruthCollector()

    def starts_over(self, topic: str, value: Any) -> bool:
        """Whether a message is the first of another run: a waveform that steps back in time."""
        if topic != names.WAVEFORM or not isinstance(value, Table) or not len(value) or self._waveform is None:
            return False
        return "time" in value.columns and float(value.column("time")[0]) < self._waveform.last - BACKWARD

    def take(self, topic: str, log_time: float, value: Any, place: Any = None) -> None:
        """Take a table or a decoded message of one of `topics`; what isn't of that topic's kind is left out.

        Args:
            topic: relative to the namespace.
            log_time: when it was recorded, s.
            value: its content.
            place: where it can be read again.
        """
        if isinstance(value, Table):
            self._place = place
            if topic in self._table_handlers and len(value):
                self._table_handlers[topic](log_time, value)
        elif topic in self._handlers:
            self._handlers[topic](log_time, value)

    # --- one handler per topic ----------------------------------------------------------------------------------------

    def _seen(self, first: float, last: float) -> None:
        self._first, self._last = min(self._first, first), max(self._last, last)

    def take_rows(self, topic: str, rows: Rows) -> None:
        """Take many messages of a topic of `VIEWS` at once."""
        if topic == names.WIND_SPEED:
            self._wind.add_rows(rows.time, rows.values[:, 0, :1])
        elif topic == names.SHAFTS_TOPIC and rows.names == names.SHAFTS:
            self._seen(float(rows.time.min()), float(rows.time.max()))
            self._speed.add_rows(rows.time, rows.values[:, 1])
            self._torque.add_rows(rows.time, rows.values[:, 2])
        elif topic == names.MESH_TOPIC and rows.names == names.MESHES:
            self._mesh_force.add_rows(rows.time, rows.values[:, 2])
        elif topic in BEARING_OF_TOPIC:
            force = rows.values[:, 0]
            bearing = BEARING_OF_TOPIC[topic]
            self._radial[bearing].add_rows(rows.time, np.hypot(force[:, :1], force[:, 1:2]))
            self._axial[bearing].add_rows(rows.time, force[:, 2:])

    def _view(self, topic: str) -> Callable[[float, Any], None]:
        """Take one message of such a topic."""

        def take(_log_time: float, message: Any) -> None:
            joints: tuple[str, ...] = ()
            if topic == names.WIND_SPEED:
                parts = [_vector(message.vector)]
            elif topic in BEARING_OF_TOPIC:
                parts = [_vector(message.wrench.force)]
            else:
                joints = tuple(message.name)
                every = (message.position, message.velocity, message.effort)
                parts = [list(part) if len(part) == len(joints) else [np.nan] * len(joints) for part in every]
            self.take_rows(topic, Rows(joints, np.array([_stamp(message)]), np.array([parts], dtype=np.float64)))

        return take

    def _truth(self, _log_time: float, message: Any) -> None:
        self._known.add(message)

    def _diagnostics(self, _log_time: float, message: Any) -> None:
        self._states.add(_stamp(message), message, self.namespace)

    def _samples(self, _log_time: float, table: Table) -> None:
        time = table.column("time")
        if self.starts_over(names.WAVEFORM, table):
            self._restarts += 1
            self._fresh()
        missing = missing_columns(table.columns)
        if missing:
            self._foreign(missing[0])
            self._seen(float(time[0]), float(time[-1]))
            return
        if self._waveform is None or self._waveform.columns != table.columns:
            self._waveform = WaveformCollector(table.columns)
        if time[0] > self._waveform.last:
            self._seen(float(time[0]), float(time[-1]))
            self._waveform.add(table.data, self._place)

    def _foreign(self, missing: str) -> None:
        """Say once that the waveform is of a machine that this report can't draw."""
        words = (
            f"The waveform is that of another machine (it has no column {missing}). Of this machine the report shows "
            "states and alarms; waveform, spectra, sections and indicators are drawn for the built-in gearbox alone."
        )
        if words not in self.remarks:
            self.remarks.append(words)

    def _moment(self, log_time: float) -> float:
        """Stamp of the newest sample, or the log time where there are none."""
        return self._waveform.last if self._waveform is not None and np.isfinite(self._waveform.last) else log_time

    def _spectrum(self, log_time: float, table: Table) -> None:
        self._spectra.setdefault(names.SPECTRUM, SpectraCollector(table.columns)).add(
            log_time, self._moment(log_time), table.data
        )

    def _orders(self, log_time: float, table: Table) -> None:
        self._spectra.setdefault(names.ORDERS, SpectraCollector(table.columns)).add(
            log_time, self._moment(log_time), table.data
        )

    def _section(self, stage: str) -> Callable[[float, Table], None]:
        def take(_log_time: float, table: Table) -> None:
            points = table.select(names.SECTION_COLUMNS)
            self._sections[stage].add(points[np.argsort(points[:, 0], kind="stable")])

        return take

    def _indicators(self, mesh: str) -> Callable[[float, Table], None]:
        def take(log_time: float, table: Table) -> None:
            if mesh == names.MESHES[0] and np.isfinite(table.data[-1, 1:]).any():  # its window is filled: so is theirs
                for collector in self._spectra.values():
                    collector.made(log_time, float(table.column("time")[-1]))
            _add_row(self._rows, mesh, table)

        return take

    def _bearing_row(self, bearing: str) -> Callable[[float, Table], None]:
        def take(_log_time: float, table: Table) -> None:
            _add_row(self._bearing_rows, bearing, table)

        return take

    # --- the result ---------------------------------------------------------------------------------------------------

    def result(
        self,
        source: Path,
        complete: bool,
        bounds: tuple[float, float],
        topics: Mapping[str, tuple[str, int]],
        provenance: Mapping[str, Mapping[str, str]],
    ) -> RunData:
        """What was gathered.

        Args:
            source: the recording's folder.
            complete: whether the recording was healthy.
            bounds: first and last log time (s), for recordings without stamps to go by.
            topics: name to (type, count).
            provenance: metadata of the recording.
        """
        if self._restarts:
            self.remarks.append(
                f"The run was restarted while recording ({self._restarts}x); the report shows the last run."
            )
        start, end = (self._first, self._last) if np.isfinite(self._first) else bounds
        wave = self._waveform.result() if self._waveform is not None else None
        spectra = {topic: collector.result() for topic, collector in self._spectra.items()}
        sections = {stage: kept.result() for stage, kept in self._sections.items()}
        run = RunData(
            source=source,
            complete=complete,
            remarks=tuple(self.remarks),
            start=start,
            end=end,
            topics=topics,
            provenance=provenance,
            wind=self._wind.result(),
            speed=self._speed.result(),
            torque=self._torque.result(),
            mesh_force=self._mesh_force.result(),
            bearing_radial={b: band for b, s in self._radial.items() if (band := s.result()) is not None},
            bearing_axial={b: band for b, s in self._axial.items() if (band := s.result()) is not None},
            waveform=wave,
            spectra=spectra.get(names.SPECTRUM),
            orders=spectra.get(names.ORDERS),
            sections={stage: points for stage, points in sections.items() if points is not None},
            indicators={mesh: rows.result() for mesh, rows in sorted(self._rows.items())},
            bearing_indicators={bearing: rows.result() for bearing, rows in self._bearing_rows.items()},
            spans=self._states.result(start, end),
            values=self._states.values,
            truth=self._known.last,
            truth_means=self._known.means(),
            truth_message=self._known.message,
        )
        end_of_run = windows.tail(run)
        return run if end_of_run is None else dataclasses.replace(run, windows=(end_of_run,))


def _add_row(rows: dict[str, RowsCollector], place: str, table: Table) -> None:
    """Take a row of indicators; a table with other columns starts over."""
    if place not in rows or rows[place].columns != table.columns:
        rows[place] = RowsCollector(table.columns)
    rows[place].add(table.data)
