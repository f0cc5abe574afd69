"""Recordings in several files: none too large or too long, each whole in itself, all of them one recording."""

import itertools
import os
import shutil
import struct

import pytest
import yaml
from rclpy.serialization import serialize_message
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
from std_msgs.msg import String

from nw_gear_common import cli
from nw_gear_monitor.records.definitions import define
from nw_gear_monitor.records.metadata import TopicEntry
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.records.recover import recover
from nw_gear_monitor.records.writer import Limits, RecordingWriter
from test.monitor.recordings import START, mixed
from test.node.reader import node_reader

STRING = "std_msgs/msg/String"
SIZE = 60_000
MESSAGES = mixed(160)


def begin(folder, limits, topics=("/a",), compression="none", fsync=False):
    writer = RecordingWriter(folder, compression, limits, fsync)
    definition = define(STRING)
    entries = [TopicEntry(topic, STRING, definition.type_hash) for topic in topics]
    return writer, {entry.name: writer.add_topic(entry, definition.text) for entry in entries}


def words(folder, times, limits):
    """A recording of one short text at each log time (s)."""
    writer, numbers = begin(folder, limits)
    for k, time in enumerate(times):
        writer.write(numbers["/a"], serialize_message(String(data=str(k))), round(1e9 * time), 0)
    writer.close()
    return folder


def by_size(folder, close=True):
    writer = RecordingWriter(folder, "none", Limits(size=SIZE))
    writer.add_metadata("nw_gear.run", {"command_line": "made by a test"})
    numbers = {}
    for message in MESSAGES:
        if message.topic not in numbers:
            definition = define(message.kind)
            entry = TopicEntry(message.topic, message.kind, definition.type_hash)
            numbers[message.topic] = writer.add_topic(entry, definition.text)
        writer.write(numbers[message.topic], message.data, message.log_time, message.log_time)
    if close:
        writer.close()
    return writer


def index_at(path):
    """Where the index of a file begins."""
    return struct.unpack_from("<Q", path.read_bytes()[-28:])[0]


def files(folder):
    return sorted(folder.glob("*.mcap"), key=lambda path: int(path.stem.rpartition("_")[2]))


def test_no_file_is_larger_and_all_are_one_recording(tmp_path):
    folder = tmp_path / "run"
    writer = by_size(folder)
    found = files(folder)
    assert [path.name for path in found] == [f"run_{k}.mcap" for k in range(writer.files)]
    assert len(found) > 3
    largest = max(len(message.data) for message in MESSAGES)
    heads = 500  # of the file, of a chunk and of the message indexes behind it
    sizes = [index_at(path) for path in found]
    assert max(sizes) < SIZE + heads
    assert min(sizes[:-1]) > SIZE - largest - heads
    with Recording.open(folder) as recording:
        assert [m.data for m in recording.raw()] == [m.data for m in MESSAGES]
        assert recording.message_count == len(MESSAGES)
        assert recording.provenance["nw_gear.run"] == {"command_line": "made by a test"}
    with Reader(folder) as reader:
        assert [bytes(data) for _c, _t, data in reader.messages()] == [m.data for m in MESSAGES]
    with AnyReader([folder]) as reader:
        assert {c.topic: c.msgcount for c in reader.connections} == {m.topic: 160 for m in MESSAGES}
    with Recording.open(found[1]) as recording:
        counts = {name: topic["count"] for name, topic in node_reader(found[1])["topics"].items()}
        assert counts == {name: topic.messages for name, topic in recording.topics.items()}


def test_every_file_can_be_opened_by_itself(tmp_path):
    by_size(tmp_path / "run")
    read = []
    for path in files(tmp_path / "run"):
        with Recording.open(path) as recording:
            assert set(recording.topics) == {m.topic for m in MESSAGES}
            assert recording.provenance["nw_gear.run"] == {"command_line": "made by a test"}
            read += [m.data for m in recording.raw()]
    assert read == [m.data for m in MESSAGES]


def test_metadata_lists_the_files_as_rosbag2_does(tmp_path):
    writer = by_size(tmp_path / "run")
    information = yaml.safe_load((tmp_path / "run" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert information["relative_file_paths"] == [f"run_{k}.mcap" for k in range(writer.files)]
    assert sum(file["message_count"] for file in information["files"]) == information["message_count"] == len(MESSAGES)
    starts = [file["starting_time"]["nanoseconds_since_epoch"] for file in information["files"]]
    assert starts[0] == information["starting_time"]["nanoseconds_since_epoch"] == START
    assert starts == sorted(starts)


def test_by_duration_and_a_clock_that_jumps_back(tmp_path):
    times = [0.0, 0.5, 1.9, 2.0, 3.9, 100.0, 1.0, 2.5, 3.1]
    folder = words(tmp_path / "run", times, Limits(duration=2_000_000_000))
    spans = []
    for path in files(folder):
        with Recording.open(path) as recording:
            spans.append([m.log_time / 1e9 for m in recording.raw()])
    assert spans == [[0.0, 0.5, 1.9], [2.0, 3.9], [100.0, 1.0, 2.5], [3.1]]


def test_a_message_that_is_too_large_gets_a_file_of_its_own(tmp_path):
    writer, numbers = begin(tmp_path / "run", Limits(size=2000))
    for length in (10, 5000, 10):
        writer.write(numbers["/a"], serialize_message(String(data="x" * length)), 0, 0)
    writer.close()
    assert writer.files == 3


def test_without_limits_there_is_one_file(tmp_path):
    assert len(files(words(tmp_path / "run", range(0, 10_000, 100), Limits()))) == 1


def test_a_split_recording_that_was_killed_is_repaired(tmp_path, capsys):
    writer = by_size(tmp_path / "run", close=False)
    writer.flush()
    shutil.copytree(tmp_path / "run", tmp_path / "killed")
    writer.close()
    (tmp_path / "killed" / f"run_{writer.files}.mcap").touch()  # begun at the moment of its death
    done = recover(tmp_path / "killed")
    assert [file.file for file in done.files] == [f"run_{writer.files - 1}.mcap", f"run_{writer.files}.mcap"]
    with Recording.open(tmp_path / "killed") as recording:
        assert [m.data for m in recording.raw()] == [m.data for m in MESSAGES]
    assert cli.main(["info", str(tmp_path / "killed")]) == 0
    assert f"messages   {len(MESSAGES)}" in capsys.readouterr().out


@pytest.mark.parametrize("wanted", [True, False])
def test_fsync_reaches_the_disk_with_every_flush(tmp_path, monkeypatch, wanted):
    synced = []

    def sync(handle):
        synced.append((os.readlink(f"/proc/self/fd/{handle}"), os.fstat(handle).st_size))

    monkeypatch.setattr(os, "fsync", sync)
    writer, numbers = begin(tmp_path / "run", Limits(), fsync=wanted)
    for _ in range(3):
        writer.write(numbers["/a"], serialize_message(String(data="x" * 1000)), 0, 0)
        writer.flush()
    path = str(writer.path)
    sizes = [at for name, at in synced if name == path]
    assert len(sizes) == 3 * wanted
    assert all(after > before + 1000 for before, after in itertools.pairwise([0, *sizes]))
    writer.close()
    names = {os.path.basename(name).partition(".yaml")[0] for name, _size in synced}
    assert names == ({"run", "run_0.mcap", ".metadata"} if wanted else set())
