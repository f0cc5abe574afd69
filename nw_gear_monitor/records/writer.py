"""Writes a rosbag2 folder with one MCAP file: chunked, indexed, compressed, with a schema on every channel."""

from __future__ import annotations

import contextlib
import fcntl
from dataclasses import dataclass, replace
from pathlib import Path

from mcap.writer import CompressionType, IndexType, Writer

from nw_gear_common import __version__
from nw_gear_common.errors import InputError
from nw_gear_monitor.records import metadata
from nw_gear_monitor.records.metadata import FileEntry, Metadata, TopicEntry
from nw_gear_monitor.records.qos import to_yaml
from nw_gear_monitor.records.schema import HASH_KEY, MESSAGE_ENCODING, PROFILE, QOS_KEY, SCHEMA_ENCODING

COMPRESSIONS = {"zstd": CompressionType.ZSTD, "lz4": CompressionType.LZ4, "none": CompressionType.NONE}

LIBRARY = f"nw_gear {__version__}"
CHUNK_SIZE = 1024 * 1024


@dataclass
class _Count:
    messages: int = 0
    first: int = 0
    last: int = 0

    def add(self, log_time: int) -> None:
        self.first = min(self.first, log_time) if self.messages else log_time
        self.last = max(self.last, log_time) if self.messages else log_time
        self.messages += 1


class RecordingWriter:
    """A recording that is being written.

    The file is locked while it is open, so that nobody repairs a recording that is still growing. Until `close` the
    folder has no `metadata.yaml`; what was flushed can be recovered without one.

    Args:
        folder: new folder.
        compression: zstd, lz4 or none.
        file: name of the MCAP file (default: as rosbag2 names it).

    Raises:
        InputError: the folder exists, or can't be made.
    """

    def __init__(self, folder: Path, compression: str = "zstd", file: str = "") -> None:
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            raise InputError(str(folder), "a new folder", "one that exists") from None
        except OSError as error:
            raise InputError(str(folder), "a folder that can be made", error.strerror or str(error)) from None
        self.folder = folder
        self.path = folder / (file or f"{folder.resolve().name}_0.mcap")
        try:
            self._mcap = McapWriter(self.path, compression)
        except OSError as error:
            self.path.unlink(missing_ok=True)
            folder.rmdir()
            raise InputError(str(folder), "a folder that can be written to", error.strerror or str(error)) from None
        self._topics: dict[int, TopicEntry] = {}

    @property
    def messages(self) -> int:
        """Messages written."""
        return self._mcap.count.messages

    @property
    def size(self) -> int:
        """Bytes in the file so far, without the chunk in progress."""
        return self._mcap.position()

    def add_topic(self, topic: TopicEntry, definition: str) -> int:
        """Begin a topic and return the number under which its messages are written.

        Args:
            topic: name, type, hash and QoS.
            definition: text of the message definition with all that it depends on, separated as in rosbag2.
        """
        number = self._mcap.add_topic(topic, definition)
        self._topics[number] = topic
        return number

    def write(self, topic: int, data: bytes, log_time: int, publish_time: int, sequence: int = 0) -> None:
        """Write one message: CDR bytes, times in ns, running number given by its publisher (0 = unknown)."""
        self._mcap.write(topic, data, log_time, publish_time, sequence)

    def add_metadata(self, name: str, content: dict[str, str]) -> None:
        """Write a metadata record."""
        self._mcap.add_metadata(name, content)

    def flush(self) -> None:
        """Hand everything over to the operating system: a process that is killed afterwards loses none of it.

        Raises:
            OSError: it can't be written, or the file is no longer in its folder.
        """
        self._mcap.flush()
        self.path.stat()

    def close(self) -> None:
        """Finish the file and write `metadata.yaml`."""
        self._mcap.close()
        metadata.write(self.folder, Metadata((self._mcap.entry(),), self.entries()))

    def abandon(self) -> None:
        """Let go of a file that can't be written any more, as it is."""
        self._mcap.abandon()

    def entries(self) -> tuple[TopicEntry, ...]:
        """The topics with their counts."""
        return tuple(replace(topic, count=self._mcap.count_of(number)) for number, topic in self._topics.items())


class McapWriter:
    """The MCAP file inside a recording.

    Args:
        path: new file.
        compression: zstd, lz4 or none.
    """

    def __init__(self, path: Path, compression: str) -> None:
        self.path = path
        self.count = _Count()
        self._counts: dict[int, int] = {}
        self._schemas: dict[tuple[str, str, bytes], int] = {}
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
        self._stream.flush()

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
        return self._schemas[key]

    def add_channel(self, topic: str, encoding: str, schema: int, details: dict[str, str]) -> int:
        """Register a channel."""
        number = self._writer.register_channel(topic, encoding, schema, details)
        self._counts[number] = 0
        return number

    def write(self, channel: int, data: bytes, log_time: int, publish_time: int, sequence: int = 0) -> None:
        """Add one message to the chunk in progress."""
        self._writer.add_message(channel, log_time, data, publish_time, sequence)
        self._counts[channel] += 1
        self.count.add(log_time)

    def count_of(self, channel: int) -> int:
        """Messages of one channel."""
        return self._counts[channel]

    def add_metadata(self, name: str, content: dict[str, str]) -> None:
        """Write a metadata record."""
        self._writer.add_metadata(name, content)

    def flush(self) -> None:
        """Finish the chunk in progress and flush the stream."""
        self._writer.flush()  # type: ignore[no-untyped-call]

    def position(self) -> int:
        """Bytes written so far."""
        return self._stream.tell()

    def entry(self) -> FileEntry:
        """What `metadata.yaml` says about the file."""
        return FileEntry(self.path.name, self.count.first, self.count.last, self.count.messages)

    def close(self) -> None:
        """Write the index and close the file."""
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._stream.close()

    def abandon(self) -> None:
        """Close the file without another attempt to write what is buffered."""
        with contextlib.suppress(OSError):
            self._stream.raw.close()
