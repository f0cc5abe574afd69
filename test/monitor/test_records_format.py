"""What the writer makes, as readers see it that share no code with it."""

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap.records import Message
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader

from nw_gear_common.errors import InputError
from nw_gear_monitor.records.definitions import SEPARATOR, define, dependencies, from_fields
from nw_gear_monitor.records.metadata import TopicEntry
from nw_gear_monitor.records.qos import Qos, from_yaml, to_yaml
from nw_gear_monitor.records.scan import Scan
from nw_gear_monitor.records.writer import RecordingWriter
from test.monitor.recordings import START, mixed, start, table, write
from test.node.reader import node_reader

COMPRESSIONS = ("zstd", "lz4", "none")


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_mcap_ros2_reads_every_message(tmp_path, compression):
    messages = mixed()
    file = write(tmp_path / "run", messages, compression) / "run_0.mcap"
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        read = list(reader.iter_decoded_messages())
        assert {r.schema.encoding for r in read} == {"ros2msg"}
        assert [(r.channel.topic, r.message.data) for r in read] == [(m.topic, m.data) for m in messages]
        assert [r.message.log_time for r in read] == [m.log_time for m in messages]
        assert [r.message.publish_time for r in read] == [m.log_time + 5 for m in messages]
        plans = [r.decoded_message for r in read if r.channel.topic == "/plan"]
        assert plans[7].points[0].positions == [7.0, 2.0]
        words = [r.decoded_message for r in read if r.channel.topic == "/diagnostics"]
        assert (words[3].status[0].message, words[3].status[0].values[0].value) == ("ü", "3")


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_rosbags_reads_every_message(tmp_path, compression):
    messages = mixed()
    folder = write(tmp_path / "run", messages, compression)
    with Reader(folder) as reader:
        assert reader.message_count == len(messages)
        assert reader.start_time == START
        assert reader.duration == messages[-1].log_time - START + 1  # rosbags counts the last nanosecond too
        assert [(c.topic, t, bytes(d)) for c, t, d in reader.messages()] == [
            (m.topic, m.log_time, m.data) for m in messages
        ]
        latched = next(c for c in reader.connections if c.topic == "/chatter")
        assert [q.durability.name for q in latched.ext.offered_qos_profiles] == ["TRANSIENT_LOCAL"]
    with AnyReader([folder]) as reader:
        odometry = [reader.deserialize(data, c.msgtype) for c, _t, data in reader.messages() if c.topic == "/odometry"]
    assert odometry[9].pose.pose.position.x == 4.5
    assert odometry[9].pose.covariance[35] == 9.0


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_node_reads_every_message(tmp_path, compression):
    messages = mixed(12)
    found = node_reader(write(tmp_path / "run", messages, compression) / "run_0.mcap")
    assert found["profile"] == "ros2"
    assert {name: topic["count"] for name, topic in found["topics"].items()} == {m.topic: 12 for m in messages}
    assert found["metadata"]["nw_gear.run"] == {"command_line": "made by a test"}
    for i, (time, message) in enumerate(found["topics"]["/nw_gear/waveform"]["messages"]):
        assert int(time) == START + i * 10_000_000
        assert message["layout"]["dim"][1] == {"label": "time,x_III,v_III", "size": 3, "stride": 3}
        assert np.array_equal(np.reshape(message["data"], (8, 3)), table(8, seed=i).data)
    assert found["topics"]["/odometry"]["messages"][5][1]["child_frame_id"] == "frame 5"


def test_rosbags_finds_the_type_hashes_that_ros_published(tmp_path):
    """Two ways to one number: ours is read from ROS's files, rosbags computes it from the recorded definition."""
    with AnyReader([write(tmp_path / "run", mixed(1))]) as reader:
        for connection in reader.connections:
            assert connection.digest == reader.typestore.hash_rihs01(connection.msgtype), connection.msgtype


def test_metadata_has_the_keys_of_version_nine(tmp_path):
    messages = mixed(3)
    content = yaml.safe_load((write(tmp_path / "run", messages) / "metadata.yaml").read_text())
    information = content["rosbag2_bagfile_information"]
    assert information["version"] == 9
    assert information["storage_identifier"] == "mcap"
    assert information["relative_file_paths"] == ["run_0.mcap"]
    assert information["message_count"] == len(messages)
    assert information["duration"]["nanoseconds"] == 20_000_000
    assert information["starting_time"]["nanoseconds_since_epoch"] == START
    counts = {t["topic_metadata"]["name"]: t["message_count"] for t in information["topics_with_message_count"]}
    assert counts == {m.topic: 3 for m in messages}
    profile = information["topics_with_message_count"][0]["topic_metadata"]["offered_qos_profiles"][0]
    assert (profile["reliability"], profile["durability"], profile["history"]) == ("reliable", "volatile", "unknown")
    assert information["topics_with_message_count"][0]["topic_metadata"]["type_description_hash"].startswith("RIHS01_")


