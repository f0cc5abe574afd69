"""Subscriptions of the dashboard: messages in, tables and numbers to the feed."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import Vector3Stamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.ros import from_message, latched_qos, live_qos, to_seconds
from nw_gear_common.tables import Table
from nw_gear_monitor.dashboard.feed import Feed

WAVEFORM_DEPTH = 200
RING = "ring"


class Ears:
    """Listens for everything that the page shows.

    Args:
        node: that subscribes.
        feed: takes what comes.
        waveform: topic of the waveform.
    """

    def __init__(self, node: Node, feed: Feed, waveform: str) -> None:
        self._feed, self._namespace, self._own = feed, node.get_namespace(), node.get_name()
        self._subscribe_table(node, waveform, lambda table: feed.add_waveform(table, time.monotonic()), WAVEFORM_DEPTH)
        for topic in (names.SPECTRUM, names.ORDERS):
            self._subscribe_table(node, topic, self._spectra(topic))
        for stage in names.STAGES:
            self._subscribe_table(node, names.section_topic(stage), self._section(stage))
        for place in (*names.MESHES, *names.BEARINGS):
            self._subscribe_table(node, names.indicators_topic(place), self._indicators(place))
        wind = QoSProfile(depth=50, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE)
        node.create_subscription(Vector3Stamped, names.WIND_SPEED, self._on_wind, wind)
        node.create_subscription(JointState, names.SHAFTS_TOPIC, self._on_shafts, live_qos(100))
        node.create_subscription(DiagnosticStatus, names.TRUTH, self._on_truth, latched_qos())
        node.create_subscription(DiagnosticArray, names.DIAGNOSTICS, self._on_diagnostics, live_qos(50))

    def _subscribe_table(self, node: Node, topic: str, take: Callable[[Table], None], depth: int = 20) -> None:
        def heard(message: Float64MultiArray) -> None:
            try:
                take(from_message(message, topic))
                if self._feed.refused.startswith(f"{topic}:"):
                    self._feed.refused = ""
            except InputError as error:
                self._feed.refused = f"{topic}: {error}"

        node.create_subscription(Float64MultiArray, topic, heard, live_qos(depth))

    def _spectra(self, topic: str) -> Callable[[Table], None]:
        return lambda table: self._feed.add_spectra(topic, table)

    def _section(self, stage: str) -> Callable[[Table], None]:
        return lambda table: self._feed.add_section(stage, table)

    def _indicators(self, place: str) -> Callable[[Table], None]:
        return lambda table: self._feed.add_indicators(place, table)

    def _on_wind(self, message: Vector3Stamped) -> None:
        self._feed.add_wind(to_seconds(message.header.stamp), message.vector.x)

    def _on_shafts(self, message: JointState) -> None:
        if RING in message.name:
            k = list(message.name).index(RING)
            if k < min(len(message.velocity), len(message.effort)):
                self._feed.add_operation(to_seconds(message.header.stamp), message.velocity[k], message.effort[k])

    def _on_truth(self, message: DiagnosticStatus) -> None:
        self._feed.add_truth(message.message, _values(message), time.monotonic())

    def _on_diagnostics(self, array: DiagnosticArray) -> None:
        now = time.monotonic()
        for status in array.status:
            if status.hardware_id == self._namespace and not status.name.startswith(f"{self._own}: "):
                level = status.level[0] if isinstance(status.level, bytes) else int(status.level)
                self._feed.add_status(status.name, level, status.message, _values(status), now)


def _values(status: Any) -> dict[str, str]:
    return {pair.key: pair.value for pair in status.values}
