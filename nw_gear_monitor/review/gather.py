"""Gathers what the report shows from the messages of a recording, in one pass and with bounded memory."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.review.collect import SECTION_SECONDS, RowsCollector, Series, WaveformCollector, missing_columns
from nw_gear_monitor.review.collect_spectra import SpectraCollector
from nw_gear_monitor.review.collect_status import DiagnosticsCollector, TruthCollector
from nw_gear_monitor.review.decimate import Tail
from nw_gear_monitor.review.rundata import RunData

BACKWARD = 0.5
"""Seconds by which the waveform must step back to count as a restart of the run."""


def _stamp(message: Any) -> float:
    stamp = message.header.stamp
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


class Gatherer:
    """Sorts messages, by topic relative to the suite's namespace, into collectors.

    The run that the report shows is the last one in the recording: a waveform that steps back in time (reset, restart)
    starts over, and a remark says so.
    """

    def __init__(self) -> None:
        self.remarks: list[str] = []
        self._restarts = 0
        self._fresh()
        self._handlers: dict[str, Callable[[float, Any], None]] = {
            names.WIND_SPEED: self._wind_speed,
            names.SHAFTS_TOPIC: self._shafts,
            names.MESH_TOPIC: self._mesh,
            names.TRUTH: self._truth,
            names.DIAGNOSTICS: self._diagnostics,
            **{names.bearing_topic(b): self._bearing(i) for i, b in enumerate(names.BEARINGS)},
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

    def _fresh(self) -> None:
        self._first, self._last = np.inf, -np.inf
        self._wind = Series(("wind",))
        self._speed, self._torque = Series(names.SHAFTS), Series(names.SHAFTS)
        self._mesh_force = Series(names.MESHES)
        self._radial = {b: Series((b,)) for b in names.BEARINGS}
        self._axial = {b: Series((b,)) for b in names.BEARINGS}
        self._waveform: WaveformCollector | None = None
        self._spectra: dict[str, SpectraCollector] = {}
        self._sections = {s: Tail(SECTION_SECONDS) for s in names.STAGES}
        self._rows: dict[str, RowsCollector] = {}
        self._bearing_rows: dict[str, RowsCollector] = {}
        self._states = DiagnosticsCollector()
        self._known = TruthCollector()

    def take(self, topic: str, log_time: float, value: Any) -> None:
        """Take a table or a decoded message of one of `topics`; what isn't of that topic's kind is left out."""
        if isinstance(value, Table):
            if topic in self._table_handlers and len(value):
                self._table_handlers[topic](log_time, value)
        elif topic in self._handlers:
            self._handlers[topic](log_time, value)

    # --- one handler per topic ----------------------------------------------------------------------------------------

    def _seen(self, first: float, last: float) -> None:
        self._first, self._last = min(self._first, first), max(self._last, last)

    def _wind_speed(self, _log_time: float, message: Any) -> None:
        self._wind.add(_stamp(message), [message.vector.x])

    def _shafts(self, _log_time: float, message: Any) -> None:
        time = _stamp(message)
        self._seen(time, time)
        self._speed.add(time, list(message.velocity))
        self._torque.add(time, list(message.effort))

    def _mesh(self, _log_time: float, message: Any) -> None:
        self._mesh_force.add(_stamp(message), list(message.effort))

    def _bearing(self, index: int) -> Callable[[float, Any], None]:
        bearing = names.BEARINGS[index]

        def take(_log_time: float, message: Any) -> None:
            force, time = message.wrench.force, _stamp(message)
            self._radial[bearing].add(time, [float(np.hypot(force.x, force.y))])
            self._axial[bearing].add(time, [force.z])

        return take

    def _truth(self, _log_time: float, message: Any) -> None:
        self._known.add(message)

    def _diagnostics(self, _log_time: float, message: Any) -> None:
        self._states.add(_stamp(message), message)

    def _samples(self, _log_time: float, table: Table) -> None:
        time = table.column("time")
        if self._waveform is not None and time[0] < self._waveform.last - BACKWARD:
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
            self._waveform.add(table.data)

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
        sections = {stage: tail.result() for stage, tail in self._sections.items()}
        return RunData(
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


def _add_row(rows: dict[str, RowsCollector], place: str, table: Table) -> None:
    """Take a row of indicators; a table with other columns starts over."""
    if place not in rows or rows[place].columns != table.columns:
        rows[place] = RowsCollector(table.columns)
    rows[place].add(table.data)
