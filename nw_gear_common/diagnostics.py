"""`/diagnostics` as every node publishes them: named after the node and its task, with the namespace as hardware."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from nw_gear_common.names import DIAGNOSTICS
from nw_gear_common.ros import live_qos, to_stamp

DEPTH = 20
OK, WARN, ERROR, STALE = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR, DiagnosticStatus.STALE


class Diagnostics:
    """What one node says about itself and what it watches."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._publisher = node.create_publisher(DiagnosticArray, DIAGNOSTICS, live_qos(DEPTH))

    def status(self, task: str, level: bytes, message: str, values: Mapping[str, str]) -> DiagnosticStatus:
        """Build a status.

        Args:
            task: what it is about; the name becomes `<node>: <task>`.
            level: OK, WARN, ERROR or STALE.
            message: one line for people.
            values: further facts, units in the keys.
        """
        return DiagnosticStatus(
            name=f"{self._node.get_name()}: {task}",
            level=level,
            message=message,
            hardware_id=self._node.get_namespace(),
            values=[KeyValue(key=key, value=value) for key, value in values.items()],
        )

    def publish(self, statuses: Sequence[DiagnosticStatus], stamp: float | None = None) -> None:
        """Publish statuses together; stamp in seconds of ROS time, None = now by the node's clock."""
        array = DiagnosticArray(status=list(statuses))
        array.header.stamp = self._node.get_clock().now().to_msg() if stamp is None else to_stamp(stamp)
        self._publisher.publish(array)
