"""Log times, pause, loss and the choice of topics, without ROS."""

import pytest
from builtin_interfaces.msg import Time
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

from nw_gear_common.errors import InputError
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
