"""Repair: whatever is intact comes out, nothing else, wherever the file was cut; nothing is lost on the way."""

import fcntl
import json
import resource

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader

from nw_gear_common import cli
from nw_gear_common.errors import InputError, NwGearError
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.records.recover import recover
from test.monitor.recordings import mixed, start, write
from test.node.reader import node_reader

MESSAGES = mixed(30)
CHUNK = 10
"""Messages of a chunk."""


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """Bytes of a file whose process was killed after ten messages too many for the last flush."""
    writer, numbers = start(tmp_path_factory.mktemp("killed") / "run", MESSAGES)
    writer.add_metadata("nw_gear.run", {"command_line": "made by a test"})
    for i, message in enumerate(MESSAGES):
        writer.write(numbers[message.topic], message.data, message.log_time, message.log_time, i)
        if i % CHUNK == CHUNK - 1 and i < len(MESSAGES) - CHUNK:
            writer.flush()
    data = writer.path.read_bytes()
    writer.close()
    return data


def as_folder(folder, data):
    folder.mkdir()
    (folder / "run_0.mcap").write_bytes(data)
    return folder


def contents(folder):
    with Recording.open(folder) as recording:
        return [message.data for message in recording.raw()]


def test_in_place_all_readers_open_it_and_the_damaged_file_stays(tmp_path, killed):
    folder = as_folder(tmp_path / "run", killed)
    done = recover(folder)
    kept = len(MESSAGES) - CHUNK
    assert [(f.file, f.messages, f.lost_bytes, f.kept_as) for f in done.files] == [
        ("run_0.mcap", kept, 0, "run_0.mcap.damaged")
    ]
    assert sorted(p.name for p in folder.iterdir()) == ["metadata.yaml", "run_0.mcap", "run_0.mcap.damaged"]
    assert (folder / "run_0.mcap.damaged").read_bytes() == killed
    assert "damaged" not in (folder / "metadata.yaml").read_text()
    assert contents(folder) == [m.data for m in MESSAGES[:kept]]
    with Recording.open(folder) as recording:
        assert recording.complete
        assert recording.provenance["nw_gear.run"] == {"command_line": "made by a test"}
        assert recording.provenance["nw_gear.recovered"]["messages"] == str(kept)
        assert recording.qos("/chatter")[0].durability == "transient_local"
    with Reader(folder) as reader:
        assert [bytes(data) for _c, _t, data in reader.messages()] == [m.data for m in MESSAGES[:kept]]
        assert all(connection.digest.startswith("RIHS01_") for connection in reader.connections)
    with AnyReader([folder]) as reader:
        assert len([reader.deserialize(data, c.msgtype) for c, _t, data in reader.messages()]) == kept
    found = node_reader(folder / "run_0.mcap")
    assert sum(topic["count"] for topic in found["topics"].values()) == kept


def test_a_healthy_recording_is_left_alone(tmp_path):
    folder = write(tmp_path / "run", MESSAGES)
    before = {p.name: (p.stat().st_mtime_ns, p.read_bytes()) for p in folder.iterdir()}
    assert recover(folder).healthy
    assert recover(folder, tmp_path / "new").healthy
    assert {p.name: (p.stat().st_mtime_ns, p.read_bytes()) for p in folder.iterdir()} == before
    assert [p.name for p in tmp_path.iterdir()] == ["run"]


def test_into_a_new_folder_the_damaged_one_stays_as_it_is(tmp_path, killed):
    folder = as_folder(tmp_path / "run", killed)
    recover(folder, tmp_path / "new")
    assert [p.name for p in folder.iterdir()] == ["run_0.mcap"]
    assert (folder / "run_0.mcap").read_bytes() == killed
    assert contents(tmp_path / "new") == [m.data for m in MESSAGES[:-CHUNK]]


def test_a_missing_or_stale_metadata_file_is_written_anew(tmp_path):
    folder = write(tmp_path / "run", MESSAGES)
    text = (folder / "metadata.yaml").read_text()
    before = (folder / "run_0.mcap").read_bytes()
    for wrong in (None, "", "rosbag2_bagfile_information: {}", text.replace("message_count: 150", "message_count: 4")):
        (folder / "metadata.yaml").unlink()
        if wrong is not None:
            (folder / "metadata.yaml").write_text(wrong)
        done = recover(folder)
        assert (done.files, done.metadata_rebuilt) == ((), True)
        assert (folder / "metadata.yaml").read_text() == text
    assert (folder / "run_0.mcap").read_bytes() == before


@given(st.data())
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_wherever_it_is_cut_whole_chunks_come_out(tmp_path_factory, killed, data):
    length = data.draw(st.integers(0, len(killed) - 1))
    folder = as_folder(tmp_path_factory.mktemp("cut") / "run", killed[:length])
    rescued = recover(folder).files[0]
    found = contents(folder)
    assert rescued.messages == len(found)
    assert len(found) % CHUNK == 0
    assert found == [m.data for m in MESSAGES[: len(found)]]
    whole = sum(length >= end for end in chunk_ends(killed))
    assert len(found) == whole * CHUNK


def chunk_ends(data):
    """Where the chunks end, by walking over opcode and length of every record."""
    at, ends = 8, []
    while at + 9 <= len(data):
        opcode, length = data[at], int.from_bytes(data[at + 1 : at + 9], "little")
        at += 9 + length
        if opcode == 0x06:
            ends.append(at)
    return ends


