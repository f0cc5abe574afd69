"""Log times, pause, loss and the choice of topics, without ROS."""

import json
import time

import pytest
from builtin_interfaces.msg import Time
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

from nw_gear_common.errors import InputError
from nw_gear_monitor.nodes.ears import Ears
from nw_gear_monitor.nodes.intake import Incoming, Intake
from nw_gear_monitor.records.definitions import define
from nw_gear_monitor.records.metadata import TopicEntry
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.records.selection import Selection
from nw_gear_monitor.records.writer import RecordingWriter

STRING = "std_msgs/msg/String"
NANO = 1_000_000_000


class Recorder:
    """An intake with a recording behind it."""

    def __init__(self, folder, simulated=False):
        self.writer = RecordingWriter(folder)
        self.intake = Intake(self.writer, "/clock" if simulated else None)
        self._arrived = 1000

    def begin(self, topic, publishers=1):
        self.intake.begin(TopicEntry(topic, STRING), define(STRING).text, publishers)

    def word(self, topic, text, sequence=0):
        self._arrived += 1
        data = serialize_message(String(data=text))
        self.intake.take([Incoming(topic, self._arrived, self._arrived - 1, sequence, data)])

    def clock(self, seconds):
        self._arrived += 1
        stamp = Time(sec=int(seconds), nanosec=round((seconds % 1) * NANO))
        self.intake.take([Incoming("/clock", self._arrived, 0, 0, serialize_message(Clock(clock=stamp)))])

    def recorded(self):
        self.intake.release()
        self.writer.close()
        with Recording.open(self.writer.folder) as recording:
            return [(entry.value.data, round(entry.log_time * NANO)) for entry in recording.read()]


def test_in_wall_time_the_log_time_is_when_a_message_arrived(tmp_path):
    recorder = Recorder(tmp_path / "run")
    recorder.begin("/a")
    recorder.word("/a", "one")
    recorder.word("/unknown", "not recorded")
    recorder.word("/a", "two")
    assert recorder.recorded() == [("one", 1001), ("two", 1003)]


def test_in_simulated_time_it_is_the_last_clock_and_early_messages_wait_for_the_first(tmp_path):
    recorder = Recorder(tmp_path / "run", simulated=True)
    recorder.begin("/a")
    recorder.word("/a", "early")
    recorder.clock(5.25)
    recorder.word("/a", "then")
    recorder.clock(6.0)
    recorder.word("/a", "later")
    recorder.clock(1.0)
    recorder.word("/a", "again")
    assert recorder.recorded() == [
        ("early", 5_250_000_000),
        ("then", 5_250_000_000),
        ("later", 6 * NANO),
        ("again", NANO),
    ]


def test_without_any_clock_nothing_is_lost(tmp_path):
    recorder = Recorder(tmp_path / "run", simulated=True)
    recorder.begin("/a")
    recorder.word("/a", "early")
    assert recorder.recorded() == [("early", 0)]


def test_paused_messages_are_left_out_and_counted(tmp_path):
    recorder = Recorder(tmp_path / "run")
    recorder.begin("/a")
    recorder.word("/a", "one", 1)
    recorder.intake.paused = True
    recorder.word("/a", "two", 2)
    recorder.intake.paused = False
    recorder.word("/a", "three", 3)
    assert recorder.intake.left_out == 1
    assert recorder.intake.lost == {}
    assert [word for word, _time in recorder.recorded()] == ["one", "three"]


def test_missing_running_numbers_are_counted(tmp_path):
    recorder = Recorder(tmp_path / "run")
    recorder.begin("/a")
    recorder.begin("/b", publishers=2)
    for number in (7, 8, 11, 12):
        recorder.word("/a", "x", number)
        recorder.word("/b", "x", number)
    assert recorder.intake.lost == {"/a": 2}
    recorder.intake.publishers_changed("/a", 1)
    for number in (1, 2, 4):
        recorder.word("/a", "x", number)
    assert recorder.intake.lost == {"/a": 3}
    recorder.writer.close()


@pytest.mark.parametrize(
    ("entries", "wanted", "unwanted"),
    [
        ((), ["/nw_gear/waveform", "/nw_gear/section/I", "/diagnostics", "/clock"], ["/rosout", "/nw_gear2/x"]),
        (("waveform",), ["/nw_gear/waveform"], ["/nw_gear/waveform2", "/waveform", "/nw_gear/a/waveform"]),
        (("/chatter", "section/.*"), ["/chatter", "/nw_gear/section/II"], ["/section/II", "/diagnostics"]),
        ((".*",), ["/chatter", "/nw_gear/waveform", "/rosout"], []),
    ],
)
def test_topics_are_chosen_by_names_and_expressions(entries, wanted, unwanted):
    selected = Selection(entries, "/nw_gear")
    assert all(selected(topic) for topic in wanted)
    assert not any(selected(topic) for topic in unwanted)


def test_a_wrong_expression_is_named():
    with pytest.raises(InputError, match=r"topics\[1\].*'\('"):
        Selection(("a", "("), "/nw_gear")


def test_what_is_missing_is_counted_by_topic_and_by_reason(tmp_path):
    recorder = Recorder(tmp_path / "run")
    for topic in ("/a", "/b", "/c"):
        recorder.begin(topic)
    for number in (1, 2, 5):
        recorder.word("/a", "x", number)
    recorder.intake.paused = True
    recorder.word("/b", "x", 1)
    recorder.intake.paused = False
    recorder.intake.type_changed("/b", True)
    recorder.word("/b", "x", 2)
    recorder.word("/b", "x", 3)
    recorder.intake.type_changed("/b", False)
    recorder.word("/b", "again", 4)
    found = {topic: json.loads(counts) for topic, counts in recorder.intake.missing().items()}
    assert found == {
        "/a": {"lost": 2, "paused": 0, "other_type": 0},
        "/b": {"lost": 0, "paused": 1, "other_type": 2},
    }
    assert [word for word, _time in recorder.recorded()] == ["x", "x", "x", "again"]


class Queue:
    """What waits in the middleware for one subscription."""

    msg_type = None

    def __init__(self):
        self.handle = self
        self.waiting = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def take_message(self, _kind, _raw):
        if not self.waiting:
            return None
        received, data = self.waiting.pop(0)
        return data, {"publication_sequence_number": 1, "received_timestamp": received, "source_timestamp": 0}


@pytest.fixture
def ears(monkeypatch):
    """Ears without a node, a clock that is set by hand, and two queues."""
    found = Ears.__new__(Ears)
    found._kept, found._began = [], 0
    found._subscriptions = {"/a": Queue(), "/b": Queue()}
    clock = [0]
    monkeypatch.setattr(time, "time_ns", lambda: clock[0])

    def take(now, **arrived):
        for name, received in arrived.items():
            found._subscriptions[f"/{name}"].waiting += [(stamp, name) for stamp in received]
        clock[0] = now
        return [(message.topic, message.received) for message in found.take()]

    return take


def test_messages_of_several_topics_come_in_the_order_of_their_arrival(ears):
    assert ears(100, a=[50, 90, 120], b=[60, 130]) == [("/a", 50), ("/b", 60), ("/a", 90)]
    assert ears(200, b=[150]) == [("/a", 120), ("/b", 130), ("/b", 150)]


def test_a_clock_that_is_set_back_holds_nothing_up(ears):
    assert ears(1000, a=[990], b=[1010]) == [("/a", 990)]
    assert ears(500, a=[1020, 495]) == [("/b", 1010), ("/a", 1020), ("/a", 495)]
    assert ears(520, b=[510, 530]) == [("/b", 510)]
    assert ears(540) == [("/b", 530)]
