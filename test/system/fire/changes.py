"""Topics that come late, change their type or their quality of service, and clocks that jump back."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Bool, String

from nw_gear_common import names
from nw_gear_common.ros import live_qos, to_stamp
from nw_gear_monitor.records.reader import Recording
from test.system.fire.checks import files, lines, losses, opened_everywhere, recording
from test.system.processes import Probe, Process

NOTE = "/nw_gear/note"
APART = 0.1
"""Seconds between two messages."""

BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class _Talker:
    """One publisher of a topic at a time, which waits for the recorder."""

    def __init__(self, probe: Probe, process: Process, topic: str = NOTE) -> None:
        self._probe, self._process, self._topic = probe, process, topic
        self._publisher: Any = None

    def become(self, kind: Any, qos: QoSProfile) -> None:
        """Replace the publisher."""
        if self._publisher is not None:
            self.finish()
            self._probe.node.destroy_publisher(self._publisher)
        self._publisher = self._probe.node.create_publisher(kind, self._topic, qos)
        self._probe.wait_until(lambda: self._publisher.get_subscription_count() > 0, self._process)

    def say(self, *messages: Any) -> None:
        """Publish, one after the other and apart from what others publish."""
        for message in messages:
            self._publisher.publish(message)
            end = time.monotonic() + APART
            while time.monotonic() < end:
                self._probe.spin_once(0.02)

    def finish(self) -> None:
        """Wait until the recorder has everything; of what is best effort it doesn't tell."""
        self._publisher.wait_for_all_acked()


def changing_topics(place: Path) -> dict[str, Any]:
    """A topic comes late, its publisher is replaced by weaker and stronger ones, by another type and back."""
    folder = place / "run"
    with Probe() as probe, recording(folder, "topics:=['note', 'late']") as process:
        talker = _Talker(probe, process)
        talker.become(String, live_qos(10))
        talker.say(String(data="first"))
        talker.become(String, BEST_EFFORT)
        talker.say(String(data="best effort"))
        talker.become(String, LATCHED)
        probe.wait_until(lambda: process.stderr.count("adapting") == 2, process, limit=30.0)
        talker.say(String(data="latched"))
        talker.become(Bool, live_qos(10))
        talker.say(Bool(data=True), Bool(data=False))
        talker.become(String, live_qos(10))
        talker.say(String(data="string again"))
        late = _Talker(probe, process, "/nw_gear/late")
        late.become(String, live_qos(10))
        late.say(String(data="late"))
        talker.finish()
        late.finish()
        process.interrupt()
        assert process.wait() == 0, process.report()
        said = [line for line in lines(process) if "any more" in line]
    opened_everywhere(folder, repair=False)
    with Recording.open(folder) as found:
        heard = [(entry.topic, entry.value.data) for entry in found.read()]
    words = ["first", "best effort", "latched", "string again"]
    assert heard == [(NOTE, word) for word in words] + [("/nw_gear/late", "late")], heard
    counted = losses(folder)[NOTE]
    assert counted == {"lost": 0, "paused": 0, "other_type": 2}, counted
    assert len(said) == 1, said
    assert "its type was std_msgs/msg/String, now it is std_msgs/msg/Bool" in said[0]
    return {"messages": len(heard), "other_type": counted["other_type"], "said": said[0].partition("]: ")[2]}


def clock_back(place: Path) -> dict[str, Any]:
    """Simulated time runs to 14 s, jumps back to 1 s, and runs again: a new epoch in the same recording, in order."""
    folder = place / "run"
    epochs = [*range(10, 15), *range(1, 6)]
    parameters = ("use_sim_time:=true", "topics:=['note']", "max_file_duration:=3.0")
    with Probe() as probe, recording(folder, *parameters) as process:
        clock, talker = _Talker(probe, process, names.CLOCK), _Talker(probe, process)
        clock.become(Clock, live_qos(10))
        talker.become(String, live_qos(10))
        for second in epochs:
            clock.say(Clock(clock=to_stamp(float(second))))
            talker.say(String(data=str(second)))
        talker.finish()
        process.interrupt()
        assert process.wait() == 0, process.report()
    opened_everywhere(folder, repair=False)
    with Recording.open(folder) as found:
        heard = [(entry.log_time, entry.value.data) for entry in found.read()]
    assert heard == [(float(second), str(second)) for second in epochs], heard
    assert len(files(folder)) == 3  # 10 to 12, then 13 to 3 with the jump inside, then 4 and 5
    assert losses(folder) == {}
    return {"messages": len(heard), "files": len(files(folder))}
