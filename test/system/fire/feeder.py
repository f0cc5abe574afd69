"""Publishes numbered and stamped tables on any number of topics at any rate: `python -m test.system.fire.feeder ...`.

The first number of a table is the time at which it was sent (s, monotonic: the same for all processes of a machine),
the second its running number. Prints "feeding" when it begins and one JSON object at the end.
"""

from __future__ import annotations

import argparse
import json
import signal
import struct
import time

import numpy as np
import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Float64MultiArray

from nw_gear_common.ros import live_qos
from nw_gear_common.tables import Table
from nw_gear_monitor.records.cdr import from_table

NAMESPACE = "/nw_gear"
LISTENERS_WITHIN = 60.0
ACKNOWLEDGE_WITHIN = 10.0


def topic(number: int) -> str:
    """Absolute name of one of the topics; sorted, the first is heard of first."""
    return f"{NAMESPACE}/fed_{number:03d}"


class Feeder:
    """Publishers of some topics, and the message that all of them send."""

    def __init__(self, node: Node, topics: int, size: int, depth: int) -> None:
        self.sent = 0
        self._publishers = [node.create_publisher(Float64MultiArray, topic(i), live_qos(depth)) for i in range(topics)]
        numbers = max(2, size // 8)
        values = np.random.default_rng(1).normal(size=(numbers, 1))
        self._message = bytearray(from_table(Table("row", ("value",), values)))
        self._place = len(self._message) - 8 * numbers

    def heard(self) -> bool:
        """Whether somebody listens to every topic."""
        return all(publisher.get_subscription_count() for publisher in self._publishers)

    def send(self) -> None:
        """One message on every topic."""
        self.sent += 1
        struct.pack_into("<dd", self._message, self._place, time.monotonic(), self.sent)
        data = bytes(self._message)
        for publisher in self._publishers:
            publisher.publish(data)

    def wait(self) -> bool:
        """Wait until everything was acknowledged; whether it was."""
        return all(_acknowledged(publisher) for publisher in self._publishers)


def _acknowledged(publisher: Publisher) -> bool:
    return bool(publisher.wait_for_all_acked(Duration(seconds=ACKNOWLEDGE_WITHIN)))


def feed(feeder: Feeder, rate: float, seconds: float) -> dict[str, float]:
    """Send at a rate (1/s) for some seconds, 0 = until asked to end."""
    ended = [False]
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: ended.__setitem__(0, True))
    patience = time.monotonic() + LISTENERS_WITHIN
    while seconds and not feeder.heard() and time.monotonic() < patience and not ended[0]:
        time.sleep(0.02)
    print("feeding", flush=True)
    began = time.monotonic()
    while not ended[0] and not (seconds and time.monotonic() > began + seconds):
        feeder.send()
        time.sleep(max(0.0, began + feeder.sent / rate - time.monotonic()))
    took = time.monotonic() - began
    return {"sent": feeder.sent, "seconds": took, "acknowledged": not seconds or feeder.wait()}


def main() -> None:
    """Feed until the end."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--topics", type=int, default=1)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--rate", type=float, default=100.0)
    parser.add_argument("--seconds", type=float, default=0.0)
    parser.add_argument("--depth", type=int, default=1000)
    given = parser.parse_args()
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("feeder", namespace=NAMESPACE)
    try:
        print(json.dumps(feed(Feeder(node, given.topics, given.size, given.depth), given.rate, given.seconds)))
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
