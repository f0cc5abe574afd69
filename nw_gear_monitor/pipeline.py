"""The whole monitor without ROS: blocks of the waveform in, results of every whole second out.

The live node and the offline report use this one class. Results depend on the stamped samples alone: hops fall on whole
seconds of the stamps and every number is computed afresh from its window, so that a replay gives what live gave.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.quantities import quantity
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.indicators.window import LineResult
from nw_gear_monitor.labelling import Labeller, StageReport
from nw_gear_monitor.machine import Machine
from nw_gear_monitor.measuring import Measuring, columns_of
from nw_gear_monitor.operating import Operating, operating_point
from nw_gear_monitor.signals.history import History
from nw_gear_monitor.signals.linefit import NYQUIST_SHARE
from nw_gear_monitor.signals.section import section
from nw_gear_monitor.signals.spectrum import ORDER_CYCLES, amplitude_spectrum, order_spectrum, orders
from nw_gear_monitor.signals.stream import Continuity, Second, Stream

STANDSTILL = 0.01
"""Share of rated speed under which the gearbox counts as not turning."""
SECTION_MARGIN = 4
"""Samples of the second before that serve the interpolation of the first section points."""


@dataclass(frozen=True)
class Windows:
    """Lengths of the monitor's windows; every hop is one second."""

    spectrum_seconds: int = quantity(4, "Window of spectra and time-domain indicators.", "s", minimum=1, maximum=16)
    label_seconds: int = quantity(
        16, "Window of the state labels; from 8 s on a shorter one is used.", "s", minimum=8, maximum=64
    )
    section_phase: float = quantity(0.0, "Mesh phase of the Poincaré sections.", "rad", minimum=-7.0, maximum=7.0)
    envelope_low: float = quantity(
        500.0, "Lower limit of the band of the bearings' envelopes.", "Hz", minimum=1.0, maximum=1e5
    )
    envelope_high: float = quantity(
        2000.0, "Its upper limit; 0.45 of the sample rate where that is lower.", "Hz", minimum=2.0, maximum=1e5
    )


@dataclass(frozen=True)
class BearingForce:
    """Signal of one bearing over a second, in its unit.

    Attributes:
        mean: of the magnitude.
        rms: of a force the standard deviation of the magnitude, of anything else (an acceleration) that of the signal.
        peak: largest magnitude.
    """

    mean: float
    rms: float
    peak: float


@dataclass(frozen=True, eq=False)
class Hop:
    """What one second gave.

    Attributes:
        time: end of the second, s.
        restarted: the second doesn't continue the one before (gap, restart): all windows began anew.
        turning: whether the gearbox turns.
        spectrum, orders: tables; None until their window is filled (`orders` also at standstill).
        sections: stage -> table of its new points.
        indicators: mesh -> table of one row.
        stages: stage -> its state and evidence.
        bearings: bearing -> its force, for those in the waveform.
        bearing_indicators: bearing -> table of one row, for those in the waveform.
        operating: speed and load of the second.
        rate: samples per second, Hz.
    """

    time: float
    restarted: bool
    turning: bool
    spectrum: Table | None
    orders: Table | None
    sections: dict[str, Table]
    indicators: dict[str, Table]
    stages: dict[str, StageReport]
    bearings: dict[str, BearingForce]
    bearing_indicators: dict[str, Table]
    operating: Operating
    rate: float


