"""Reading recordings: tables without loss, decoded messages, provenance, and what wrong input gets."""

import json
import sqlite3
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as ForeignWriter
from rosbags.typesys import Stores, get_typestore
from std_msgs.msg import Float64MultiArray

from nw_gear_common import cli
from nw_gear_common.errors import InputError
from nw_gear_common.ros import from_message, to_message
from nw_gear_common.tables import Table
from nw_gear_monitor.records.cdr import from_table, to_table
from nw_gear_monitor.records.reader import Recording
from test.monitor.recordings import START, Message, mixed, table, write

WAVEFORM = "/nw_gear/waveform"
TABLE = "std_msgs/msg/Float64MultiArray"

names = st.text(st.characters(codec="utf-8", exclude_characters=",\0", exclude_categories=["Cs"]), min_size=1)


@settings(max_examples=40, deadline=None)
@given(st.lists(names, min_size=1, max_size=6), st.integers(0, 20), names, st.data())
def test_every_table_survives_serialisation(columns, rows, row, data):
    values = data.draw(arrays(np.float64, (rows, len(columns))))
    original = Table(row, tuple(columns), values)
    read = to_table(serialize_message(to_message(original)), "topic")
    assert (read.row, read.columns) == (original.row, original.columns)
    assert read.data.tobytes() == original.data.tobytes()


def test_big_endian_messages_are_read_too():
    text = b"row\0"
    data = b"\x00\x00\x00\x00" + struct.pack(">I", 2)
    for size, stride in ((1, 2), (2, 2)):
        data += struct.pack(">I", 4) + (text if stride != size else b"a,b\0") + struct.pack(">II", size, stride)
    data += struct.pack(">II", 0, 2)
    data += b"\0" * (-(len(data) - 4) % 8) + struct.pack(">2d", 1.5, -2.5)
    read = to_table(data, "topic")
    assert (read.row, read.columns, read.data.tolist()) == ("row", ("a", "b"), [[1.5, -2.5]])


@given(st.binary(max_size=200))
def test_anything_else_is_refused_in_one_way(data):
    with pytest.raises(InputError, match="topic"):
        to_table(data, "topic")


def test_cut_messages_are_refused():
    whole = serialize_message(to_message(table(4)))
    for length in range(len(whole)):
        with pytest.raises(InputError):
            to_table(whole[:length], "topic")


def test_topics_times_tables_and_messages(tmp_path):
    messages = mixed()
    with Recording.open(write(tmp_path / "run", messages, flush_every=17)) as recording:
        assert recording.complete
        assert not recording.damage
        assert recording.topics[WAVEFORM] == (TABLE, 40)
        assert recording.duration == pytest.approx(0.39, abs=1e-9)
        assert recording.start_ns == START
        assert recording.message_count == len(messages)
        assert recording.provenance == {"nw_gear.run": {"command_line": "made by a test"}}
        assert recording.qos("/chatter")[0].durability == "transient_local"
        tables = list(recording.tables(WAVEFORM))
        assert all(np.array_equal(t.data, table(8, seed=i).data) for i, (_time, t) in enumerate(tables))
        assert [time for time, _table in tables] == pytest.approx([1e-9 * START + 0.01 * i for i in range(40)])
        entries = list(recording.read({WAVEFORM, "/plan"}))
        assert [e.topic for e in entries] == [WAVEFORM, "/plan"] * 40
        assert isinstance(entries[0].value, Table)
        assert entries[15].value.points[0].positions == [7.0, 2.0]
        assert [m.data for m in recording.raw()] == [m.data for m in messages]
        late = list(recording.raw({"/chatter"}, since=START + 200_000_000))
        assert [m.log_time for m in late] == [START + i * 10_000_000 for i in range(20, 40)]
        decoded = next(iter(recording.messages([WAVEFORM]))).value
        assert decoded.layout.dim[1].label == "time,x_III,v_III"


def test_messages_come_in_the_order_of_recording_when_time_goes_back(tmp_path):
    data = serialize_message(to_message(table(1)))
    times = [30, 40, 50, 0, 10, 20]
    folder = write(tmp_path / "run", [Message(WAVEFORM, TABLE, data, time) for time in times], flush_every=2)
    with Recording.open(folder) as recording:
        assert [m.log_time for m in recording.raw()] == times
        assert (recording.start_ns, recording.end_ns) == (0, 50)


def test_an_array_that_is_no_table_comes_as_a_message(tmp_path):
    message = Message("/numbers", TABLE, serialize_message(Float64MultiArray(data=[1.0, 2.0])), START)
    with Recording.open(write(tmp_path / "run", [message])) as recording:
        assert list(next(iter(recording.read())).value.data) == [1.0, 2.0]
        with pytest.raises(InputError, match="two dimensions"):
            list(recording.tables("/numbers"))


