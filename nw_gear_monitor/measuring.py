"""Indicators of all channels and bearings of a machine, second by second: which window each of them gets."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

import numpy as np

from nw_gear_common.tables import Array, Table
from nw_gear_monitor.indicators import bearing_envelope, bearing_registry, gear_turns, registry
from nw_gear_monitor.indicators.bearing_window import BearingWindow
from nw_gear_monitor.indicators.window import LineResult, Memory, MeshWindow, TurnsWindow
from nw_gear_monitor.machine import AXES, Bearing, Machine
from nw_gear_monitor.signals.cycles import whole_cycles
from nw_gear_monitor.signals.history import History
from nw_gear_monitor.signals.resample import LARGEST_SPEED_RATIO

TURN = 2.0 * np.pi
HOLD = 4
"""Hops from one evaluation of a window longer than the short one to the next; channels and bearings take turns."""
TURNS_COLUMNS = tuple(c.name for c in (*gear_turns.SIDEBANDS.columns, *gear_turns.AVERAGES.columns))
ENVELOPE_COLUMNS = tuple(c.name for c in bearing_envelope.INDICATOR.columns)


class Held:
    """Numbers of long windows, shown again until they are computed anew.

    Args:
        columns: that it is about.
    """

    def __init__(self, columns: tuple[str, ...]) -> None:
        self._columns = columns
        self._last: dict[str, Array] = {}

    def clear(self) -> None:
        """Forget everything."""
        self._last.clear()

    def due(self, time: float, number: int) -> bool:
        """Whether it is this one's turn."""
        return (round(time) + number) % HOLD == 0

    def drop(self, name: str) -> None:
        """Forget the numbers of one place, whose window isn't there any more."""
        self._last.pop(name, None)

    def show(self, name: str, row: Table, *, fresh: bool) -> None:
        """Remember the numbers of a row, or put the remembered ones into it."""
        where = [row.index(column) for column in self._columns]
        if fresh:
            self._last[name] = row.data[0, where]
        elif name in self._last:
            row.data[0, where] = self._last[name]


class Measuring:
    """Computes the rows of `indicators/<channel>` and `indicators/<bearing>`.

    Args:
        machine: what is watched.
        short, long: seconds of the time-domain window, and of the longest one.
        band: of the bearings' envelopes, Hz.
    """

    def __init__(self, machine: Machine, short: int, long: int, band: tuple[float, float]) -> None:
        self._machine = machine
        self._short, self._long, self._band = short, long, band
        self._strobes: dict[str, deque[Array]] = {name: deque(maxlen=long) for name in machine.channel_names}
        self._memory: dict[str, Memory] = {}
        self._turns_held, self._envelopes_held = Held(TURNS_COLUMNS), Held(ENVELOPE_COLUMNS)
        self.flush()

    def flush(self) -> None:
        """Forget everything that was kept from earlier seconds."""
        for kept in self._strobes.values():
            kept.clear()
        self._memory = {name: Memory() for name in self._machine.channel_names}
        self._turns_held.clear()
        self._envelopes_held.clear()

    def strobe(self, points: Mapping[str, Array]) -> None:
        """Keep the newest second's section points, channel -> (points, 3): time, x, v."""
        for name, new in points.items():
            self._strobes[name].append(new[:, 1:])

    def channels(
        self, time: float, history: History, numbers: Mapping[str, LineResult], turning: bool
    ) -> dict[str, Table]:
        """One row per channel; NaN while the short window isn't filled."""
        machine = self._machine
        if len(history) < self._short:
            return {name: registry.evaluate(time, None) for name in machine.channel_names}
        data = _latest(history, (*machine.phase_columns, *machine.x_columns, *machine.v_columns), self._short)
        stages, count = len(machine.stages), len(machine.channels)
        turns = self._turns(time, history) if turning else {}
        tables = {}
        # a channel that doesn't move has no indicators, rather than an rms of zero
        for number, channel in enumerate(machine.channels):
            window = MeshWindow(
                channel.name,
                history.newest.rate,
                data[:, machine.stage_names.index(channel.stage)] + channel.planet_phase,
                data[:, stages + number].copy(),
                data[:, stages + count + number].copy(),
                numbers.get(channel.name),
                turns.get(channel.name),
                self._section(channel.name) if turning else None,
                machine.stage(channel.stage).half_gap,
                self._memory[channel.name],
            )
            row = registry.evaluate(time, window if np.ptp(window.x) > 0.0 else None)
            self._turns_held.show(channel.name, row, fresh=channel.name in turns)
            tables[channel.name] = row
        return tables

    def bearings(self, time: float, history: History, turning: bool) -> dict[str, Table]:
        """One row per bearing whose columns are in the waveform; NaN while the short window isn't filled."""
        tables = {}
        there = [b for b in self._machine.bearings if all(c in history.newest.columns for c in columns_of(b))]
        for number, bearing in enumerate(there):
            long = self._envelope_window(bearing, history, time, number) if turning else None
            window = self._bearing(bearing, history, turning, long) if len(history) >= self._short else None
            alive = window is not None and bool(np.any(np.ptp(window.components, axis=0) > 0.0))
            row = bearing_registry.evaluate(time, window if alive else None)
            self._envelopes_held.show(bearing.name, row, fresh=long is not None)
            tables[bearing.name] = row
        return tables

    def _section(self, channel: str) -> Array | None:
        kept = self._strobes[channel]
        return np.concatenate(kept) if kept else None

    def _turns(self, time: float, history: History) -> dict[str, TurnsWindow]:
        """The windows of the channels whose turn it is."""
        found: dict[str, TurnsWindow] = {}
        for stage in self._machine.stages:
            if stage.teeth is None:
                continue
            members = self._machine.members[stage.name]
            frequency = _frequency(history, f"phase_{stage.name}")
            seconds = gear_turns.wanted_seconds(frequency, stage.teeth, self._short, self._long)
            if seconds is None or len(history) < seconds:
                for name in members:
                    self._turns_held.drop(name)
                continue
            every = seconds <= self._short
            due = [name for i, name in enumerate(members) if every or self._turns_held.due(time, i)]
            found |= _turns_of(stage.name, stage.teeth, due, history, seconds)
        return found

    def _envelope_window(self, bearing: Bearing, history: History, time: float, number: int) -> Array | None:
        """Phase of the mesh and the bearing's columns over the long window; None where it isn't there or not due."""
        shaft = self._machine.shaft(bearing.shaft)
        phase = f"phase_{shaft.stage}"
        seconds = None
        if bearing.orders is not None:
            frequency = _frequency(history, phase) / shaft.teeth
            seconds = bearing_envelope.wanted_seconds(frequency, bearing.orders.cage, self._short, self._long)
        if seconds is None or len(history) < seconds:
            self._envelopes_held.drop(bearing.name)
            return None
        if seconds > self._short and not self._envelopes_held.due(time, number):
            return None
        data = _latest(history, (phase, *columns_of(bearing)), seconds)
        return data if _grows(data[:, 0]) else None

    def _bearing(self, bearing: Bearing, history: History, turning: bool, long: Array | None) -> BearingWindow:
        rate = history.newest.rate
        shaft = self._machine.shaft(bearing.shaft)
        data = _latest(history, (f"phase_{shaft.stage}", *columns_of(bearing)), self._short)
        return BearingWindow(
            rate=rate,
            size=_signal(data[:, 1:], bearing.unit),
            components=data[:, 1:],
            phase=data[:, 0] / shaft.teeth if turning and _grows(data[:, 0]) else None,
            long_size=None if long is None else _signal(long[:, 1:], bearing.unit),
            long_phase=None if long is None else long[:, 0] / shaft.teeth,
            orders=bearing.orders,
            band=bearing_envelope.usable_band(self._band, rate),
        )


