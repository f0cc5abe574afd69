"""One MCAP file that is being written: chunked, indexed, compressed, locked while it grows."""

from __future__ import annotations

import contextlib
import fcntl
import os
from dataclasses import dataclass
from pathlib import Path

from mcap.writer import CompressionType, IndexType, Writer

from nw_gear_common import __version__
from nw_gear_monitor.records.metadata import FileEntry, TopicEntry
from nw_gear_monitor.records.qos import to_yaml
from nw_gear_monitor.records.schema import HASH_KEY, MESSAGE_ENCODING, PROFILE, QOS_KEY, SCHEMA_ENCODING

COMPRESSIONS = {"zstd": CompressionType.ZSTD, "lz4": CompressionType.LZ4, "none": CompressionType.NONE}

LIBRARY = f"nw_gear {__version__}"
CHUNK_SIZE = 1024 * 1024
RECORD_BYTES = 50
"""What a schema or a channel takes at most besides its texts."""

MESSAGE_BYTES = 31 + 16
"""What a message takes besides its content: head of the record, and its entry in the message index."""


@dataclass
class Count:
    """Messages, and the first and the last log time among them (ns)."""

    messages: int = 0
    first: int = 0
    last: int = 0

    def add(self, log_time: int) -> None:
        """Count a message."""
        self.first = min(self.first, log_time) if self.messages else log_time
        self.last = max(self.last, log_time) if self.messages else log_time
        self.messages += 1


class McapWriter:
    """The MCAP file inside a recording.

    Args:
        path: new file.
        compression: zstd, lz4 or none.
    """

    def __init__(self, path: Path, compression: str) -> None:
        self.path = path
        self.count = Count()
        self._schemas: dict[tuple[str, str, bytes], int] = {}
        self._waiting = 0  # bytes of the chunk in progress, uncompressed
        self._at = 0
        self._stream = path.open("xb")
        with contextlib.suppress(OSError):  # some network file systems know no locks
            fcntl.flock(self._stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        self._writer = Writer(
            self._stream,
            chunk_size=CHUNK_SIZE,
            compression=COMPRESSIONS[compression],
            index_types=IndexType.ALL,
        )
        self._writer.start(PROFILE, LIBRARY)
        self.flush()

    def add_topic(self, topic: TopicEntry, definition: str) -> int:
        """Register a schema, where it is new, and a channel."""
        details = {QOS_KEY: to_yaml(topic.qos), HASH_KEY: topic.type_hash}
        schema = self.add_schema(topic.type, SCHEMA_ENCODING, definition.encode())
        return self.add_channel(topic.name, MESSAGE_ENCODING, schema, details)

    def add_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Register a schema; the same one again gets the same number."""
        key = (name, encoding, data)
        if key not in self._schemas:
            self._schemas[key] = self._writer.register_schema(name, encoding, data)
            self._waiting += len(data) + len(name) + RECORD_BYTES
        return self._schemas[key]

    def add_channel(self, topic: str, encoding: str, schema: int, details: dict[str, str]) -> int:
        """Register a channel."""
        self._waiting += sum(len(text) for pair in details.items() for text in pair) + len(topic) + RECORD_BYTES
        return self._writer.register_channel(topic, encoding, schema, details)

    def write(self, channel: int, data: bytes, log_time: int, publish_time: int, sequence: int = 0) -> None:
        """Add one message to the chunk in progress."""
        self._writer.add_message(channel, log_time, data, publish_time, sequence)
        self.count.add(log_time)
        at = self._stream.tell()
        self._waiting = 0 if at != self._at else self._waiting + len(data) + MESSAGE_BYTES
        self._at = at

    def add_metadata(self, name: str, content: dict[str, str]) -> None:
        """Write a metadata record."""
        self._writer.add_metadata(name, content)
        self._at = self._stream.tell()

    def flush(self, fsync: bool = False) -> None:
        """Finish the chunk in progress and hand it to the operating system; with `fsync` to the disk."""
        self._writer.flush()  # type: ignore[no-untyped-call]
        self._waiting, self._at = 0, self._stream.tell()
        if fsync:
            os.fsync(self._stream.fileno())

    def position(self) -> int:
        """Bytes written so far, without the chunk in progress."""
        return self._stream.tell()

    def size_with(self, more: int) -> int:
        """Bytes that the file has at most, without its index, once a message of so many bytes is added."""
        return self._at + self._waiting + more + MESSAGE_BYTES

    def entry(self) -> FileEntry:
        """What `metadata.yaml` says about the file."""
        return FileEntry(self.path.name, self.count.first, self.count.last, self.count.messages)

    def close(self, fsync: bool = False) -> None:
        """Write the index and close the file; with `fsync` all of it is on the disk."""
        self._writer.finish()  # type: ignore[no-untyped-call]
        if fsync:
            self._stream.flush()
            os.fsync(self._stream.fileno())
        self._stream.close()

    def abandon(self) -> None:
        """Close the file without another attempt to write what is buffered."""
        with contextlib.suppress(OSError):
            self._stream.raw.close()