def test_an_empty_recording_is_one_too(tmp_path):
    folder = write(tmp_path / "run")
    with Reader(folder) as reader:
        assert reader.message_count == 0
    assert node_reader(folder / "run_0.mcap")["topics"] == {}


def test_topics_without_messages_are_listed(tmp_path):
    writer = RecordingWriter(tmp_path / "run")
    definition = define("std_msgs/msg/String")
    writer.add_topic(TopicEntry("/silent", "std_msgs/msg/String", definition.type_hash, (Qos(),)), definition.text)
    writer.close()
    with Reader(tmp_path / "run") as reader:
        assert [(c.topic, c.msgcount) for c in reader.connections] == [("/silent", 0)]


def test_flushed_messages_are_in_the_file(tmp_path):
    """Without an index: the file as a killed process leaves it."""
    messages = mixed(5)
    writer, numbers = start(tmp_path / "run", messages)
    for message in messages:
        writer.write(numbers[message.topic], message.data, message.log_time, message.log_time)
    writer.flush()
    left = writer.path.read_bytes()
    writer.close()
    copy = tmp_path / "killed.mcap"
    copy.write_bytes(left)
    assert [record.data for record in Scan(copy).records() if isinstance(record, Message)] == [m.data for m in messages]


def test_qos_survives_and_old_numbers_are_understood():
    profiles = (Qos(), Qos("best_effort", "transient_local", "keep_last", 7))
    assert from_yaml(to_yaml(profiles)) == profiles
    old = "- {history: 1, depth: 5, reliability: 2, durability: 1}"
    assert from_yaml(old) == (Qos("best_effort", "transient_local", "keep_last", 5),)
    assert from_yaml("") == from_yaml("{") == from_yaml("3") == ()


def test_definitions_name_every_dependency_once():
    text = define("nav_msgs/msg/Odometry").text
    parts = text.split(SEPARATOR + "\nMSG: ")
    assert [part.splitlines()[0] for part in parts[1:]] == list(
        dict.fromkeys(part.splitlines()[0] for part in parts[1:])
    )
    assert {part.splitlines()[0] for part in parts[1:]} == {
        "std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose",
        "geometry_msgs/Point", "geometry_msgs/Quaternion", "geometry_msgs/TwistWithCovariance",
        "geometry_msgs/Twist", "geometry_msgs/Vector3",
    }  # fmt: skip


def test_dependencies_are_told_from_comments_constants_and_bounds():
    text = """
    # Comment other/Type x
    uint8 A=1
    string<=10[<=5] words "other/Type y"
    Own[] mine
    other_msgs/msg/Thing[3] things
    other_msgs/Thing thing  # again
    float64 value 1.0
    """
    assert dependencies(text, "here") == ["here/Own", "other_msgs/Thing", "other_msgs/Thing"]


def test_a_type_without_files_is_described_from_its_class():
    fields = {
        "a": "double", "b": "sequence<float>", "c": "sequence<uint8, 3>", "d": "boolean[4]", "e": "string<10>",
        "f": "sequence<geometry_msgs/Point>", "g": "octet",
    }  # fmt: skip
    text = from_fields(fields)
    assert text.splitlines() == [
        "float64 a", "float32[] b", "uint8[<=3] c", "bool[4] d", "string<=10 e", "geometry_msgs/Point[] f", "byte g"
    ]  # fmt: skip
    assert "MSG: geometry_msgs/Point\n" in define("nowhere_msgs/msg/Thing", fields).text
    with pytest.raises(InputError, match="nowhere_msgs/msg/Thing"):
        define("nowhere_msgs/msg/Thing")


def test_the_folder_must_be_new_and_writable(tmp_path):
    (tmp_path / "there").mkdir()
    with pytest.raises(InputError, match="a new folder, got one that exists"):
        RecordingWriter(tmp_path / "there")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="a folder that can be made"):
        RecordingWriter(tmp_path / "file" / "run")
