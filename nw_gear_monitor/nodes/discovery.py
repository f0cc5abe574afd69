"""Finds topics in the ROS graph and has them recorded, each with the quality of service its publishers offer."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_monitor.nodes.ears import Ears, message_class, offered, wanted
from nw_gear_monitor.nodes.intake import Intake
from nw_gear_monitor.records.definitions import define
from nw_gear_monitor.records.metadata import TopicEntry
from nw_gear_monitor.records.selection import Selection

CLOCK_TYPE = "rosgraph_msgs/msg/Clock"
CHECK_EVERY = 1.0
"""Seconds between two looks at the publishers of a topic whose number hasn't changed: one may have replaced another."""

Publishers = frozenset[tuple[bytes, str]]


@dataclass(frozen=True)
class _Subscribed:
    """What a topic is subscribed to with."""

    type: str
    reliability: ReliabilityPolicy
    durability: DurabilityPolicy


class Discovery:
    """Subscribes to what is wanted as soon as somebody publishes it, and anew when its publishers change.

    A recording has one type for each topic. Where all publishers come to have another one, their messages are counted
    and left out until the first type comes back: readers of recordings expect that, and so do those who play them.

    Args:
        node: through which the graph is seen.
        ears: subscriptions.
        intake: records.
        selected: which topics are wanted.
        clock: topic that is subscribed to in any case; none where time isn't simulated.
        take: has everything recorded that has arrived, before a subscription is given up.
    """

    def __init__(
        self, node: Node, ears: Ears, intake: Intake, selected: Selection, clock: str | None, take: Callable[[], None]
    ) -> None:
        self.skipped: dict[str, str] = {}
        self._node = node
        self._ears = ears
        self._intake = intake
        self._selected = selected
        self._clock = clock
        self._take = take
        self._counts: dict[str, int] = {}
        self._publishers: dict[str, Publishers] = {}
        self._types: dict[str, str] = {clock: CLOCK_TYPE} if clock else {}
        self._subscribed: dict[str, _Subscribed] = {}
        self._next_check = 0.0

    def look(self) -> None:
        """Look at the graph once."""
        present = [topic for topic, _types in self._node.get_topic_names_and_types()]
        check = time.monotonic() >= self._next_check
        if check:
            self._next_check = time.monotonic() + CHECK_EVERY
        # Whoever waits for a subscriber of the waveform finds all other topics subscribed by then.
        for topic in sorted(present, key=lambda name: (name.endswith(f"/{names.WAVEFORM}"), name)):
            if not (self._selected(topic) or topic == self._clock):
                continue
            count = self._node.count_publishers(topic)
            if count and (check or count != self._counts.get(topic)):
                self._follow(topic)
            self._counts[topic] = count

    def _follow(self, topic: str) -> None:
        """Subscribe to a topic that is new, or adapt to publishers that have come or gone."""
        publishers = self._node.get_publishers_info_by_topic(topic)
        known = frozenset((bytes(p.endpoint_gid), p.topic_type) for p in publishers)
        if not publishers or known == self._publishers.get(topic):
            return
        self._publishers[topic] = known
        self.skipped.pop(topic, None)
        kind = self._types.get(topic, publishers[0].topic_type)
        fitting = [p for p in publishers if p.topic_type == kind]
        others = sorted({p.topic_type for p in publishers} - {kind})
        if topic == self._clock and not fitting:
            self._skip(topic, others[0], f"isn't followed: expected {CLOCK_TYPE}, got {', '.join(others)}")
            return
        try:
            self._listen(topic, fitting or [p for p in publishers if p.topic_type == others[0]])
        except InputError as error:
            self._skip(topic, error.place, f"isn't recorded: {error}")
            return
        self._intake.publishers_changed(topic, len(fitting or publishers))
        if not fitting:
            reason = f"its type was {kind}, now it is {others[0]}"
            self._skip(topic, reason, f"isn't recorded any more: {reason}")
        elif others:
            self._skip(topic, ", ".join(others), f"has several types; {', '.join(others)} isn't recorded")

    def _skip(self, topic: str, reason: str, words: str) -> None:
        self.skipped[topic] = reason
        self._node.get_logger().warning(f"{topic} {words}")

    def _listen(self, topic: str, publishers: list[TopicEndpointInfo]) -> None:
        """Subscribe to publishers of one type, unless that is done already.

        Raises:
            InputError: their type isn't known here.
        """
        kind = publishers[0].topic_type
        qos = wanted(publishers)
        subscribed = _Subscribed(kind, qos.reliability, qos.durability)
        before = self._subscribed.get(topic)
        if subscribed == before:
            return
        found = message_class(kind)
        if before is None and self._selected(topic):
            definition = define(kind, found.get_fields_and_field_types())
            type_hash = definition.type_hash or str(publishers[0].topic_type_hash)
            self._ears.listen(topic, found, qos)
            entry = TopicEntry(topic, kind, type_hash, offered(publishers))
            self._intake.begin(entry, definition.text, len(publishers))
        else:
            self._take()
            self._ears.listen(topic, found, qos)
        self._types.setdefault(topic, kind)
        self._subscribed[topic] = subscribed
        self._intake.type_changed(topic, kind != self._types[topic])
        if before is not None and before.type == kind:
            self._node.get_logger().warning(f"{topic}: a publisher offers another quality of service; adapting")
        elif before is not None and kind == self._types[topic]:
            self._node.get_logger().warning(f"{topic} is recorded again: its type is {kind} again")
