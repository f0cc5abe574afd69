"""The replay as a process: what it publishes is what was recorded, when it should, with a clock of its own."""

import functools
import time

import numpy as np
import pytest
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64MultiArray, String
from std_srvs.srv import SetBool

from nw_gear_common import names
from nw_gear_common.ros import from_message, live_qos, to_message, to_seconds
from nw_gear_common.tables import Table
from nw_gear_monitor.pipeline import Pipeline
from test.monitor import bad_recordings
from test.monitor.gear_signal import blocks, paper, waveform
from test.monitor.recordings import Message, write
from test.system.processes import Probe, running

WAVEFORM = "/nw_gear/waveform"
NOTE = "/nw_gear/note"
TABLE = "std_msgs/msg/Float64MultiArray"
STRING = "std_msgs/msg/String"
CLOCK = "rosgraph_msgs/msg/Clock"
START = 100.0
BLOCK = 0.05
COMPILING = 120.0
"""Longest wait for a monitor (s): a machine without compiled kernels makes them first."""

LATCHED = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def nanoseconds(seconds):
    return round(seconds * 1e9)


def serialised(message):
    """CDR as it comes from the network: filled up with zeros to a multiple of four bytes."""
    data = serialize_message(message)
    return data + bytes(-len(data) % 4)


@functools.cache
def recorded(seconds=2.0):
    """Twenty blocks of waveform a second, a note every half, and a clock that must not come again."""
    made = []
    for i in range(round(seconds / BLOCK)):
        moment = nanoseconds(START + i * BLOCK)
        data = np.random.default_rng(i).normal(size=(4, 2))
        made.append(Message(WAVEFORM, TABLE, serialised(to_message(Table("sample", ("time", "x"), data))), moment))
        if i % 10 == 0:
            made.append(Message(NOTE, STRING, serialised(String(data=f"note {i}")), moment))
        made.append(Message(names.CLOCK, CLOCK, serialised(Clock()), moment))
    return tuple(made)


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    return write(tmp_path_factory.mktemp("recorded") / "run", recorded())


class Listener:
    """Everything that comes on the topics and the clock, in the order of arrival, with wall times."""

    def __init__(self, probe):
        self.heard = []
        self.clocks = []
        self._probe = probe
        self._listen(Float64MultiArray, WAVEFORM, live_qos(1000))
        self._listen(String, NOTE, live_qos(1000))
        probe.node.create_subscription(Clock, names.CLOCK, self._on_clock, live_qos(1000))

    def _listen(self, kind, topic, qos):
        def take(data):
            self.heard.append((topic, data, time.monotonic()))

        self._probe.node.create_subscription(kind, topic, take, qos, raw=True)

    def _on_clock(self, message):
        self.clocks.append((to_seconds(message.clock), time.monotonic()))

    def of(self, topic):
        return [data for name, data, _time in self.heard if name == topic]


def replay(recording, *parameters):
    return running("replay_node", [f"uri:={recording}", "wait_for:=1", *parameters])


def until_it_ends(probe, process):
    """Listen until the process has ended and everything has arrived."""
    probe.wait_until(lambda: process.code is not None)
    end = time.monotonic() + 0.5
    while time.monotonic() < end:
        probe.spin_once(0.05)
    assert process.code == 0, process.report()


def data_of(topic, since=0.0):
    return [m.data for m in recorded() if m.topic == topic and m.log_time >= nanoseconds(START + since)]


def test_the_same_bytes_in_the_same_order_at_their_times(recording):
    with Probe() as probe:
        listener = Listener(probe)
        with replay(recording) as process:
            until_it_ends(probe, process)
    assert listener.of(WAVEFORM) == data_of(WAVEFORM)
    assert listener.of(NOTE) == data_of(NOTE)
    arrived = [t for topic, _data, t in listener.heard if topic == WAVEFORM]
    assert arrived[-1] - arrived[0] == pytest.approx(39 * BLOCK, abs=0.3)
    clocks = np.array([clock for clock, _time in listener.clocks])
    assert np.all(np.diff(clocks) >= 0.0)
    assert clocks[0] == pytest.approx(START)
    assert clocks[-1] == pytest.approx(START + 39 * BLOCK)
    assert len(clocks) >= 40 * 39 * BLOCK


