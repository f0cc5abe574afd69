"""Takes serialised messages of any topic from the middleware, in the order in which they arrived.

The events executor of the wheels can't call a callback that wants a message's stamps and running number, and calling
one per message costs more than the message. So the subscriptions belong to a node that no executor spins, and
whoever owns them takes everything that has arrived, a few times per second: the middleware has stamped it.
"""

from __future__ import annotations

import importlib
import importlib.util
import re
import time
from bisect import bisect_left
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription
from rclpy.topic_endpoint_info import TopicEndpointInfo

from nw_gear_common.errors import InputError
from nw_gear_monitor.nodes.intake import Incoming
from nw_gear_monitor.records.qos import Qos

_TYPE = re.compile(r"(?P<package>[a-z][a-z0-9_]*)/(?P<kind>msg|srv|action)/(?P<name>[A-Z][A-Za-z0-9_]*)")

DEPTH = 500
"""Messages of one topic that may wait in the middleware: 25 s of waveform."""


class Ears:
    """Subscriptions of a node of their own; its name begins with an underscore, so that tools hide it."""

    def __init__(self, owner: Node) -> None:
        self._node = rclpy.create_node(
            f"_{owner.get_name()}",
            namespace=owner.get_namespace(),
            use_global_arguments=False,
            start_parameter_services=False,
            enable_rosout=False,
        )
        self._subscriptions: dict[str, Subscription] = {}
        self._kept: list[Incoming] = []
        self._began = 0

    def listen(self, topic: str, kind: type, qos: QoSProfile) -> None:
        """Subscribe; a subscription of the same topic is replaced.

        Raises:
            InputError: the middleware can't subscribe to this type.
        """
        if topic in self._subscriptions:
            self._node.destroy_subscription(self._subscriptions.pop(topic))
        try:
            self._subscriptions[topic] = self._node.create_subscription(kind, topic, _never, qos, raw=True)
        except Exception as error:  # no type support for this middleware: several unrelated types
            raise InputError(f"type {kind.__name__}", "a type that can be subscribed to", str(error)) from None

    def take(self, everything: bool = False) -> list[Incoming]:
        """What has arrived since the last call, the earliest first.

        What arrives during the call is kept back until the next one, so that the order holds over calls as well,
        unless `everything` is wanted. Where the machine's clock was set back since the last call, nothing is kept back,
        and what seems to come from the future comes first: it arrived before.
        """
        began = time.time_ns()
        set_back, self._began = began < self._began, began
        found, self._kept = self._kept, []
        for topic, subscription in self._subscriptions.items():
            with subscription.handle:
                for _at_most in range(DEPTH):
                    taken = subscription.handle.take_message(subscription.msg_type, True)
                    if taken is None:
                        break
                    data, info = taken
                    sequence = info["publication_sequence_number"] or 0
                    found.append(Incoming(topic, info["received_timestamp"], info["source_timestamp"], sequence, data))
        found.sort(key=lambda message: (set_back and message.received <= began, message.received))
        if not (everything or set_back):
            split = bisect_left(found, began, key=lambda message: message.received)
            found, self._kept = found[:split], found[split:]
        return found

    def close(self) -> None:
        """Destroy the node."""
        self._node.destroy_node()


def _never(_data: bytes) -> None:
    raise AssertionError("the node of these subscriptions isn't spun")


def message_class(kind: str) -> Any:
    """The Python class of a type such as `std_msgs/msg/String`.

    Raises:
        InputError: the package or the type isn't installed here.
    """
    match = _TYPE.fullmatch(kind)
    if match is None:
        raise InputError(f"type {kind}", "a message type (package/msg/Name)", "another form")
    try:
        if not _is_interfaces(match["package"]):
            raise ImportError
        found = getattr(importlib.import_module(f"{match['package']}.{match['kind']}"), match["name"])
        found.get_fields_and_field_types()
    except (ImportError, AttributeError, ValueError):
        raise InputError(f"type {kind}", "a message type that is installed here", "an unknown one") from None
    return found


def _is_interfaces(package: str) -> bool:
    """Whether a package of that name has messages; it isn't imported for that, whoever named it."""
    spec = importlib.util.find_spec(package)
    places = (spec.submodule_search_locations if spec else None) or ()
    return any(Path(place, "msg", "__init__.py").is_file() for place in places)


def offered(publishers: Sequence[TopicEndpointInfo]) -> tuple[Qos, ...]:
    """What the publishers of a topic offer, in the words of a recording."""
    profiles = (publisher.qos_profile for publisher in publishers)
    return tuple(
        Qos(p.reliability.name.lower(), p.durability.name.lower(), p.history.name.lower(), p.depth) for p in profiles
    )


def wanted(publishers: Sequence[TopicEndpointInfo]) -> QoSProfile:
    """The strongest quality of service that every publisher of a topic can serve."""
    offers = [publisher.qos_profile for publisher in publishers]
    reliable = all(offer.reliability == ReliabilityPolicy.RELIABLE for offer in offers)
    latched = all(offer.durability == DurabilityPolicy.TRANSIENT_LOCAL for offer in offers)
    return QoSProfile(
        depth=DEPTH,
        history=HistoryPolicy.KEEP_LAST,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )
