"""Indicators of all channels and bearings of a machine, second by second: which window each of them gets."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

import numpy as np

from nw_gear_common.tables import Array, Table
from nw_gear_monitor.indicators import bearing_envelope, bearing_registry, gear_turns, registry
from nw_gear_monitor.indicators.bearing_window import BearingWindow
from nw_gear_monitor.indicators.window import LineResult, Memory, MeshWindow, TurnsWindow
from nw_gear_monitor.machine import AXES, Bearing, Machine, Stage
from nw_gear_monitor.signals.cycles import whole_cycles
from nw_gear_monitor.signals.history import History

TURN = 2.0 * np.pi


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
        self.flush()

    def flush(self) -> None:
        """Forget everything that was kept from earlier seconds."""
        for kept in self._strobes.values():
            kept.clear()
        self._memory = {name: Memory() for name in self._machine.channel_names}

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
        turns = self._turns(history) if turning else {}
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
            tables[channel.name] = registry.evaluate(time, window if np.ptp(window.x) > 0.0 else None)
        return tables

    def bearings(self, time: float, history: History, turning: bool) -> dict[str, Table]:
        """One row per bearing whose columns are in the waveform; NaN while the short window isn't filled."""
        tables = {}
        for bearing in self._machine.bearings:
            own = columns_of(bearing)
            if all(name in history.newest.columns for name in own):
                filled = len(history) >= self._short
                window = self._bearing(bearing, own, history, turning) if filled else None
                alive = window is not None and bool(np.any(np.ptp(window.components, axis=0) > 0.0))
                tables[bearing.name] = bearing_registry.evaluate(time, window if alive else None)
        return tables

    def _section(self, channel: str) -> Array | None:
        kept = self._strobes[channel]
        return np.concatenate(kept) if kept else None

    def _turns(self, history: History) -> dict[str, TurnsWindow]:
        found: dict[str, TurnsWindow] = {}
        for stage in self._machine.stages:
            if stage.teeth is not None:
                found |= self._turns_of(stage, stage.teeth, history)
        return found

    def _turns_of(self, stage: Stage, teeth: tuple[int, int], history: History) -> dict[str, TurnsWindow]:
        members, own = self._machine.members[stage.name], f"phase_{stage.name}"
        frequency = _frequency(history, own)
        seconds = gear_turns.wanted_seconds(frequency, teeth, self._short, self._long)
        if seconds is None or len(history) < seconds:
            return {}
        wanted = (own, *(f"{axis}_{name}" for axis in ("x", "v") for name in members))
        data = _latest(history, wanted, seconds)
        if not _grows(data[:, 0]):
            return {}
        count = len(members)
        x, v = data[:, 1 : 1 + count], data[:, 1 + count :]
        cycles = whole_cycles(data[:, 0], x, v, 1.0 / history.newest.rate)
        return {name: TurnsWindow(cycles[i], teeth) for i, name in enumerate(members)}

    def _bearing(self, bearing: Bearing, own: tuple[str, ...], history: History, turning: bool) -> BearingWindow:
        rate = history.newest.rate
        shaft = self._machine.shaft(bearing.shaft)
        phase_column = f"phase_{shaft.stage}"
        data = _latest(history, (phase_column, *own), self._short)
        long_phase, long_signal = None, None
        if turning and bearing.orders is not None:
            frequency = _frequency(history, phase_column) / shaft.teeth
            seconds = bearing_envelope.wanted_seconds(frequency, bearing.orders.cage, self._short, self._long)
            if seconds is not None and len(history) >= seconds:
                more = _latest(history, (phase_column, *own), seconds)
                if _grows(more[:, 0]):
                    long_phase, long_signal = more[:, 0] / shaft.teeth, _signal(more[:, 1:], bearing.unit)
        return BearingWindow(
            rate=rate,
            size=_signal(data[:, 1:], bearing.unit),
            components=data[:, 1:],
            phase=data[:, 0] / shaft.teeth if turning and _grows(data[:, 0]) else None,
            long_size=long_signal,
            long_phase=long_phase,
            orders=bearing.orders,
            band=bearing_envelope.usable_band(self._band, rate),
        )


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
