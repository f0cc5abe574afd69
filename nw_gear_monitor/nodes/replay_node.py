"""`replay_node`: publishes a recording again, byte for byte and in its order, with a `/clock` of its own.

`/clock` is the log time of the recording: what was simulated time then is simulated time again, what was wall time
comes as the time of that day. It runs ahead of no message: before a message is published the clock has reached it.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool

from nw_gear_common import names
from nw_gear_common.errors import InputError, NwGearError
from nw_gear_common.plain import one_line
from nw_gear_common.quantities import quantity
from nw_gear_common.ros import Stop, declare_parameters, live_qos, make_node, run
from nw_gear_monitor.nodes.ears import message_class
from nw_gear_monitor.nodes.timeline import Timeline
from nw_gear_monitor.records.playable import checked, obstacle
from nw_gear_monitor.records.qos import Qos
from nw_gear_monitor.records.reader import RawMessage, Recording
from nw_gear_monitor.records.selection import Selection

CLOCK_TYPE = "rosgraph_msgs/msg/Clock"
CLOCK_EVERY = 0.02
"""Longest time between two `/clock` messages, in wall time and in recorded time (s)."""

BACKWARD_NS = 50_000_000
"""Step back of the log time that means a new epoch; below, it is only the order in which topics were written."""

DEPTH = 1000
LATCHED_DEPTH = 20
"""History of publishers whose depth isn't in the recording: over the network a middleware doesn't tell it."""

LONG_SILENCE = 30.0
"""Seconds without a message, as it is replayed, that are announced: nobody shall take them for a standstill."""

ACKNOWLEDGE_WITHIN = 3.0
JOIN_WITHIN = 4.0


@dataclass(frozen=True)
class Settings:
    """Parameters of `replay_node`."""

    uri: str = quantity("", "Recording, required: a rosbag2 folder or an MCAP file.")
    rate: float = quantity(1.0, "Recorded seconds per second.", minimum=1e-3, maximum=1e3, live=True)
    loop: bool = quantity(False, "Begin again at the end; the clock jumps back.", live=True)
    start_offset: float = quantity(0.0, "Seconds after the beginning of the recording to start at.", "s", minimum=0.0)
    topics: tuple[str, ...] = quantity((), "Names or regular expressions; empty = all. `/clock` is always made anew.")
    wait_for: int = quantity(
        0, "Subscribers of the waveform (without one, of any topic) to wait for before the start.", minimum=0
    )


class ReplayNode(Node):
    """The replay as a ROS node: the executor's thread answers services, a second one publishes.

    Raises:
        InputError: a parameter or the recording can't be used.
    """

    def __init__(self, name: str, stop: Stop, **kwargs: Any) -> None:
        super().__init__(name, **kwargs)
        self._stop = stop
        self._settings = declare_parameters(self, Settings, self._change)
        if not self._settings.uri:
            raise InputError("parameter uri", "a recording", "none")
        selected = Selection(self._settings.topics, self.get_namespace())
        self._recording = Recording.open(self._settings.uri)
        everything = checked(self._recording.raw(), str(self._recording.path))
        beginning = next((message.log_time for message in everything), 0)
        self._first = beginning + round(1e9 * self._settings.start_offset)
        if self._settings.start_offset > self._recording.duration:
            expected = f"less than the recording's {self._recording.duration:.3f} s"
            raise InputError("parameter start_offset", expected, f"{self._settings.start_offset:g}")
        self._timeline = Timeline(self._settings.rate)
        kept = [name for name, topic in self._recording.topics.items() if topic.type != CLOCK_TYPE]
        chosen = [name for name in kept if not self._settings.topics or selected(name)]
        self._outlets = self._advertise(chosen)
        if not self._outlets:
            got = "none of them" if not chosen else "only such that can't be replayed here"
            raise InputError("parameter topics", "one of " + ", ".join(self._recording.topics), got)
        self._clock_publisher = self.create_publisher(Clock, names.CLOCK, live_qos(100))
        self._next_clock = 0.0
        self._shown = 0
        self.create_service(SetBool, "~/pause", self._on_pause)
        self._thread = threading.Thread(target=self._work, name="replay", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the second thread and close the recording."""
        self._stop.event.set()
        self._timeline.wake()
        self._thread.join(JOIN_WITHIN)
        self._recording.close()

    # --- the executor's thread ----------------------------------------------------------------------------------------

    def _advertise(self, topics: Sequence[str]) -> dict[str, Publisher]:
        publishers = {}
        for topic in topics:
            reason = obstacle(self._recording, topic)
            if not reason:
                try:
                    kind = message_class(self._recording.topics[topic].type)
                    publishers[topic] = self.create_publisher(kind, topic, profile(self._recording.qos(topic)))
                except Exception as error:  # several unrelated types: names of topics, types without support
                    reason = (str(error) or type(error).__name__).splitlines()[0]
            if reason:
                self.get_logger().warning(one_line(f"{topic} isn't replayed: {reason}"))
        return publishers

    def _change(self, settings: Settings) -> None:
        self._settings = settings
        self._timeline.set_rate(settings.rate)

    def _on_pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self._timeline.pause(bool(request.data))
        response.success, response.message = True, "paused" if request.data else "replaying"
        return response

    # --- the thread that publishes ------------------------------------------------------------------------------------

    def _work(self) -> None:
        try:
            self._wait_for_subscribers()
            self.get_logger().info(f"replaying {self._settings.uri}")
            while not self._stop:
                self._replay()
                if not self._settings.loop:
                    break
            self._let_go()
            self._stop()
        except NwGearError as error:
            self._stop(error)
        except Exception as error:  # a thread that dies in silence would leave a node that does nothing
            self._stop(NwGearError(f"{type(error).__name__}: {error}"))
            raise

    def _wait_for_subscribers(self) -> None:
        waveforms = [p for topic, p in self._outlets.items() if topic.endswith(f"/{names.WAVEFORM}")]
        watched = waveforms[:1] or list(self._outlets.values())
        while not self._stop and max(p.get_subscription_count() for p in watched) < self._settings.wait_for:
            time.sleep(CLOCK_EVERY)

    def _replay(self) -> None:
        """Publish the recording once."""
        last = self._first
        self._timeline.begin(last)
        self._show_clock(last)
        for message in self._messages():
            if message.log_time < self._shown - BACKWARD_NS:  # the recorded clock went back: a new epoch
                self._timeline.begin(message.log_time)
                self._show_clock(message.log_time)
            self._tell_of_silence(message.log_time)
            self._wait_until(message.log_time)
            if self._stop:
                return
            if message.log_time - self._shown >= CLOCK_EVERY * 1e9:
                self._show_clock(message.log_time)
            self._outlets[message.topic].publish(message.data)
            last = message.log_time
        self._show_clock(max(last, self._shown))

    def _messages(self) -> Iterator[RawMessage]:
        since = self._first if self._settings.start_offset else 0
        return checked(self._recording.raw(self._outlets.keys(), since), str(self._recording.path))

    def _tell_of_silence(self, moment: int) -> None:
        silence = self._timeline.until(moment)
        if LONG_SILENCE < silence < float("inf"):
            self.get_logger().info(f"the next message comes in {silence:.0f} s")

    def _wait_until(self, moment: int) -> None:
        """Wait until the timeline has come to a moment (ns), showing the clock meanwhile."""
        while not self._stop:
            now = self._timeline.now()
            if time.monotonic() >= self._next_clock:
                self._show_clock(max(self._shown, min(now, moment)))
            if now >= moment:
                return
            self._timeline.sleep(min(self._timeline.until(moment), CLOCK_EVERY))

    def _show_clock(self, moment: int) -> None:
        self._shown = moment
        self._next_clock = time.monotonic() + CLOCK_EVERY
        seconds, nanoseconds = divmod(moment, 1_000_000_000)
        self._clock_publisher.publish(Clock(clock=Time(sec=seconds, nanosec=nanoseconds)))

    def _let_go(self) -> None:
        """Wait until every subscriber has what was published."""
        end = time.monotonic() + ACKNOWLEDGE_WITHIN
        for publisher in self._outlets.values():
            left = end - time.monotonic()
            if not self._stop and left > 0.0:
                publisher.wait_for_all_acked(Duration(seconds=left))


def profile(offers: Sequence[Qos]) -> QoSProfile:
    """The quality of service of a publisher that serves whoever was served by any of the recorded publishers."""
    best_effort = bool(offers) and all(offer.reliability == "best_effort" for offer in offers)
    latched = any(offer.durability == "transient_local" for offer in offers)
    depth = max((offer.depth for offer in offers), default=0) or (LATCHED_DEPTH if latched else DEPTH)
    return QoSProfile(
        depth=depth,
        history=HistoryPolicy.KEEP_LAST,
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def main(argv: Sequence[str]) -> int:
    """Replay until the end or until asked to stop; returns the exit code."""
    return run("replay_node", lambda stop: make_node(ReplayNode, "replay_node", stop=stop), argv)