def test_the_clock_has_reached_every_message_when_it_comes(recording):
    """At ten times real time too, where blocks come every 5 ms."""
    with Probe() as probe:
        listener = Listener(probe)
        reached = []
        probe.node.create_subscription(
            Float64MultiArray, WAVEFORM, lambda _m: reached.append(listener.clocks[-1][0]), live_qos(1000)
        )
        with replay(recording, "rate:=10.0") as process:
            until_it_ends(probe, process)
    assert np.max(np.diff([clock for clock, _time in listener.clocks])) <= BLOCK + 1e-6
    assert len(reached) == 40


def test_rate_and_offset(recording):
    with Probe() as probe:
        listener = Listener(probe)
        with replay(recording, "rate:=4.0", "start_offset:=1.0") as process:
            until_it_ends(probe, process)
    assert listener.of(WAVEFORM) == data_of(WAVEFORM, since=1.0)
    arrived = [t for topic, _data, t in listener.heard if topic == WAVEFORM]
    assert arrived[-1] - arrived[0] == pytest.approx(19 * BLOCK / 4.0, abs=0.15)
    assert listener.clocks[0][0] == pytest.approx(START + 1.0)


def test_a_choice_of_topics(recording):
    with Probe() as probe:
        listener = Listener(probe)
        with replay(recording, "topics:=['note']", "rate:=10.0") as process:
            until_it_ends(probe, process)
    assert listener.of(NOTE) == data_of(NOTE)
    assert not listener.of(WAVEFORM)
    assert listener.clocks


def test_loop_begins_again_and_the_clock_jumps_back(recording):
    with Probe() as probe:
        listener = Listener(probe)
        with replay(recording, "loop:=true", "rate:=10.0") as process:
            probe.wait_until(lambda: len(listener.of(WAVEFORM)) >= 100, process)
            process.interrupt()
            assert process.wait(5.0) == 0, process.report()
    assert listener.of(WAVEFORM)[:80] == data_of(WAVEFORM) * 2
    assert np.min(np.diff([clock for clock, _time in listener.clocks])) < -1.0


def test_pause_and_a_new_rate_while_it_runs(recording):
    name = "/nw_gear/replay_node"
    with Probe() as probe:
        listener = Listener(probe)
        with replay(recording, "rate:=0.05") as process:
            probe.wait_until(lambda: len(listener.clocks) > 3, process)
            assert probe.call(SetBool, f"{name}/pause", SetBool.Request(data=True), process).message == "paused"
            before = len(listener.clocks)
            probe.wait_until(lambda: len(listener.clocks) > before + 20, process)
            standing = {clock for clock, _time in listener.clocks[before + 5 :]}
            assert len(standing) == 1
            value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=20.0)
            request = SetParameters.Request(parameters=[ParameterMessage(name="rate", value=value)])
            assert probe.call(SetParameters, f"{name}/set_parameters", request, process).results[0].successful
            probe.call(SetBool, f"{name}/pause", SetBool.Request(data=False), process)
            until_it_ends(probe, process)
    assert listener.of(WAVEFORM) == data_of(WAVEFORM)


def test_latched_topics_are_latched_again(tmp_path):
    """`/chatter` was recorded with transient local durability: who comes late still gets it."""
    words = [
        Message("/chatter", STRING, serialised(String(data="early")), nanoseconds(START)),
        Message(
            WAVEFORM,
            TABLE,
            serialize_message(to_message(Table("sample", ("t",), np.ones((1, 1))))),
            nanoseconds(START + 60),
        ),
    ]
    with running("replay_node", [f"uri:={write(tmp_path / 'run', words)}"]) as process, Probe() as probe:
        probe.wait_until(lambda: "replaying" in process.stderr, process)
        received = probe.collect(String, "/chatter", LATCHED)
        probe.wait_until(lambda: bool(received), process)
        assert received[0].data == "early"
        process.interrupt()
        assert process.wait(5.0) == 0


def test_a_recorded_reset_of_the_clock_is_a_new_epoch(tmp_path):
    """Messages stay in the order of recording; nothing is sorted into the epoch before."""
    times = [5.0, 5.1, 5.2, 0.0, 0.1, 0.2]
    words = [Message(NOTE, STRING, serialised(String(data=f"{i}")), nanoseconds(t)) for i, t in enumerate(times)]
    with Probe() as probe:
        listener = Listener(probe)
        with replay(write(tmp_path / "run", words)) as process:
            until_it_ends(probe, process)
    assert listener.of(NOTE) == [m.data for m in words]
    clocks = [clock for clock, _time in listener.clocks]
    assert np.min(np.diff(clocks)) == pytest.approx(-5.2, abs=0.05)


