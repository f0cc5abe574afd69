"""Turns what the monitor found into the messages of the contract."""

from __future__ import annotations

from rclpy.node import Node
from std_msgs.msg import Float64MultiArray

from nw_gear_common import names
from nw_gear_common.diagnostics import ERROR, OK, STALE, WARN, Diagnostics
from nw_gear_common.ros import live_qos, to_message
from nw_gear_monitor.health import Status
from nw_gear_monitor.machine import Machine
from nw_gear_monitor.pipeline import Hop

DEPTH = 20
LEVELS = (OK, WARN, ERROR, STALE)


class Publishing:
    """The publishers of the monitor.

    Args:
        node: that publishes.
        machine: whose stages and channels have topics.
    """

    def __init__(self, node: Node, machine: Machine) -> None:
        topics = [names.SPECTRUM, names.ORDERS]
        topics += [names.section_topic(stage) for stage in machine.stage_names]
        topics += [names.indicators_topic(mesh) for mesh in machine.channel_names]
        topics += [names.indicators_topic(bearing.name) for bearing in machine.bearings]
        self._tables = {topic: node.create_publisher(Float64MultiArray, topic, live_qos(DEPTH)) for topic in topics}
        self._diagnostics = Diagnostics(node)

    def tables(self, hop: Hop) -> None:
        """Publish the tables of one second."""
        tables = {names.SPECTRUM: hop.spectrum, names.ORDERS: hop.orders}
        tables |= {names.section_topic(stage): table for stage, table in hop.sections.items() if len(table)}
        tables |= {names.indicators_topic(mesh): table for mesh, table in hop.indicators.items()}
        tables |= {names.indicators_topic(bearing): table for bearing, table in hop.bearing_indicators.items()}
        for topic, table in tables.items():
            if table is not None:
                self._tables[topic].publish(to_message(table))

    def diagnostics(self, statuses: list[Status], stamp: float) -> None:
        """Publish statuses; `stamp` in seconds of ROS time."""
        self._diagnostics.publish(
            [self._diagnostics.status(s.name, LEVELS[s.level], s.message, s.pairs) for s in statuses], stamp
        )