@given(st.data())
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_flipped_bit_never_changes_a_message(tmp_path_factory, data):
    """Chunks carry checksums: what comes out is what went in, in order, or it is missing."""
    folder = write(tmp_path_factory.mktemp("bits") / "run", MESSAGES, flush_every=CHUNK)
    path = folder / "run_0.mcap"
    whole = bytearray(path.read_bytes())
    last = max(chunk_ends(bytes(whole)))
    position = data.draw(st.integers(8, last - 1))
    whole[position] ^= 1 << data.draw(st.integers(0, 7))
    path.write_bytes(whole)
    try:
        recover(folder)
    except InputError:
        return
    found = iter(m.data for m in MESSAGES)
    assert all(any(message == original for original in found) for message in contents(folder))


def test_one_damaged_chunk_costs_only_itself(tmp_path):
    folder = write(tmp_path / "run", MESSAGES, flush_every=CHUNK)
    path = folder / "run_0.mcap"
    whole = bytearray(path.read_bytes())
    whole[chunk_ends(bytes(whole))[4] - 3] ^= 0xFF
    path.write_bytes(whole)
    with pytest.raises(InputError, match="nw_gear recover"):
        contents(folder)
    rescued = recover(folder).files[0]
    assert rescued.reason == "1 chunk is damaged"
    assert contents(folder) == [m.data for m in MESSAGES[: 4 * CHUNK] + MESSAGES[5 * CHUNK :]]


def test_reading_with_repair_goes_through_a_copy_and_says_so(tmp_path, killed):
    folder = as_folder(tmp_path / "run", killed)
    with Recording.open(folder, repair=True) as recording:
        assert not recording.complete
        assert "metadata.yaml is missing" in recording.damage
        assert f"{len(MESSAGES) - CHUNK} messages recovered" in recording.damage
        assert [m.data for m in recording.raw()] == [m.data for m in MESSAGES[:-CHUNK]]
    assert [p.name for p in folder.iterdir()] == ["run_0.mcap"]
    assert (folder / "run_0.mcap").read_bytes() == killed


def test_a_second_damaged_file_gets_a_name_of_its_own(tmp_path, killed):
    folder = as_folder(tmp_path / "run", killed)
    recover(folder)
    (folder / "run_0.mcap").write_bytes(killed)
    assert recover(folder).files[0].kept_as == "run_0.1.mcap.damaged"


def test_a_recording_that_is_being_written_is_refused(tmp_path, killed):
    folder = as_folder(tmp_path / "run", killed)
    with (folder / "run_0.mcap").open("rb+") as stream:
        fcntl.flock(stream, fcntl.LOCK_EX)
        with pytest.raises(InputError, match="one that is being written"):
            recover(folder)
    assert recover(folder).files


def test_a_recording_in_several_files_is_repaired_and_read_as_one(tmp_path, killed):
    """As rosbag2 splits them, numbered; the second of eleven is damaged."""
    folder = tmp_path / "run"
    folder.mkdir()
    for number in range(11):
        part = write(tmp_path / f"part{number}", MESSAGES[number * 5 : number * 5 + 5]) / f"part{number}_0.mcap"
        part.rename(folder / f"run_{number}.mcap")
    (folder / "run_1.mcap").write_bytes(killed)
    done = recover(folder)
    assert [f.file for f in done.files] == ["run_1.mcap"]
    wanted = MESSAGES[:5] + MESSAGES[:-CHUNK] + MESSAGES[10:55]
    assert contents(folder) == [m.data for m in wanted]
    with Reader(folder) as reader:
        assert reader.message_count == len(wanted)
    with Recording.open(folder) as recording:
        assert recording.message_count == len(wanted)
        assert recording.topics["/plan"].messages == sum(m.topic == "/plan" for m in wanted)


def test_an_existing_output_is_refused(tmp_path, killed):
    folder = as_folder(tmp_path / "run", killed)
    with pytest.raises(InputError, match="a new folder, got one that exists"):
        recover(folder, tmp_path)


@pytest.mark.parametrize("output", [None, "new"])
def test_without_space_nothing_half_written_is_left(tmp_path, killed, output):
    folder = as_folder(tmp_path / "run", killed)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, limits[1]))
    try:
        with pytest.raises(NwGearError, match="can't be written"):
            recover(folder, tmp_path / output if output else None)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert [p.name for p in folder.iterdir()] == ["run_0.mcap"]
    assert (folder / "run_0.mcap").read_bytes() == killed
    assert [p.name for p in tmp_path.iterdir()] == ["run"]


def test_the_command_says_what_it_did(tmp_path, killed, capsys):
    folder = as_folder(tmp_path / "run", killed)
    assert cli.main(["recover", "--json", str(folder), "-o", str(tmp_path / "new")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["healthy"], found["recording"]) == (False, str(tmp_path / "new"))
    assert found["files"][0]["messages"] == len(MESSAGES) - CHUNK
    assert cli.main(["recover", str(folder)]) == 0
    assert f"{len(MESSAGES) - CHUNK} messages recovered" in capsys.readouterr().out
    assert cli.main(["recover", str(folder)]) == 0
    assert "nothing to repair" in capsys.readouterr().out
    assert cli.main(["recover", str(tmp_path / "nothing")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