def _turns_of(
    stage: str, teeth: tuple[int, int], members: list[str], history: History, seconds: int
) -> dict[str, TurnsWindow]:
    if not members:
        return {}
    data = _latest(history, (f"phase_{stage}", *(f"{a}_{name}" for a in ("x", "v") for name in members)), seconds)
    if not _grows(data[:, 0]) or not _even(data[:, 0]):
        return {}
    x, v = data[:, 1 : 1 + len(members)], data[:, 1 + len(members) :]
    cycles = whole_cycles(data[:, 0], x, v, 1.0 / history.newest.rate)
    return {name: TurnsWindow(cycles[i], teeth) for i, name in enumerate(members)}


def _even(phase: Array) -> bool:
    """Whether the slowest speed is near enough to the mean for one number of points per turn (not while starting)."""
    steps = np.diff(phase)
    return bool(steps.mean() < LARGEST_SPEED_RATIO * steps.min())


def columns_of(bearing: Bearing) -> tuple[str, ...]:
    """A bearing's columns inside the monitor."""
    return tuple(f"{axis}_{bearing.name}" for axis, _ in zip(AXES, bearing.columns, strict=False))


def _signal(parts: Array, unit: str) -> Array:
    """One signal of a bearing: the magnitude of a force, else the direction in which it varies most; (samples,)."""
    if parts.shape[1] == 1:
        return np.ascontiguousarray(parts[:, 0])
    if unit == "N":
        return np.hypot(parts[:, 0], parts[:, 1])
    _, directions = np.linalg.eigh(np.cov(parts.T))
    along: Array = parts @ directions[:, -1]
    return along


def _latest(history: History, columns: tuple[str, ...], seconds: int) -> Array:
    """The newest samples: a fixed number of them, however many fell into each second."""
    return history.select(columns, seconds + 1)[-round(seconds * history.newest.rate) :]


def _frequency(history: History, phase: str) -> float:
    """Turns of a phase per second in the newest second, Hz."""
    newest = history.newest.column(phase)
    return float((newest[-1] - newest[0]) * history.newest.rate / (TURN * (newest.size - 1)))


def _grows(phase: Array) -> bool:
    return bool(np.all(np.diff(phase) > 0))