class Pipeline:
    """The monitor of one machine.

    Args:
        machine: its stages, channels, shafts and bearings.
        windows: their lengths.
    """

    def __init__(self, machine: Machine, windows: Windows | None = None) -> None:
        self._machine = machine
        self._windows = windows if windows is not None else Windows()
        self._stream = Stream(machine.layout)
        seconds = max(self._windows.label_seconds, self._windows.spectrum_seconds) + 1
        self._history = History(seconds, machine.derived)
        self._labeller = Labeller(machine, self._windows.label_seconds)
        short, long = self._windows.spectrum_seconds, max(self._windows.label_seconds, self._windows.spectrum_seconds)
        band = self._windows.envelope_low, self._windows.envelope_high
        self._measuring = Measuring(machine, short, long, band)

    @property
    def continuity(self) -> Continuity:
        """Counters of gaps, restarts and malformed blocks."""
        return self._stream.continuity

    def reset(self) -> None:
        """Flush every window; the counters stay."""
        self._stream.reset()
        self._history.clear()
        self._labeller.flush("reset")
        self._measuring.flush()

    def reject(self, reason: str) -> None:
        """Count a block that could not even be turned into a table."""
        self._stream.reject(reason)

    def feed(self, table: Table) -> list[Hop]:
        """Take one block of the waveform in; returns a result for each second that it completed.

        A block that can't be read is counted in `continuity` and dropped.
        """
        return [self._hop(self._machine.inside(second)) for second in self._stream.feed(table)]

    def _hop(self, second: Second) -> Hop:
        restarted = self._history.append(second)
        if restarted:
            self._labeller.flush("the stream was interrupted")
            self._measuring.flush()
        turning = self._turns(second)
        self._stream.continuity.constant = self._constant(second) if turning else ()
        if turning:
            stages, numbers = self._labelled(second)
            points = {stage: self._points(stage) for stage in self._machine.stage_names}
            for own in points.values():
                self._measuring.strobe(own)
        else:
            stages, numbers, points = self._labeller.flush("not turning"), {}, {}
            self._measuring.flush()
        filled = len(self._history) >= self._windows.spectrum_seconds
        time = second.start + 1.0
        return Hop(
            time=time,
            restarted=restarted,
            turning=turning,
            spectrum=self._spectrum() if filled else None,
            orders=self._orders() if filled and turning else None,
            sections={stage: self._section(own) for stage, own in points.items()},
            indicators=self._measuring.channels(time, self._history, numbers, turning),
            stages=stages,
            bearings=self._bearings(second),
            bearing_indicators=self._measuring.bearings(time, self._history, turning),
            operating=operating_point(second, self._machine),
            rate=second.rate,
        )

    def _labelled(self, second: Second) -> tuple[dict[str, StageReport], dict[str, LineResult]]:
        """States of the stages; none where the samples can't carry every mesh line, which would show as another."""
        ends = np.column_stack([second.column(name)[[0, -1]] for name in self._machine.phase_columns])
        fastest = float(np.max(ends[1] - ends[0])) * second.rate / (2.0 * np.pi * (len(second.data) - 1))
        if fastest > NYQUIST_SHARE * second.rate:
            reason = f"{second.rate:g} samples a second are too few for a mesh frequency of {fastest:.4g} Hz"
            return self._labeller.flush(reason), {}
        return self._labeller.add(self._history)

    def _turns(self, second: Second) -> bool:
        columns = self._machine.phase_columns
        phase = second.column(columns[0])
        frequency = (phase[-1] - phase[0]) * second.rate / (2.0 * np.pi * (phase.size - 1))
        grows = all(bool(np.all(np.diff(second.column(name)) > 0)) for name in columns)
        return grows and bool(frequency > STANDSTILL * self._machine.rated_frequency[0])

    def _constant(self, second: Second) -> tuple[str, ...]:
        """Columns of the waveform that say nothing: not one sample differs from the others."""
        still = np.ptp(second.data, axis=0) == 0.0
        return tuple(self._machine.source(name) for name, dead in zip(second.columns, still, strict=True) if dead)

    def _latest(self, columns: tuple[str, ...]) -> Array:
        """The newest spectrum window: a fixed number of samples, however many fell into each second."""
        seconds = self._windows.spectrum_seconds
        return self._history.select(columns, seconds + 1)[-round(seconds * self._history.newest.rate) :]

    def _spectrum(self) -> Table:
        frequency, amplitude = amplitude_spectrum(self._latest(self._machine.x_columns), self._history.newest.rate)
        return Table(
            names.ROW_BIN, ("frequency", *self._machine.channel_names), np.column_stack([frequency, amplitude])
        )

    def _orders(self) -> Table | None:
        grid = orders()
        columns = np.empty((grid.size, 1 + len(self._machine.channels)))
        columns[:, 0] = grid
        rate = self._history.newest.rate
        for own, (stage, meshes) in zip(self._machine.phase_columns, self._machine.members.items(), strict=True):
            newest = self._history.newest.column(own)
            frequency = (newest[-1] - newest[0]) * rate / (2.0 * np.pi * (newest.size - 1))
            seconds = max(int(np.ceil(ORDER_CYCLES / frequency)) + 1, self._windows.spectrum_seconds)
            wanted = (own, *(f"{axis}_{mesh}" for axis in ("x", "v") for mesh in meshes))
            data = self._history.select(wanted, seconds)
            if not np.all(np.diff(data[:, 0]) > 0):
                return None
            x, v = data[:, 1 : 1 + len(meshes)], data[:, 1 + len(meshes) :]
            columns[:, 1 + np.array(self._machine.places[stage])] = order_spectrum(data[:, 0], x, v, 1.0 / rate)
        return Table(names.ROW_ORDER, ("order", *self._machine.channel_names), columns)

    def _points(self, stage: str) -> dict[str, Array]:
        """New section points of each of a stage's channels, (points, 3): time, x, v."""
        newest = self._history.newest
        members = self._machine.members[stage]
        own = (f"{axis}_{name}" for name in members for axis in ("x", "v"))
        data = self._history.select(("time", f"phase_{stage}", *own), 2)
        rows = len(newest.data)
        data = data[-(rows + SECTION_MARGIN) :]
        low = 1.0 if len(data) > rows else 0.0
        found = {}
        for number, name in enumerate(members):
            phase = data[:, 1] + self._machine.channel(name).planet_phase
            x, v = data[:, 2 + 2 * number], data[:, 3 + 2 * number]
            found[name] = section(data[:, 0], phase, x, v, self._windows.section_phase, low, len(data) - 3.0)
        return found

    def _section(self, points: dict[str, Array]) -> Table:
        parts = []
        for name, own in points.items():
            planet = np.full(len(own), float(self._machine.channel(name).planet))
            parts.append(np.column_stack([own[:, 0], planet, own[:, 1:]]))
        merged = np.concatenate(parts)
        return Table(names.ROW_POINT, names.SECTION_COLUMNS, merged[np.argsort(merged[:, 0], kind="stable")])

    def _bearings(self, second: Second) -> dict[str, BearingForce]:
        forces = {}
        for bearing in self._machine.bearings:
            own = columns_of(bearing)
            if all(name in second.columns for name in own):
                parts = np.stack([second.column(name) for name in own])
                size = np.sqrt(np.sum(parts * parts, axis=0))
                spread = np.std(size) if bearing.unit == "N" else np.sqrt(np.sum(np.var(parts, axis=1)))
                forces[bearing.name] = BearingForce(float(size.mean()), float(spread), float(size.max()))
        return forces
