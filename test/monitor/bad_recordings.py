"""MCAP files and folders that lie: made byte by byte, because no writer makes them."""

import struct
import zlib

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import Channel, Chunk, ChunkIndex, DataEnd, Header, Message, Metadata, Schema, Statistics

MAGIC = b"\x89MCAP0\r\n"
STRING = "std_msgs/msg/String"
WORD = b"\x00\x01\x00\x00\x03\x00\x00\x00hi\x00\x00"
MANY = 10 * 2**30
"""Bytes that nobody has: ten gigabytes."""


def built(*records):
    """Serialised records."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return builder.end()


def message(data=WORD, time=0, channel=1):
    """A message record."""
    return Message(channel_id=channel, sequence=0, log_time=time, publish_time=time, data=data)


def chunk(packed, compression, size, crc=0):
    """A chunk record that claims whatever it likes."""
    return Chunk(
        message_start_time=0,
        message_end_time=0,
        uncompressed_size=size,
        uncompressed_crc=crc,
        compression=compression,
        data=packed,
    )


def honest(records, compression="zstd"):
    """A chunk of some records as a writer makes it."""
    content = built(*records)
    packed = zstandard.compress(content) if compression == "zstd" else content
    return chunk(packed, compression, len(content), zlib.crc32(content))


def index_of(start, length, count=1):
    """An index entry of a chunk."""
    return ChunkIndex(
        message_start_time=0,
        message_end_time=0,
        chunk_start_offset=start,
        chunk_length=length,
        message_index_offsets={1: start},
        message_index_length=0,
        compression="",
        compressed_size=0,
        uncompressed_size=0,
    )


def write(path, chunks, *, text="string data\n", kind=STRING, topic="/words", indexes=None, metadata=(), more=b""):
    """An MCAP file with an index that fits, unless another is given; `more` stands in the index as well."""
    schema = Schema(id=1, name=kind, encoding="ros2msg", data=text.encode())
    channel = Channel(id=1, topic=topic, message_encoding="cdr", schema_id=1, metadata={})
    data = MAGIC + built(Header(profile="ros2", library="a test"), *metadata)
    entries = []
    for one in chunks:
        record = built(one)
        entries.append(index_of(len(data), len(record)))
        data += record
    data += built(DataEnd(0))
    statistics = Statistics(
        message_count=len(chunks), schema_count=1, channel_count=1, attachment_count=0, metadata_count=0,
        chunk_count=len(chunks), message_start_time=0, message_end_time=0, channel_message_counts={1: len(chunks)},
    )  # fmt: skip
    summary = built(schema, channel, statistics, *(entries if indexes is None else indexes)) + more
    footer = struct.pack("<BQQQI", 2, 20, len(data), 0, 0)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data + summary + footer + MAGIC)
    return path


def metadata_record(content):
    """A metadata record."""
    return Metadata(name="nw_gear.run", metadata=content)


def streamed(content):
    """zstd that doesn't say how large its content is."""
    compressor = zstandard.ZstdCompressor(write_content_size=False).compressobj()
    return compressor.compress(content) + compressor.flush()
