"""Recordings that lie or are broken: one clear line or what is left of them, bounded memory, nothing outside them."""

import io
import shutil
import sys
import tracemalloc
from contextlib import contextmanager, redirect_stdout

import lz4.frame
import numpy as np
import pytest
import zstandard
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from nw_gear_common import cli
from nw_gear_common.errors import InputError, NwGearError
from nw_gear_monitor.nodes.ears import message_class
from nw_gear_monitor.records import unpacking
from nw_gear_monitor.records.bulk import BulkReader
from nw_gear_monitor.records.command_info import info
from nw_gear_monitor.records.playable import checked, obstacle
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.records.recover import recover
from test.monitor import bad_recordings as bad
from test.monitor.recordings import mixed, write

MOST_MEMORY = 40_000_000
"""Bytes; the files are some kilobytes long."""
BEYOND = unpacking.LARGEST + 1
"""Zeros, so many that a chunk of them isn't unpacked."""
relaxed = {"deadline": None, "suppress_health_check": list(HealthCheck)}


def show(path):
    with redirect_stdout(io.StringIO()) as text:
        info(path, as_json=False)
    assert text.getvalue().startswith("recording ")


def replay(path):
    """What the replay does with a recording, but for the publishing."""
    with Recording.open(path) as recording:
        topics = [topic for topic in recording.topics if not obstacle(recording, topic)]
        for _message in checked(recording.raw(topics), str(path)):
            pass


def review(path):
    """What the report does with a recording: decode everything, fast and message by message."""
    with Recording.open(path, repair=True) as recording, BulkReader(recording) as reader:
        for batch in reader.batches(set(recording.topics)):
            for number in batch.of(*recording.topics).tolist():
                batch.value(number)
        for _entry in recording.messages():
            pass


def mend(path):
    if path.is_dir():
        recover(path)
        with Recording.open(path) as recording:
            assert recording.complete


def survive(path, *commands):
    """Whatever is done with a recording, it is done, or refused in one line; returns what was said."""
    said = []
    for command in commands or (show, replay, review, mend):
        try:
            command(path)
        except NwGearError as error:
            said.append(str(error))
    assert all("\n" not in words and len(words) < 1000 for words in said), said
    return said


@contextmanager
def bounded():
    """Bounds the memory that may be taken meanwhile."""
    tracemalloc.start()
    yield
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < MOST_MEMORY


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """A recording in chunks of some messages, some twenty kilobytes long."""
    return write(tmp_path_factory.mktemp("sound") / "run", mixed(6), "none", flush_every=5)


def copy(sound, tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("bad") / "run"
    shutil.copytree(sound, folder)
    (folder / "run_0.mcap").write_bytes(data)
    return folder


def test_the_sound_one_is_read_by_all(sound):
    assert survive(sound) == []


def test_cut_at_every_thousandth_byte(sound, tmp_path_factory):
    whole = (sound / "run_0.mcap").read_bytes()
    assert len(whole) > 15_000
    for length in range(0, len(whole), 1000):
        folder = copy(sound, tmp_path_factory, whole[:length])
        said = survive(folder, show, replay, mend)
        assert len(said) == 1, said  # the replay refuses it, everybody else reads what is left
        assert "nw_gear recover" in said[0]
        shutil.rmtree(folder.parent)


def flip_bits(sound, tmp_path_factory, data):
    whole = bytearray((sound / "run_0.mcap").read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        near_the_end = data.draw(st.booleans())  # where the index is
        at = data.draw(st.integers(len(whole) - 4000 if near_the_end else 0, len(whole) - 1))
        whole[at] ^= 1 << data.draw(st.integers(0, 7))
    folder = copy(sound, tmp_path_factory, bytes(whole))
    survive(folder)
    shutil.rmtree(folder.parent)


def lie_about_a_length(sound, tmp_path_factory, data):
    """Any eight bytes become a large number: lengths of records, offsets, counts, times."""
    whole = bytearray((sound / "run_0.mcap").read_bytes())
    at = data.draw(st.integers(0, len(whole) - 9))
    value = data.draw(st.sampled_from((2**31, 2**32 - 1, bad.MANY, 2**62, 2**63, 2**64 - 1)))
    whole[at : at + 8] = value.to_bytes(8, "little")
    folder = copy(sound, tmp_path_factory, bytes(whole))
    with bounded():
        survive(folder)
    shutil.rmtree(folder.parent)


@settings(max_examples=15, **relaxed)
@given(st.data())
def test_flipped_bits(sound, tmp_path_factory, data):
    flip_bits(sound, tmp_path_factory, data)


@settings(max_examples=6, **relaxed)
@given(st.data())
def test_lengths_that_lie(sound, tmp_path_factory, data):
    lie_about_a_length(sound, tmp_path_factory, data)


@pytest.mark.slow
@pytest.mark.parametrize("attempt", [flip_bits, lie_about_a_length])
@settings(max_examples=40, **relaxed)
@given(data=st.data())
def test_many_more(sound, tmp_path_factory, attempt, data):
    attempt(sound, tmp_path_factory, data)


# --- sizes that lie ---------------------------------------------------------------------------------------------------


def zeros(number):
    """So many zeros as zstd packs them: some kilobytes."""
    return zstandard.compress(bytes(number))


CLAIMS = {
    "ten gigabytes of zstd": lambda: bad.chunk(zstandard.compress(b"abc"), "zstd", bad.MANY),
    "ten gigabytes uncompressed": lambda: bad.chunk(b"abc", "", bad.MANY),
    "ten gigabytes of lz4": lambda: bad.chunk(lz4.frame.compress(b"abc"), "lz4", bad.MANY),
    "a bomb that owns up": lambda: bad.chunk(zeros(BEYOND), "zstd", BEYOND),
    "a bomb that claims to be small": lambda: bad.chunk(zeros(2**26), "zstd", 1000),
    "a bomb that doesn't tell its size": lambda: bad.chunk(bad.streamed(bytes(2**26)), "zstd", 1000),
    "a bomb of lz4": lambda: bad.chunk(lz4.frame.compress(bytes(2**26), store_size=False), "lz4", 1000),
    "another compression": lambda: bad.chunk(b"abc", "brotli", 3),
    "no zstd at all": lambda: bad.chunk(b"abc", "zstd", 3),
}


@pytest.mark.parametrize("claim", CLAIMS)
def test_what_a_chunk_claims_is_held_against_limits(tmp_path, claim):
    path = bad.write(tmp_path / "run.mcap", [CLAIMS[claim]()])
    with bounded():
        refused(tmp_path, path)


def refused(tmp_path, path):
    said = survive(path, replay, review)
    assert len(said) == 2
    assert all("nw_gear recover" in words for words in said)
    folder = tmp_path / "folder"
    folder.mkdir()
    path.rename(folder / "run_0.mcap")
    assert survive(folder, mend) == []  # without that chunk


def test_the_limit_leaves_room_for_large_messages():
    assert len(unpacking.decompress("zstd", zeros(2**26), 2**26)) == 2**26
    assert len(unpacking.decompress("lz4", lz4.frame.compress(bytes(2**24)), 2**24)) == 2**24


def test_an_index_that_names_a_chunk_many_times_is_refused(tmp_path):
    good = bad.honest([bad.message()])
    first = bad.write(tmp_path / "one.mcap", [good])
    assert survive(first, replay, review) == []
    start = first.read_bytes().index(bad.built(good))
    length = len(bad.built(good))
    for indexes in ([bad.index_of(start, length)] * 1000, [bad.index_of(start, bad.MANY)], [bad.index_of(0, length)]):
        path = bad.write(tmp_path / "many.mcap", [good], indexes=indexes)
        assert any("wrong places" in words for words in survive(path, replay))


def test_a_chunk_hidden_in_the_index_is_not_unpacked(tmp_path):
    hidden = bad.built(CLAIMS["a bomb that owns up"]())
    path = bad.write(tmp_path / "run.mcap", [bad.honest([bad.message()])], more=hidden)
    assert any("its index is damaged" in words for words in survive(path, replay))
    assert survive(path, show, review) == []  # through a repaired copy


def test_lengths_of_arrays_are_held_against_the_message(tmp_path):
    text = "Thing[] things\n" + "=" * 80 + "\nMSG: std_msgs/Thing\nuint8[16] id\n"
    data = b"\x00\x01\x00\x00\xff\xff\xff\xff"
    path = bad.write(tmp_path / "run.mcap", [bad.honest([bad.message(data)])], text=text)
    assert any("a serialised std_msgs" in words for words in survive(path, review))


# --- names and definitions that aren't what they seem -----------------------------------------------------------------

DEFINITIONS = {
    "recursive": "String self\n",
    "unknown inside": "other_msgs/Thing thing\n",
    "nonsense": "=== ( ) [",
    "a constant that takes for ever": f"uint8 {'A' * 60}a=1\nstring data\n",
}


@pytest.mark.parametrize("name", DEFINITIONS)
def test_definitions_that_make_no_sense(tmp_path, name):
    path = bad.write(tmp_path / "run.mcap", [bad.honest([bad.message()])], text=DEFINITIONS[name])
    said = survive(path, show, review)
    assert len(said) == 1
    assert "/words: expected" in said[0]


@pytest.mark.parametrize(
    "kind", ["this/msg/That", "os/system", "../../etc/passwd", "test.monitor/msg/X", "", "a/b/c/d"]
)
def test_the_type_of_a_topic_imports_nothing(tmp_path, kind):
    sys.modules.pop("this", None)
    with pytest.raises(InputError, match="a message type"):
        message_class(kind)
    assert "this" not in sys.modules
    path = bad.write(tmp_path / "run.mcap", [bad.honest([bad.message()])], kind=kind)
    survive(path, show, replay)


def test_names_in_a_recording_stay_on_their_line(tmp_path, capsys):
    record = bad.metadata_record({"command\x1b[2J": "one\r\x07two"})
    path = bad.write(tmp_path / "run.mcap", [bad.honest([bad.message()])], topic="/a\n\x1b[31mb", metadata=[record])
    assert cli.main(["info", str(path)]) == 0
    shown = capsys.readouterr().out
    assert "/a\\n\\x1b[31mb" in shown
    assert not set(shown) & set("\x1b\x07\r")
    with Recording.open(path) as recording, pytest.raises(InputError) as caught:
        list(recording.tables("/other"))
    assert str(caught.value).isprintable()


METADATA = {
    "a file elsewhere": ("../../x.mcap", "names of files in this folder"),
    "an absolute name": ("/etc/passwd", "names of files in this folder"),
    "up in the middle": ("run/../../x.mcap", "names of files in this folder"),
    "no name": ("", "names of files in this folder"),
    "a number": (7, "something else"),
    "a list": (["run_0.mcap"], "something else"),
}


@pytest.mark.parametrize("case", METADATA)
def test_files_outside_the_folder_are_refused(sound, tmp_path, case):
    name, words = METADATA[case]
    folder = shutil.copytree(sound, tmp_path / "inner" / "run")
    shutil.copy(sound / "run_0.mcap", tmp_path / "x.mcap")
    text = (folder / "metadata.yaml").read_text()
    (folder / "metadata.yaml").write_text(text.replace("- run_0.mcap", f"- {name!r}", 1))
    said = survive(folder, replay)
    assert words in said[0]
    before = (tmp_path / "x.mcap").read_bytes()
    survive(folder, mend, show)
    assert (tmp_path / "x.mcap").read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["inner", "x.mcap"]


BOMB = "a: &a [x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"{b}: &{b} [{','.join([f'*{a}'] * 9)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)
STRANGE = {
    "nothing": "",
    "a python object": "rosbag2_bagfile_information: !!python/object/apply:os.mkdir [made_by_yaml]\n",
    "many times everything": BOMB + "rosbag2_bagfile_information: {storage_identifier: *i, relative_file_paths: *i}",
    "very deep": "[" * 200_000 + "]" * 200_000,
    "a date that isn't one": "rosbag2_bagfile_information: 2001-99-99",
    "endless": "rosbag2_bagfile_information: {storage_identifier: mcap, message_count: .inf, relative_file_paths: []}",
    "long": "a" * (5 * 2**20),
    "binary": "\x00\x01\x02",
    "itself": "&a [*a]",
}  # fmt: skip


@pytest.mark.parametrize("case", STRANGE)
def test_metadata_files_that_make_no_sense(sound, tmp_path, monkeypatch, case):
    monkeypatch.chdir(tmp_path)
    folder = shutil.copytree(sound, tmp_path / "run")
    (folder / "metadata.yaml").write_text(STRANGE[case])
    said = survive(folder, replay)
    assert len(said) == 1
    assert "a rosbag2 metadata file" in said[0]
    assert survive(folder, mend, replay, show) == []  # repaired: written anew
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


@settings(max_examples=20, **relaxed)
@given(st.data())
def test_changed_metadata(sound, tmp_path_factory, data):
    text = (sound / "metadata.yaml").read_text()
    folder = copy(sound, tmp_path_factory, (sound / "run_0.mcap").read_bytes())
    at = data.draw(st.integers(0, min(len(text), 900)))
    piece = data.draw(st.text(alphabet="ab:-[]{}&*!'\"\n #|>%@,0", max_size=6))
    (folder / "metadata.yaml").write_text(text[:at] + piece + text[at + data.draw(st.integers(0, 6)) :])
    survive(folder, show, replay, mend)
    shutil.rmtree(folder.parent)


def test_messages_that_cannot_be_published_are_refused(tmp_path):
    for data, time, words in (
        (b"", 0, "a serialised message"),
        (bad.WORD, 2**63, "before 2038"),
        (b"PK34", 0, "a ser"),
    ):
        path = bad.write(tmp_path / "run.mcap", [bad.honest([bad.message(data, time)])])
        assert any(words in line for line in survive(path, replay))


def test_random_bytes_are_no_recording(tmp_path):
    random = np.random.default_rng(4)
    for length in (1, 7, 8, 40, 3000):
        path = tmp_path / "run.mcap"
        path.write_bytes(random.bytes(length))
        assert all("expected an MCAP file, got another kind of file" in words for words in survive(path, show, replay))
        path.write_bytes(bad.MAGIC + random.bytes(length))
        survive(path, show, replay, review)