def test_a_bare_file_and_a_recording_of_rosbags_are_read(tmp_path):
    folder = write(tmp_path / "run", mixed())
    with Recording.open(folder / "run_0.mcap") as recording:
        assert recording.message_count == 200
    store = get_typestore(Stores.ROS2_JAZZY)
    text = store.types["std_msgs/msg/String"]
    with ForeignWriter(tmp_path / "foreign", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/words", "std_msgs/msg/String", typestore=store)
        for i in range(5):
            writer.write(connection, START + i, store.serialize_cdr(text(data=f"word {i}"), "std_msgs/msg/String"))
    with Recording.open(tmp_path / "foreign") as recording:
        assert [entry.value.data for entry in recording.read()] == [f"word {i}" for i in range(5)]
        assert recording.provenance == {}


def nothing(folder):
    return folder / "nothing"


def empty_folder(folder):
    return folder


def other_file(folder):
    (folder / "run.mcap").write_bytes(b"Not an MCAP file, but long enough for a magic")
    return folder / "run.mcap"


def sqlite_file(folder):
    connection = sqlite3.connect(folder / "run_0.db3")
    connection.execute("create table messages (id integer)")
    connection.close()
    return folder


def sqlite_bag(folder):
    sqlite_file(folder)
    text = "rosbag2_bagfile_information: {version: 9, storage_identifier: sqlite3, message_count: 0, "
    (folder / "metadata.yaml").write_text(text + "relative_file_paths: [run_0.db3]}")
    return folder


def no_metadata(folder):
    run = write(folder / "run", mixed(3))
    (run / "metadata.yaml").unlink()
    return run


def strange_metadata(folder):
    run = write(folder / "run", mixed(3))
    (run / "metadata.yaml").write_text("something: else")
    return run


def no_file(folder):
    run = write(folder / "run", mixed(3))
    (run / "run_0.mcap").unlink()
    return run


def compressed_files(folder):
    run = write(folder / "run", mixed(3))
    path = run / "metadata.yaml"
    path.write_text(path.read_text().replace("compression_mode: ''", "compression_mode: FILE"))
    return run


def truncated(folder):
    run = write(folder / "run", mixed(3))
    whole = (run / "run_0.mcap").read_bytes()
    (run / "run_0.mcap").write_bytes(whole[:-40])
    return run


WRONG = {
    nothing: "nothing of that name",
    empty_folder: "a folder without MCAP files",
    other_file: "expected an MCAP file, got another kind of file",
    sqlite_file: "an SQLite bag",
    sqlite_bag: "sqlite3: `ros2 bag convert`",
    no_metadata: "metadata.yaml: .* wasn't finished, see `nw_gear recover`",
    strange_metadata: "metadata.yaml: expected a rosbag2 metadata file",
    no_file: "run_0.mcap",
    compressed_files: "compression mode file",
    truncated: "a damaged one, it ends before its index",
}


@pytest.mark.parametrize("make", WRONG, ids=lambda make: make.__name__)
def test_wrong_input_gets_one_line(tmp_path, make):
    with pytest.raises(InputError, match=WRONG[make]) as caught:
        Recording.open(make(tmp_path))
    assert "\n" not in str(caught.value)


def test_unknown_topics_and_topics_without_tables_are_named(tmp_path):
    with Recording.open(write(tmp_path / "run", mixed(2))) as recording:
        with pytest.raises(InputError, match="topic /nothing: expected one of"):
            list(recording.tables("/nothing"))
        with pytest.raises(InputError, match="/plan: expected a table"):
            list(recording.tables("/plan"))


# --- nw_gear info -----------------------------------------------------------------------------------------------------


def test_info_has_the_keys_of_the_contract(tmp_path, capsys):
    assert cli.main(["info", "--json", str(write(tmp_path / "run", mixed()))]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["duration"] == pytest.approx(0.39)
    assert found["complete"] is True
    assert found["topics"][WAVEFORM] == {"type": TABLE, "count": 40}
    assert found["provenance"]["nw_gear.run"]["command_line"] == "made by a test"


def test_info_says_that_a_recording_is_damaged_and_what_is_left(tmp_path, capsys):
    folder = truncated(tmp_path)
    assert cli.main(["info", "--json", str(folder)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["complete"] is False
    assert found["topics"][WAVEFORM]["count"] == 3
    assert "it ends before its index" in found["damage"]
    assert cli.main(["info", str(folder)]) == 0
    assert "damaged: " in capsys.readouterr().out


def test_info_of_a_wind_file(tmp_path, capsys):
    path = tmp_path / "wind.csv"
    path.write_text("time,wind_speed\n2020-01-01T00:00:00,4\n2020-01-01T00:00:01,\n2020-01-01T00:00:02,8\n")
    assert cli.main(["info", "--json", str(path)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["rows"], found["mean"], found["rate_hz"]) == (2, 6.0, 1.0)
    assert found["gaps"] == [{"start": "2020-01-01T00:00:00", "seconds": 2.0}]


@pytest.mark.parametrize("make", [nothing, empty_folder, other_file, sqlite_bag], ids=lambda make: make.__name__)
def test_info_refuses_in_one_line(tmp_path, capsys, make):
    assert cli.main(["info", str(make(tmp_path))]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1


@pytest.mark.parametrize("row", ["sample", "a", ""])
def test_tables_are_serialised_as_ros_does_it(row):
    data = np.random.default_rng(2).normal(size=(7, 3))
    for columns in (("a", "b", "c"), ("time", "x_mesh", "long_name_of_a_column")):
        one = Table(row, columns, data)
        assert len(from_table(one)) == len(serialize_message(to_message(one)))  # what fills gaps may differ
        back = from_message(deserialize_message(from_table(one), Float64MultiArray), "here")
        assert (back.row, back.columns) == (row, columns)
        assert np.array_equal(back.data, data)
