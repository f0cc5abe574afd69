"""Publishes what accelerometers and a tacho would show; see `nw_gear_sim.sensors`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray

from nw_gear_common import names
from nw_gear_common.diagnostics import OK, WARN, Diagnostics
from nw_gear_common.errors import InputError
from nw_gear_common.ros import live_qos, to_message
from nw_gear_common.tables import Array, Table
from nw_gear_sim.nodes.sim_settings import Settings
from nw_gear_sim.params import Configuration
from nw_gear_sim.readings import Block
from nw_gear_sim.sensors.accelerometer import Accelerometers, Sensor
from nw_gear_sim.sensors.path import housings_of
from nw_gear_sim.sensors.tacho import Tacho

DEPTH = 100
ACKNOWLEDGE_WITHIN = 3.0
_ACCELERATION, _TACHO = "sensors.acceleration.", "sensors.tacho."
_PENDING, _COLUMNS, _SHAFT = "sensors.pending", "sensors.columns", "sensors.shaft"


def wanted(settings: Settings) -> bool:
    """Whether there is any sensor."""
    return bool(settings.accelerometers) or bool(settings.tacho_shaft)


class Sensing:
    """Accelerometers and tacho of a node.

    Args:
        node: publishes.
        settings: which sensors, and of what kind.
        configuration: of the gearbox with its housings.
        force_rate: of the samples that will come, Hz.

    Raises:
        InputError: a rate of the accelerometers that doesn't fit.
    """

    def __init__(self, node: Node, settings: Settings, configuration: Configuration, force_rate: float) -> None:
        bearings = settings.accelerometers
        self._accelerometers: Acceleration | None = None
        self._tacho: Pulses | None = None
        if bearings:
            sensor = _sensor(settings)
            inner = Accelerometers(housings_of(configuration, bearings), sensor, force_rate, settings.sensor_seed)
            self._accelerometers = Acceleration(node, bearings, inner, sensor.rate)
        if settings.tacho_shaft:
            self._tacho = Pulses(node, settings.tacho_shaft, settings.tacho_pulses)
        self._diagnostics = Diagnostics(node)

    def compile(self) -> None:
        """Compile what will be called, or load it."""
        if self._accelerometers is not None:
            self._accelerometers.inner.compile()

    def add(self, block: Block | None, start: float) -> None:
        """Take samples of every step, whose time zero is at `start` (s of ROS time), and publish what is complete."""
        if block is None:
            return
        if self._accelerometers is not None:
            self._accelerometers.add(block, start)
        if self._tacho is not None:
            self._tacho.add(block, start)

    def drop(self) -> None:
        """Begin anew (reset)."""
        if self._accelerometers is not None:
            self._accelerometers.drop()
        if self._tacho is not None:
            self._tacho.inner.forget()

    def checkpoint(self) -> dict[str, Any]:
        """Return all that the future depends on."""
        out: dict[str, Any] = {}
        if self._accelerometers is not None:
            out |= {_ACCELERATION + name: value for name, value in self._accelerometers.inner.state().items()}
            out |= {_PENDING: self._accelerometers.pending.copy(), _COLUMNS: ",".join(self._accelerometers.columns)}
        if self._tacho is not None:
            out |= {_TACHO + name: value for name, value in self._tacho.inner.state().items()}
            out[_SHAFT] = self._tacho.shaft
        return out

    def restore(self, values: Mapping[str, Any]) -> None:
        """Take over what `checkpoint` returned.

        Raises:
            InputError: it is of other sensors.
        """
        if self._accelerometers is not None:
            self._accelerometers.restore(values)
        if self._tacho is not None:
            if values.get(_SHAFT) != self._tacho.shaft:
                got = str(values.get(_SHAFT, "nothing"))
                raise InputError(f"checkpoint: {_SHAFT}", self._tacho.shaft, got)
            self._tacho.inner.restore(_part(values, _TACHO))

    def flush(self) -> bool:
        """Wait until every subscriber has acknowledged everything."""
        publishers = [part.publisher for part in (self._accelerometers, self._tacho) if part is not None]
        return all(publisher.wait_for_all_acked(Duration(seconds=ACKNOWLEDGE_WITHIN)) for publisher in publishers)

    def report(self, seconds: float) -> None:
        """Say in /diagnostics whether the accelerometers can show what they feel."""
        if self._accelerometers is None:
            return
        clipped = self._accelerometers.clipped_since()
        where = [name for name, times in clipped.items() if times]
        message = f"clipped: {', '.join(where)}" if where else "within their range"
        values = {f"clipped {name} (1)": f"{clipped[name]:.0f}" for name in where}
        status = self._diagnostics.status("accelerometers", WARN if where else OK, message, values)
        self._diagnostics.publish([status], seconds)


class Acceleration:
    """Collects samples of the accelerometers until a block is full, then publishes it.

    Attributes:
        inner: the sensors; columns: of the table; pending: (rows, columns) that wait, times since the run's start;
            publisher: of the topic.
    """

    def __init__(self, node: Node, bearings: tuple[str, ...], inner: Accelerometers, rate: float) -> None:
        rows = rate / names.WAVEFORM_BLOCKS_PER_SECOND
        if rows != int(rows):
            expected = f"a multiple of {names.WAVEFORM_BLOCKS_PER_SECOND} Hz"
            raise InputError("parameter acceleration_rate", expected, f"{rate:g} Hz")
        self.inner = inner
        self.columns = names.acceleration_columns(bearings)
        self.publisher = node.create_publisher(Float64MultiArray, names.ACCELERATION, live_qos(DEPTH))
        self._bearings = [names.BEARINGS.index(b) for b in bearings]
        self._rate, self._rows = rate, int(rows)
        self.pending = np.empty((0, len(self.columns)))
        self._starts = np.empty(0)
        self._told = np.zeros(inner.channels)

    def add(self, block: Block, start: float) -> None:
        """Take forces; publish when full."""
        force: Array = block.bearing_force[:, self._bearings, :2].reshape(len(block.time), -1)
        first, samples = self.inner.advance(force)
        time = (first + np.arange(len(samples))) / self._rate
        self.pending = np.concatenate([self.pending, np.column_stack([time, samples])])
        self._starts = np.concatenate([self._starts, np.full(len(samples), start)])
        while len(self.pending) >= self._rows:
            table = self.pending[: self._rows].copy()
            starts = self._starts[: self._rows]
            table[:, 0] += np.where(np.isnan(starts), start, starts)  # not known when a run is taken up again
            self.publisher.publish(to_message(Table(names.ROW_SAMPLE, self.columns, table)))
            self.pending, self._starts = self.pending[self._rows :], self._starts[self._rows :]

    def drop(self) -> None:
        """Begin anew."""
        self.inner.forget()
        self.pending, self._starts = self.pending[:0], self._starts[:0]
        self._told[:] = 0.0

    def restore(self, values: Mapping[str, Any]) -> None:
        """Take over the state of a checkpoint."""
        columns = ",".join(self.columns)
        if values.get(_COLUMNS) != columns:
            raise InputError(f"checkpoint: {_COLUMNS}", columns, str(values.get(_COLUMNS, "nothing")))
        rows = np.asarray(values.get(_PENDING))
        if rows.ndim != 2 or rows.shape[1] != len(self.columns) or len(rows) >= self._rows:
            expected = f"less than {self._rows} rows of {len(self.columns)} columns"
            raise InputError(f"checkpoint: {_PENDING}", expected, f"shape {rows.shape}")
        self.inner.restore(_part(values, _ACCELERATION))
        self.pending, self._starts = rows.astype(np.float64), np.full(len(rows), np.nan)
        self._told = self.inner.clipped.copy()

    def clipped_since(self) -> dict[str, float]:
        """How many samples of each column were at their end since the last call."""
        fresh = self.inner.clipped - self._told
        self._told = self.inner.clipped.copy()
        return dict(zip(self.columns[1:], fresh.tolist(), strict=True))


class Pulses:
    """Publishes the pulses of a tacho; `inner` finds them on a `shaft`, `publisher` is that of the topic."""

    def __init__(self, node: Node, shaft: str, pulses: int) -> None:
        self.inner = Tacho(pulses)
        self.shaft, self._column = shaft, names.SHAFTS.index(shaft)
        self.publisher = node.create_publisher(Float64MultiArray, names.TACHO, live_qos(DEPTH))

    def add(self, block: Block, start: float) -> None:
        """Take angles; publish pulses where there are any."""
        times = self.inner.advance(block.time, block.shaft_angle[:, self._column], block.shaft_speed[:, self._column])
        if times.size:
            table = Table(names.ROW_PULSE, names.TACHO_COLUMNS, (start + times)[:, None])
            self.publisher.publish(to_message(table))


def _sensor(settings: Settings) -> Sensor:
    return Sensor(
        rate=settings.acceleration_rate or settings.sample_rate,
        range=settings.acceleration_range,
        noise=settings.acceleration_noise,
        sensitivity=settings.acceleration_sensitivity,
        voltage=settings.acceleration_voltage,
        bits=settings.acceleration_bits,
    )


def _part(values: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    return {name.removeprefix(prefix): value for name, value in values.items() if name.startswith(prefix)}
