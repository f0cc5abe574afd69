"""Gives every message its log time and writes it; counts what is missing. Knows no ROS, only what came from it."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

from nw_gear_monitor.records.metadata import TopicEntry
from nw_gear_monitor.records.writer import RecordingWriter

MOST_HELD = 64 * 1024 * 1024
"""Bytes of messages that may wait for the first `/clock`; what comes beyond is recorded at time 0."""

_CLOCK = struct.Struct("<4xiI")
"""A serialised rosgraph_msgs/Clock: encapsulation, seconds, nanoseconds."""

_NANO = 1_000_000_000


class Incoming(NamedTuple):
    """One message: topic, times when it arrived and when it was sent (ns), running number (0 unknown), CDR bytes."""

    topic: str
    received: int
    sent: int
    sequence: int
    data: bytes


@dataclass
class Recorded:
    """One topic that is recorded: its number in the file, and what is missing of it.

    Attributes:
        number: of the topic in the recording.
        publishers: how many there are.
        last: running number of the last message.
        lost: messages that never arrived, told by the gaps in the running numbers of a single publisher.
        left_out: messages that came during a pause.
        other_type: messages that came while its publishers had another type than the recorded one.
        foreign: whether they have now.
    """

    number: int
    publishers: int
    last: int = 0
    lost: int = 0
    left_out: int = 0
    other_type: int = 0
    foreign: bool = False

    def follow(self, sequence: int) -> None:
        """Count the messages that are missing before this one; only a single publisher's numbers can be followed."""
        if self.publishers == 1 and 0 < self.last < sequence:
            self.lost += sequence - self.last - 1
        self.last = sequence if self.publishers == 1 else 0


class Intake:
    """Writes messages to a recording.

    The log time of a message is when it arrived. In simulated time it is the last clock that arrived before it, and
    messages that come before the first clock wait for it.

    Args:
        writer: the recording.
        clock: topic of the clock in simulated time; None where wall time counts.
    """

    def __init__(self, writer: RecordingWriter, clock: str | None) -> None:
        self.paused = False
        self._writer = writer
        self._clock_topic = clock
        self._clock: int | None = None
        self._topics: dict[str, Recorded] = {}
        self._held: list[Incoming] = []
        self._held_bytes = 0

    @property
    def topics(self) -> frozenset[str]:
        """Topics that are recorded."""
        return frozenset(self._topics)

    @property
    def lost(self) -> dict[str, int]:
        """Messages known to be missing, of the topics that miss any."""
        return {topic: recorded.lost for topic, recorded in self._topics.items() if recorded.lost}

    @property
    def left_out(self) -> int:
        """Messages of all topics that came during a pause."""
        return sum(recorded.left_out for recorded in self._topics.values())

    def missing(self) -> dict[str, str]:
        """Everything that is known to be missing, topic by topic: numbers of messages by reason, as JSON."""
        found = {}
        for topic, recorded in self._topics.items():
            counts = {"lost": recorded.lost, "paused": recorded.left_out, "other_type": recorded.other_type}
            if any(counts.values()):
                found[topic] = json.dumps(counts)
        return found

    def begin(self, topic: TopicEntry, definition: str, publishers: int) -> None:
        """Record a topic from now on."""
        self._topics[topic.name] = Recorded(self._writer.add_topic(topic, definition), publishers)

    def publishers_changed(self, topic: str, publishers: int) -> None:
        """Take note of how many publishers a topic has."""
        if topic in self._topics:
            self._topics[topic].publishers, self._topics[topic].last = publishers, 0

    def type_changed(self, topic: str, foreign: bool) -> None:
        """Take note of whether a topic's publishers have another type than the recorded one."""
        if topic in self._topics:
            self._topics[topic].foreign = foreign

    def take(self, messages: Iterable[Incoming]) -> None:
        """Write messages, which come in the order in which they arrived."""
        for message in messages:
            if message.topic == self._clock_topic:
                seconds, nanoseconds = _CLOCK.unpack_from(message.data)
                self._clock = seconds * _NANO + nanoseconds
                self.release()
            recorded = self._topics.get(message.topic)
            if recorded is None:
                continue
            recorded.follow(message.sequence)
            if recorded.foreign:
                recorded.other_type += 1
            elif self.paused:
                recorded.left_out += 1
            elif self._clock_topic and self._clock is None and self._held_bytes < MOST_HELD:
                self._held.append(message)
                self._held_bytes += len(message.data)
            else:
                self._write(recorded, message)

    def release(self) -> None:
        """Write the messages that wait for a `/clock`; without one at time 0."""
        held, self._held, self._held_bytes = self._held, [], 0
        for message in held:
            self._write(self._topics[message.topic], message)

    def _write(self, recorded: Recorded, message: Incoming) -> None:
        log_time = (self._clock or 0) if self._clock_topic else message.received
        self._writer.write(recorded.number, message.data, log_time, message.sent, message.sequence)
