"""The recorder as a process, fed over DDS, and its recordings read by libraries that share no code with it."""

import json
import resource
import signal
import sys
import time

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64MultiArray, String
from std_srvs.srv import SetBool
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from nw_gear_common import names
from nw_gear_common.ros import live_qos, to_message, to_stamp
from nw_gear_common.tables import Table
from nw_gear_monitor.records.reader import Recording
from test.node.reader import node_reader
from test.system.processes import Probe, running

WAVEFORM = "/nw_gear/waveform"
LATCHED = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "run"


def recorder(folder, *parameters, **kwargs):
    return running("recorder_node", [f"uri:={folder}", *parameters], **kwargs)


class Source:
    """Publishers of the probe that wait until the recorder listens."""

    def __init__(self, probe, *processes):
        self.probe, self.processes = probe, processes
        self.publishers = {}

    def add(self, kind, topic, qos=None):
        self.publishers[topic] = self.probe.node.create_publisher(kind, topic, qos or live_qos(1000))

    def wait(self):
        for publisher in self.publishers.values():
            self.probe.wait_until(lambda p=publisher: p.get_subscription_count() > 0, *self.processes)

    def publish(self, topic, message):
        self.publishers[topic].publish(message)
        self.probe.spin_once(0.0)


def table(i, rows=16):
    data = np.random.default_rng(i).normal(size=(rows, 3))
    return Table("sample", ("time", "x_III", "v_III"), data)


def count(folder, topic):
    with Recording.open(folder) as recording:
        assert recording.complete
        return recording.topics[topic].messages


def test_types_of_other_packages_latched_and_best_effort_topics_in_all_readers(folder):
    with Probe() as probe:
        source = Source(probe)
        source.add(String, "/nw_gear/note", LATCHED)
        source.publish("/nw_gear/note", String(data="before the recorder"))
        with recorder(folder, "topics:=['.*']") as process:
            source.processes = (process,)
            source.add(Odometry, "/odometry", QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT))
            source.add(JointTrajectory, "/plan")
            source.add(Float64MultiArray, WAVEFORM)
            source.wait()
            point = JointTrajectoryPoint(positions=[1.0, 2.0], effort=[3.0])
            for i in range(50):
                source.publish(WAVEFORM, to_message(table(i)))
                source.publish("/odometry", Odometry(child_frame_id=f"frame {i}"))
                source.publish("/plan", JointTrajectory(joint_names=["a"], points=[point] * (i % 4)))
            source.publish("/nw_gear/note", String(data="ü"))
            process.interrupt()
            assert process.wait() == 0, process.report()
            assert process.stdout.splitlines()[-1] == f"recording to {folder}"  # the middleware may complain before
    wanted = {WAVEFORM: 50, "/odometry": 50, "/plan": 50, "/nw_gear/note": 2}
    with Reader(folder) as reader:
        assert {c.topic: c.msgcount for c in reader.connections if c.topic in wanted} == wanted
        qos = {c.topic: c.ext.offered_qos_profiles[0] for c in reader.connections}
        assert qos["/nw_gear/note"].durability.name == "TRANSIENT_LOCAL"
        assert qos["/odometry"].reliability.name == "BEST_EFFORT"
        assert qos[WAVEFORM].reliability.name == "RELIABLE"
    with AnyReader([folder]) as reader:
        for connection in reader.connections:
            assert connection.digest == reader.typestore.hash_rihs01(connection.msgtype)
        decoded = [(c.topic, reader.deserialize(data, c.msgtype)) for c, _time, data in reader.messages()]
    assert [m.data for topic, m in decoded if topic == "/nw_gear/note"] == ["before the recorder", "ü"]
    assert [len(m.points) for topic, m in decoded if topic == "/plan"] == [i % 4 for i in range(50)]
    with (folder / "run_0.mcap").open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        frames = [m.decoded_message.child_frame_id for m in reader.iter_decoded_messages("/odometry")]
    assert frames == [f"frame {i}" for i in range(50)]
    found = node_reader(folder / "run_0.mcap")["topics"]
    assert {topic: found[topic]["count"] for topic in wanted} == wanted
    for i, (_time, message) in enumerate(found[WAVEFORM]["messages"]):
        assert np.array_equal(np.reshape(message["data"], (16, 3)), table(i).data)


def test_killed_it_loses_at_most_the_flush_period_and_is_repaired(folder):
    """Every message carries the time at which it was sent, so that the loss can be told in seconds."""
    with Probe() as probe, recorder(folder, "flush_period:=0.3") as process:
        source = Source(probe, process)
        source.add(Float64MultiArray, WAVEFORM)
        source.wait()
        began, sent = time.monotonic(), []
        while time.monotonic() < began + 1.5:
            sent.append(time.monotonic())
            source.publish(WAVEFORM, to_message(Table("sample", ("time", "count"), np.array([[sent[-1], len(sent)]]))))
            probe.spin_once(0.002)
        killed = time.monotonic()
        process.signal(signal.SIGKILL)
        process.wait()
    assert not (folder / "metadata.yaml").exists()
    with running("nw_gear", arguments=["recover", str(folder), "--json"]) as repair:
        assert repair.wait() == 0, repair.report()
        assert json.loads(repair.stdout)["files"][0]["kept_as"] == "run_0.mcap.damaged"
    with Recording.open(folder) as recording:
        got = [tuple(t.data[0]) for _time, t in recording.tables(WAVEFORM)]
    assert [stamp for stamp, _number in got] == sent[: len(got)]
    slack = 0.3  # until the messages were taken and the timer of a busy machine came
    assert killed - got[-1][0] < 0.3 + slack
    with AnyReader([folder]) as reader:
        assert sum(1 for c, _t, _d in reader.messages() if c.topic == WAVEFORM) == len(got)
    assert node_reader(folder / "run_0.mcap")["topics"][WAVEFORM]["count"] == len(got)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_with_everything_written(folder, number):
    with Probe() as probe, recorder(folder, "flush_period:=60.0", "compression:=lz4") as process:
        source = Source(probe, process)
        source.add(Float64MultiArray, WAVEFORM)
        source.wait()
        for i in range(300):
            source.publish(WAVEFORM, to_message(table(i, rows=256)))
        assert source.publishers[WAVEFORM].wait_for_all_acked()
        process.signal(number)
        assert process.wait(5.0) == 0, process.report()
    with Recording.open(folder) as recording:
        assert recording.complete
        tables = [t.data for _time, t in recording.tables(WAVEFORM)]
    assert len(tables) == 300
    assert all(np.array_equal(data, table(i, rows=256).data) for i, data in enumerate(tables))


def test_a_signal_during_the_start_leaves_a_readable_recording_or_nothing(folder):
    for delay in range(3):
        run = folder.with_name(f"run{delay}")
        with recorder(run) as process:
            process.wait_until_signals_are_answered()
            end = time.monotonic() + 0.15 * delay
            while time.monotonic() < end:
                time.sleep(0.01)
            process.signal(signal.SIGTERM)
            assert process.wait() == 0, process.report()
        if run.exists():
            with Recording.open(run) as recording:
                assert recording.complete


def test_pause_leaves_out_and_diagnostics_tell(folder):
    with Probe() as probe, recorder(folder) as process:
        source = Source(probe, process)
        source.add(Float64MultiArray, WAVEFORM)
        source.wait()
        diagnostics = probe.collect(DiagnosticArray, names.DIAGNOSTICS)

        def publish(amount):
            for i in range(amount):
                source.publish(WAVEFORM, to_message(table(i)))
            assert source.publishers[WAVEFORM].wait_for_all_acked()

        def values():
            found = [s for array in diagnostics for s in array.status if s.name == "recorder_node: recording"]
            return {pair.key: pair.value for pair in found[-1].values} if found else {}

        publish(10)
        pause = "/nw_gear/recorder_node/pause"
        assert probe.call(SetBool, pause, SetBool.Request(data=True), process).message == "paused"
        publish(20)
        probe.wait_until(lambda: values().get("paused") == "true", process)
        assert probe.call(SetBool, pause, SetBool.Request(data=False), process).success
        publish(30)
        probe.wait_until(lambda: values().get("paused") == "false", process)
        assert values()["lost messages (1)"] == "0"
        assert int(values()["left out while paused (1)"]) >= 20
        process.interrupt()
        assert process.wait() == 0
    assert count(folder, WAVEFORM) == 40


def test_an_unknown_type_is_named_once_and_everything_else_recorded(folder, tmp_path):
    """For the recorder alone a package of that name can't be imported."""
    (tmp_path / "path" / "nav_msgs").mkdir(parents=True)
    (tmp_path / "path" / "nav_msgs" / "__init__.py").write_text("raise ImportError('not installed')")
    variables = {"PYTHONPATH": str(tmp_path / "path")}
    with Probe() as probe, recorder(folder, variables=variables) as process:
        source = Source(probe, process)
        diagnostics = probe.collect(DiagnosticArray, names.DIAGNOSTICS)
        odometry = probe.node.create_publisher(Odometry, "/nw_gear/odometry", 10)
        source.add(Float64MultiArray, WAVEFORM)
        source.wait()
        source.publish(WAVEFORM, to_message(table(0)))

        def named():
            found = [s for a in diagnostics for s in a.status if s.name == "recorder_node: recording"]
            return any(p.key == "skipped topics" and p.value == "/nw_gear/odometry" for s in found for p in s.values)

        probe.wait_until(named, process)
        odometry.publish(Odometry())
        process.interrupt()
        assert process.wait() == 0
        line = "/nw_gear/odometry isn't recorded: type nav_msgs/msg/Odometry"
        assert process.stderr.count(line) == 1
    assert count(folder, WAVEFORM) == 1


def test_provenance_of_every_node_in_the_namespace(folder):
    wind_node, recording = running("wind_node", ["seed:=7"]), recorder(folder, "provenance:='how it was started'")
    with wind_node as wind, recording as process, Probe() as probe:
        diagnostics = probe.collect(DiagnosticArray, names.DIAGNOSTICS)
        mute = Node("mute", namespace="/nw_gear", context=probe.context, start_parameter_services=False)

        def messages():
            found = [s for a in diagnostics for s in a.status if s.name == "recorder_node: recording"]
            pairs = {p.key: p.value for p in found[-1].values} if found else {}
            return pairs.get("no parameters yet from") == "/nw_gear/mute" and int(pairs["topics (1)"]) >= 2

        probe.wait_until(messages, wind, process)
        process.interrupt()
        assert process.wait() == 0, process.report()
        mute.destroy_node()
    with Recording.open(folder) as recording:
        provenance = recording.provenance
    assert provenance["nw_gear.node.wind_node"]["seed"] == "7"
    assert provenance["nw_gear.node.wind_node"]["source"] == "weibull"
    assert "(unanswered)" in provenance["nw_gear.node.mute"]
    assert provenance["nw_gear.node.recorder_node"]["uri"] == str(folder)
    run = provenance["nw_gear.run"]
    assert "recorder_node" in run["command_line"]
    assert json.loads(run["versions"])["python"] == ".".join(map(str, sys.version_info[:3]))
    assert run["provenance"] == "how it was started"


def test_in_simulated_time_log_times_are_those_of_the_clock(folder):
    with Probe() as probe, recorder(folder, "use_sim_time:=true", "topics:=['note']") as process:
        source = Source(probe, process)
        source.add(Clock, names.CLOCK)
        source.add(String, "/nw_gear/note")
        source.wait()
        source.publish("/nw_gear/note", String(data="before the clock"))
        for second in (3.0, 4.0, 5.0):
            source.publish(names.CLOCK, Clock(clock=to_stamp(second)))
            source.publish("/nw_gear/note", String(data=f"at {second}"))
        assert source.publishers["/nw_gear/note"].wait_for_all_acked()
        process.interrupt()
        assert process.wait() == 0
    with Recording.open(folder) as recording:
        assert list(recording.topics) == ["/nw_gear/note"]
        entries = [(e.log_time, e.value.data) for e in recording.read()]
    assert entries == [(3.0, "before the clock"), (3.0, "at 3.0"), (4.0, "at 4.0"), (5.0, "at 5.0")]


def test_a_publisher_that_offers_less_is_adapted_to(folder):
    with Probe() as probe, recorder(folder) as process:
        source = Source(probe, process)
        source.add(String, "/nw_gear/note", LATCHED)
        source.wait()
        source.publish("/nw_gear/note", String(data="latched"))
        weaker = probe.node.create_publisher(
            String, "/nw_gear/note", QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
        )
        probe.wait_until(lambda: weaker.get_subscription_count() > 0, process)
        weaker.publish(String(data="best effort"))
        probe.wait_until(lambda: "adapting" in process.stderr, process)
        source.publish("/nw_gear/note", String(data="end"))
        process.interrupt()
        assert process.wait() == 0
    with Recording.open(folder) as recording:
        words = [entry.value.data for entry in recording.read(["/nw_gear/note"])]
    assert words[0] == "latched"
    assert "best effort" in words


def test_a_full_disk_ends_it_with_a_message(folder):
    """A limit on the size of files stands for a disk that is full."""
    with Probe() as probe, recorder(folder, "flush_period:=0.1") as process:
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (100_000, 100_000))
        source = Source(probe, process)
        source.add(Float64MultiArray, WAVEFORM)
        source.wait()
        i = 0
        while process.code is None and i < 5000:
            i += 1
            source.publish(WAVEFORM, to_message(table(i)))
            probe.spin_once(0.002)
        assert process.wait() == 1, process.report()
        assert f"can't write to {folder}" in process.stderr
        assert "nw_gear recover" in process.stderr
        assert "Traceback" not in process.stderr
    with running("nw_gear", arguments=["recover", str(folder)]) as repair:
        assert repair.wait() == 0, repair.report()
    assert count(folder, WAVEFORM) > 0


def test_a_lost_folder_ends_it_with_a_message(folder):
    with Probe() as probe, recorder(folder, "flush_period:=0.1") as process:
        probe.wait_until(lambda: "recording to" in process.stdout, process)
        for path in folder.iterdir():
            path.unlink()
        folder.rmdir()
        assert process.wait() == 1
        assert f"can't write to {folder}" in process.stderr


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ([], "parameter uri: expected a new folder"),
        (["uri:=/"], "/: expected a new folder, got one that exists"),
        (["uri:=/dev/null/run"], "expected a folder that can be made"),
        (["uri:=new", "compression:=gzip"], "expected one of zstd, lz4, none"),
        (["uri:=new", "flush_period:=0.0"], "flush_period"),
        (["uri:=new", "topics:=['(']"], "topics[0]"),
        (["uri:=new", "speed:=1"], "parameter speed"),
    ],
)
def test_wrong_parameters_get_one_line_and_leave_nothing(tmp_path, monkeypatch, parameters, words):
    monkeypatch.chdir(tmp_path)
    with running("recorder_node", parameters) as process:
        assert process.wait() == 2, process.report()
        assert words in process.stderr
        assert "Traceback" not in process.stderr
    assert not list(tmp_path.iterdir())