def cut(folder):
    run = write(folder / "run", recorded(0.2))
    whole = (run / "run_0.mcap").read_bytes()
    (run / "run_0.mcap").write_bytes(whole[:-50])
    return f"uri:={run}"


def sqlite(folder):
    (folder / "run").mkdir()
    (folder / "run" / "run_0.db3").write_bytes(b"SQLite format 3\0")
    return f"uri:={folder / 'run'}"


def elsewhere(folder):
    run = write(folder / "run", recorded(0.2))
    text = (run / "metadata.yaml").read_text()
    (run / "metadata.yaml").write_text(text.replace("- run_0.mcap", "- ../../x.mcap", 1))
    return f"uri:={run}"


def lies(folder):
    return f"uri:={bad_recordings.write(folder / 'run.mcap', [bad_recordings.chunk(b'abc', '', bad_recordings.MANY)])}"


def unknown(folder):
    good = bad_recordings.honest([bad_recordings.message()])
    return f"uri:={bad_recordings.write(folder / 'run.mcap', [good], kind='this/msg/That')}"


WRONG = {
    "nothing": (lambda folder: f"uri:={folder / 'nothing'}", [], "nothing of that name"),
    "no uri": (lambda _folder: "rate:=1.0", [], "parameter uri: expected a recording"),
    "damaged": (cut, [], "nw_gear recover"),
    "sqlite": (sqlite, [], "an SQLite bag: `ros2 bag convert`"),
    "elsewhere": (elsewhere, [], "relative_file_paths: expected names of files in this folder"),
    "lies": (lies, [], "a chunk claims to have 10737418240 bytes"),
    "unknown": (unknown, [], "only such that can't be replayed here"),
    "rate": (lambda folder: f"uri:={write(folder / 'run', recorded(0.2))}", ["rate:=0.0"], "rate"),
    "offset": (lambda folder: f"uri:={write(folder / 'run', recorded(0.2))}", ["start_offset:=9.0"], "start_offset"),
    "topics": (lambda folder: f"uri:={write(folder / 'run', recorded(0.2))}", ["topics:=['/x']"], "parameter topics"),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_input_gets_one_line(tmp_path, case):
    make, parameters, words = WRONG[case]
    with running("replay_node", [make(tmp_path), *parameters]) as process:
        assert process.wait() == 2, process.report()
        assert words in process.stderr
        assert "Traceback" not in process.stderr
        assert len([line for line in process.stderr.splitlines() if "[WARN]" not in line]) == 1


def test_a_monitor_that_hears_a_replay_finds_what_it_found_live(tmp_path):
    """Five times as fast as it was recorded. Live the monitor publishes what its pipeline gives (test_monitor_node)."""
    table = waveform(6.0, extra={"II": lambda _time, phase: 6e-6 * np.cos(0.5 * phase)}, noise=0.01)
    pieces = blocks(table)
    offline = Pipeline(paper())
    hops = [hop for piece in pieces for hop in offline.feed(piece)]
    messages = [
        Message(WAVEFORM, TABLE, serialised(to_message(piece)), nanoseconds(START + piece.data[-1, 0]))
        for piece in pieces
    ]
    folder = write(tmp_path / "run", messages)
    with Probe() as probe, running("gear_monitor_node") as monitor:
        topics = [names.indicators_topic(mesh) for mesh in names.MESHES]
        received = {topic: probe.collect(Float64MultiArray, f"/nw_gear/{topic}") for topic in topics}
        probe.wait_until(lambda: "monitoring" in monitor.stderr, monitor, limit=COMPILING)
        for topic in topics:
            probe.wait_for_match(f"/nw_gear/{topic}", monitor, publishers=1)
        with replay(folder, "rate:=5.0") as process:
            probe.wait_until(lambda: all(len(received[t]) == len(hops) for t in topics), monitor, limit=60.0)
            assert process.wait() == 0
    for mesh in names.MESHES:
        topic = names.indicators_topic(mesh)
        for message, hop in zip(received[topic], hops, strict=True):
            got, expected = from_message(message, topic), hop.indicators[mesh]
            assert got.columns == expected.columns
            assert np.allclose(got.data, expected.data, rtol=1e-9, atol=1e-18, equal_nan=True)
