"""Recordings read chunk by chunk: the same as message by message, whatever compression, order and form they have."""

from types import SimpleNamespace

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Table
from nw_gear_monitor.records import chunks
from nw_gear_monitor.records.bulk import BulkReader
from nw_gear_monitor.records.metadata import TopicEntry
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.records.stamped import JOINTS, form_of, rows
from nw_gear_monitor.records.writer import RecordingWriter
from test.monitor import recorded, synthetic


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bulk") / "recording"
    recorded.write(folder, synthetic.stream(2))
    return folder


def test_every_message_comes_once_and_in_order(folder):
    with Recording.open(folder) as recording, BulkReader(recording) as reader:
        expected = [(m.topic, m.log_time) for m in recording.raw()]
        found = []
        for batch in reader.batches(set(recording.topics)):
            numbers = batch.of(*recording.topics).tolist()
            found += [(batch.topic(n), round(1e9 * batch.log_time(n))) for n in numbers]
    assert [topic for topic, _ in found] == [topic for topic, _ in expected]
    assert np.allclose([t for _, t in found], [t for _, t in expected], atol=10)


def test_values_are_those_of_the_reader(folder):
    with Recording.open(folder) as recording, BulkReader(recording) as reader:
        expected = list(recording.read())
        found = [b.value(n) for b in reader.batches(set(recording.topics)) for n in b.of(*recording.topics).tolist()]
    assert len(found) == len(expected)
    for value, entry in zip(found, expected, strict=True):
        if isinstance(value, Table):
            assert value.columns == entry.value.columns
            assert value.data.tobytes() == entry.value.data.tobytes()
        else:
            assert repr(value) == repr(entry.value)


def test_a_chunk_can_be_read_again(folder):
    topic = f"{names.NAMESPACE}/waveform"
    with Recording.open(folder) as recording, BulkReader(recording) as reader:
        batches = list(reader.batches([topic]))
        assert len(batches) > 1
        for batch in reversed(batches):
            again = reader.again(batch.place)
            first = [batch.value(n).data for n in batch.of(topic).tolist()]
            second = [again.value(n).data for n in again.of(topic).tolist()]
            assert np.array_equal(np.concatenate(first), np.concatenate(second))


@pytest.mark.parametrize("compression", ["lz4", "none"])
def test_other_compressions_are_read(tmp_path, compression):
    definition, _hash = recorded.typestore().generate_msgdef(recorded.TABLE, ros_version=2)
    writer = RecordingWriter(tmp_path / "recording", compression)
    number = writer.add_topic(TopicEntry("/t", recorded.TABLE), definition)
    tables = [synthetic.waveform(0.05 * k) for k in range(40)]
    for k, table in enumerate(tables):
        data = recorded.typestore().serialize_cdr(recorded.table_message(table), recorded.TABLE)
        writer.write(number, bytes(data), k, k)
    writer.close()
    with Recording.open(tmp_path / "recording") as recording, BulkReader(recording) as reader:
        found = [b.value(n).data for b in reader.batches(["/t"]) for n in b.of("/t").tolist()]
    assert np.array_equal(np.concatenate(found), np.concatenate([t.data for t in tables]))


def test_a_flipped_bit_is_found_by_the_checksum(folder, tmp_path):
    file = next(folder.glob("*.mcap"))
    with Recording.open(folder) as recording:
        place = recording.files[0].summary.chunk_indexes[1]
    data = bytearray(file.read_bytes())
    data[place.chunk_start_offset + place.chunk_length // 2] ^= 4
    broken = tmp_path / "broken.mcap"
    broken.write_bytes(data)
    refused = pytest.raises(InputError, match="nw_gear recover")
    with Recording.open(broken) as recording, BulkReader(recording) as reader, refused:
        list(reader.batches(set(recording.topics)))


def test_a_record_that_is_cut_is_refused():
    good = bytes([5]) + (30).to_bytes(8, "little") + bytes(30)
    assert len(chunks.index(np.frombuffer(good * 3, dtype=np.uint8)).channel) == 3
    for wrong in (good[:-1], good + b"\x05\x00", bytes([5]) + (5).to_bytes(8, "little") + bytes(5)):
        with pytest.raises(ValueError, match="cut"):
            chunks.index(np.frombuffer(wrong, dtype=np.uint8))


def joints(time, labels, numbers, parts=3):
    header = SimpleNamespace(stamp=SimpleNamespace(sec=int(time), nanosec=500), frame_id="gear")
    filled = [list(numbers + k) if k < parts else [] for k in range(3)]
    message = SimpleNamespace(header=header, name=labels, position=filled[0], velocity=filled[1], effort=filled[2])
    return bytes(recorded.typestore().serialize_cdr(recorded.message(JOINTS, message), JOINTS))


def batch_of(messages):
    ends = np.cumsum([len(m) for m in messages])
    zero = np.zeros(len(messages), dtype=np.int64)
    return chunks.Batch(np.frombuffer(b"".join(messages), dtype=np.uint8), zero, np.append(0, ends[:-1]), ends, zero)


def test_messages_of_changing_form_are_read_each_in_its_own():
    numbers = np.random.default_rng(3).normal(size=(7, 4))
    forms = [("abcd", 3), ("abcd", 3), ("abce", 3), ("abcd", 3), ("abc", 3), ("abcd", 1), ("abcd", 3)]
    messages = [joints(k, list(labels), numbers[k, : len(labels)], parts) for k, (labels, parts) in enumerate(forms)]
    found = [r for _form, r in rows(batch_of(messages), np.arange(len(messages)), JOINTS, "/joints")]
    assert [len(r.time) for r in found] == [2, 1, 1, 1, 1, 1]
    assert np.concatenate([r.time for r in found]).tolist() == [k + 1e-9 * 500 for k in range(7)]
    everyone = [(r.names, row) for r in found for row in r.values]
    for (labels, parts), (its, row), expected in zip(forms, everyone, numbers, strict=True):
        assert its == tuple(labels)
        for k in range(3):
            wanted = expected[: len(labels)] + k if k < parts else np.full(len(labels), np.nan)
            assert np.array_equal(row[k], wanted, equal_nan=True)


def test_a_message_of_another_type_is_refused():
    with pytest.raises(InputError, match="a serialised sensor_msgs"):
        list(rows(batch_of([b"\x00\x01\x00\x00" + bytes(range(40))]), np.arange(1), JOINTS, "/joints"))
    with pytest.raises(KeyError):
        form_of(b"\x07\x07\x00\x00" + bytes(60), JOINTS)
