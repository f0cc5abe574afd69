"""Finds topics in the ROS graph and has them recorded, each with the quality of service its publishers offer."""

from __future__ import annotations

from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.topic_endpoint_info import TopicEndpointInfo

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_monitor.nodes.ears import Ears, message_class, offered, wanted
from nw_gear_monitor.nodes.intake import Intake
from nw_gear_monitor.records.definitions import define
from nw_gear_monitor.records.metadata import TopicEntry
from nw_gear_monitor.records.selection import Selection


class Discovery:
    """Subscribes to what is wanted as soon as somebody publishes it.

    Args:
        node: through which the graph is seen.
        ears: subscriptions.
        intake: records.
        selected: which topics are wanted.
        clock: topic that is subscribed to in any case; none where time isn't simulated.
    """

    def __init__(self, node: Node, ears: Ears, intake: Intake, selected: Selection, clock: str | None) -> None:
        self.skipped: dict[str, str] = {}
        self._node = node
        self._ears = ears
        self._intake = intake
        self._selected = selected
        self._clock = clock
        self._publishers: dict[str, int] = {}
        self._requested: dict[str, tuple[type, QoSProfile]] = {}

    def look(self) -> None:
        """Look at the graph once."""
        present = [topic for topic, _types in self._node.get_topic_names_and_types()]
        # Whoever waits for a subscriber of the waveform finds all other topics subscribed by then.
        for topic in sorted(present, key=lambda name: (name.endswith(f"/{names.WAVEFORM}"), name)):
            if topic in self.skipped or not (self._selected(topic) or topic == self._clock):
                continue
            count = self._node.count_publishers(topic)
            if count and count != self._publishers.get(topic):
                self._follow(topic)

    def _follow(self, topic: str) -> None:
        """Subscribe to a topic that is new, or adapt to publishers that have come or gone."""
        publishers = self._node.get_publishers_info_by_topic(topic)
        if not publishers:
            return
        try:
            self._listen(topic, publishers)
        except InputError as error:
            self.skipped[topic] = error.place
            self._node.get_logger().warning(f"{topic} isn't recorded: {error}")
            return
        self._publishers[topic] = len(publishers)
        self._intake.publishers_changed(topic, len(publishers))

    def _listen(self, topic: str, publishers: list[TopicEndpointInfo]) -> None:
        qos = wanted(publishers)
        if topic not in self._requested:
            first = publishers[0]
            kind = message_class(first.topic_type)
            if self._selected(topic):
                definition = define(first.topic_type, kind.get_fields_and_field_types())
                type_hash = definition.type_hash or str(first.topic_type_hash)
                entry = TopicEntry(topic, first.topic_type, type_hash, offered(publishers))
                self._ears.listen(topic, kind, qos)
                self._intake.begin(entry, definition.text, len(publishers))
            else:
                self._ears.listen(topic, kind, qos)
        else:
            kind, before = self._requested[topic]
            if (qos.reliability, qos.durability) == (before.reliability, before.durability):
                return
            self._node.get_logger().warning(f"{topic}: a publisher offers another quality of service; adapting")
            self._ears.listen(topic, kind, qos)
        self._requested[topic] = (kind, qos)
        others = {p.topic_type for p in publishers} - {publishers[0].topic_type}
        if others:
            self._node.get_logger().warning(f"{topic} has several types; {', '.join(sorted(others))} isn't recorded")
