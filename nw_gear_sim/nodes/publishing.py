"""Turns what the simulator computed into the messages of the contract, each at its own rate."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import WrenchStamped
from rclpy.duration import Duration
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

from nw_gear_common import names
from nw_gear_common.diagnostics import OK, Diagnostics
from nw_gear_common.errors import InputError
from nw_gear_common.ros import latched_qos, live_qos, to_message, to_stamp
from nw_gear_common.tables import Array, Table
from nw_gear_sim.readings import Block

WAVEFORM_DEPTH = 100
ACKNOWLEDGE_WITHIN = 3.0


class Waveform:
    """Collects samples until a block is full, then publishes it."""

    def __init__(self, node: Node, rows: int, bearings: tuple[str, ...]) -> None:
        self._publisher = node.create_publisher(Float64MultiArray, names.WAVEFORM, live_qos(WAVEFORM_DEPTH))
        self._columns = names.waveform_columns(bearings)
        self._bearings = [names.BEARINGS.index(b) for b in bearings]
        self._data = np.empty((rows, len(self._columns)))
        self._filled = 0

    def add(self, block: Block, start: float) -> None:
        """Take the samples of a block whose time zero is at `start` (s of ROS time); publish when full.

        The number of rows is a multiple of the block's, so that a block is never cut.
        """
        end = self._filled + len(block.time)
        forces = block.bearing_force[:, self._bearings, :2].reshape(len(block.time), -1)
        parts = ((start + block.time)[:, None], block.phase, block.x, block.v, forces)
        np.concatenate(parts, axis=1, out=self._data[self._filled : end])
        self._filled = end
        if self._filled == len(self._data):
            self._publisher.publish(to_message(Table(names.ROW_SAMPLE, self._columns, self._data)))
            self._filled = 0

    def pending(self, start: float) -> dict[str, Any]:
        """Return the samples that wait for their block to be full, with times since the run's start (s of ROS time)."""
        rows = self._data[: self._filled].copy()
        rows[:, 0] -= start
        return {"waveform.columns": ",".join(self._columns), "waveform.pending": rows}

    def restore(self, values: Mapping[str, Any]) -> None:
        """Take over what `pending` returned, its times still those since the run's start.

        Raises:
            InputError: it is of a waveform with other columns or longer blocks.
        """
        columns = ",".join(self._columns)
        if values.get("waveform.columns") != columns:
            raise InputError("checkpoint: waveform.columns", columns, str(values.get("waveform.columns", "nothing")))
        rows = np.asarray(values.get("waveform.pending"))
        if rows.ndim != 2 or rows.shape[1] != len(self._columns) or len(rows) >= len(self._data):
            expected = f"less than {len(self._data)} rows of {len(self._columns)} columns"
            raise InputError("checkpoint: waveform.pending", expected, f"shape {rows.shape}")
        self._filled = len(rows)
        self._data[: self._filled] = rows

    def move(self, seconds: float) -> None:
        """Make the times of the samples that wait later."""
        self._data[: self._filled, 0] += seconds

    def drop(self) -> None:
        """Forget samples that were not published (reset)."""
        self._filled = 0

    def subscribers(self) -> int:
        """How many subscribers are matched."""
        return int(self._publisher.get_subscription_count())

    def flush(self) -> bool:
        """Wait until every subscriber has acknowledged everything."""
        return bool(self._publisher.wait_for_all_acked(Duration(seconds=ACKNOWLEDGE_WITHIN)))


class Views:
    """Shafts, meshes and bearings for people and dashboards, at a rate in wall time."""

    def __init__(self, node: Node, rate: float) -> None:
        depth = max(10, int(rate))
        self._shafts = node.create_publisher(JointState, names.SHAFTS_TOPIC, live_qos(depth))
        self._mesh = node.create_publisher(JointState, names.MESH_TOPIC, live_qos(depth))
        self._bearings = {
            b: node.create_publisher(WrenchStamped, names.bearing_topic(b), live_qos(depth)) for b in names.BEARINGS
        }
        self._period = 1.0 / rate
        self._due = time.monotonic()

    def offer(self, block: Block, start: float) -> None:
        """Publish the last sample of a block if it is time to."""
        now = time.monotonic()
        if now < self._due:
            return
        self._due = max(self._due + self._period, now)
        stamp = to_stamp(start + float(block.time[-1]))
        self._shafts.publish(
            _joints(stamp, names.SHAFTS, block.shaft_angle[-1], block.shaft_speed[-1], block.shaft_torque[-1])
        )
        self._mesh.publish(_joints(stamp, names.MESHES, block.x[-1], block.v[-1], block.force[-1]))
        for bearing, force in zip(names.BEARINGS, block.bearing_force[-1], strict=True):
            message = WrenchStamped()
            message.header.stamp = stamp
            message.header.frame_id = bearing
            message.wrench.force.x, message.wrench.force.y, message.wrench.force.z = (float(f) for f in force)
            self._bearings[bearing].publish(message)


def _joints(stamp: object, joints: tuple[str, ...], position: Array, velocity: Array, effort: Array) -> JointState:
    message = JointState(name=list(joints))
    message.header.stamp = stamp
    message.position = position.tolist()
    message.velocity = velocity.tolist()
    message.effort = effort.tolist()
    return message


class Reports:
    """Truth, diagnostics and clock."""

    def __init__(self, node: Node, with_clock: bool) -> None:
        self._truth = node.create_publisher(DiagnosticStatus, names.TRUTH, latched_qos())
        self._diagnostics = Diagnostics(node)
        self._clock = node.create_publisher(Clock, names.CLOCK, live_qos(100)) if with_clock else None

    def clock(self, seconds: float) -> None:
        """Publish simulated time, where this node is its source."""
        if self._clock is not None:
            self._clock.publish(Clock(clock=to_stamp(seconds)))

    def truth(self, message: str, values: Mapping[str, str]) -> None:
        """Publish what the simulator knows and a monitor has to find out."""
        self._truth.publish(self._diagnostics.status("truth", OK, message, values))

    def diagnostics(self, seconds: float, level: bytes, message: str, values: Mapping[str, str]) -> None:
        """Publish how the integration goes."""
        self._diagnostics.publish([self._diagnostics.status("integration", level, message, values)], seconds)
