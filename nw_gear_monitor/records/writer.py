"""Writes a rosbag2 folder with MCAP files: chunked, indexed, compressed, with a schema on every channel."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from nw_gear_common.errors import InputError
from nw_gear_monitor.records import metadata
from nw_gear_monitor.records.disk import sync_folder
from nw_gear_monitor.records.mcapwriter import COMPRESSIONS, McapWriter
from nw_gear_monitor.records.metadata import FileEntry, Metadata, TopicEntry

__all__ = ["COMPRESSIONS", "Limits", "RecordingWriter"]


@dataclass(frozen=True)
class Limits:
    """When a recording goes on in another file.

    Attributes:
        size: bytes of a file without its index, 0 = no limit.
        duration: log time that a file spans, ns, 0 = no limit.
    """

    size: int = 0
    duration: int = 0


@dataclass
class _Topic:
    """A topic, its definition, its channel in the file that is being written, and its messages in all files."""

    entry: TopicEntry
    definition: str
    channel: int
    messages: int = 0


class RecordingWriter:
    """A recording that is being written.

    The file is locked while it is open, so that nobody repairs a recording that is still growing. Until `close` the
    folder has no `metadata.yaml`; what was flushed can be recovered without one. A file that is full is finished, and
    the next one has all topics and metadata records anew, so that each can be opened by itself.

    Args:
        folder: new folder.
        compression: zstd, lz4 or none.
        limits: of one file; a single message that is larger gets a file of its own.
        fsync: make sure with every flush that everything is on the disk, and not only with the operating system.

    Raises:
        InputError: the folder exists, or can't be made.
    """

    def __init__(self, folder: Path, compression: str = "zstd", limits: Limits = Limits(), fsync: bool = False) -> None:
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            raise InputError(str(folder), "a new folder", "one that exists") from None
        except OSError as error:
            raise InputError(str(folder), "a folder that can be made", error.strerror or str(error)) from None
        self.folder = folder
        self._stem = folder.resolve().name
        self._compression = compression
        self._limits = limits
        self._fsync = fsync
        self._topics: list[_Topic] = []
        self._records: dict[str, dict[str, str]] = {}
        self._finished: list[FileEntry] = []
        self._before = 0  # bytes of the files that are finished
        self._began = 0
        try:
            self._mcap = self._open()
        except OSError as error:
            self.path.unlink(missing_ok=True)
            folder.rmdir()
            raise InputError(str(folder), "a folder that can be written to", error.strerror or str(error)) from None

    @property
    def path(self) -> Path:
        """The file that is being written."""
        return self.folder / f"{self._stem}_{len(self._finished)}.mcap"

    @property
    def messages(self) -> int:
        """Messages written."""
        return sum(topic.messages for topic in self._topics)

    @property
    def size(self) -> int:
        """Bytes in the files so far, without the chunk in progress."""
        return self._before + self._mcap.position()

    @property
    def files(self) -> int:
        """Files begun so far."""
        return len(self._finished) + 1

    def add_topic(self, topic: TopicEntry, definition: str) -> int:
        """Begin a topic and return the number under which its messages are written.

        Args:
            topic: name, type, hash and QoS.
            definition: text of the message definition with all that it depends on, separated as in rosbag2.
        """
        self._topics.append(_Topic(topic, definition, self._mcap.add_topic(topic, definition)))
        return len(self._topics) - 1

    def write(self, topic: int, data: bytes, log_time: int, publish_time: int, sequence: int = 0) -> None:
        """Write one message: CDR bytes, times in ns, running number given by its publisher (0 = unknown)."""
        if self._is_full(len(data), log_time):
            self._go_on_in_another_file()
        if not self._mcap.count.messages:
            self._began = log_time
        self._began = min(self._began, log_time)
        begun = self._topics[topic]
        self._mcap.write(begun.channel, data, log_time, publish_time, sequence)
        begun.messages += 1

    def add_metadata(self, name: str, content: dict[str, str]) -> None:
        """Write a metadata record; readers take the last one of a name."""
        self._records[name] = content
        self._mcap.add_metadata(name, content)

    def flush(self) -> None:
        """Hand everything over to the operating system: a process that is killed afterwards loses none of it.

        Raises:
            OSError: it can't be written, or the file is no longer in its folder.
        """
        self._mcap.flush(self._fsync)
        self.path.stat()

    def close(self) -> None:
        """Finish the file and write `metadata.yaml`."""
        self._mcap.close(self._fsync)
        metadata.write(self.folder, Metadata((*self._finished, self._mcap.entry()), self.entries()), self._fsync)

    def abandon(self) -> None:
        """Let go of a file that can't be written any more, as it is."""
        self._mcap.abandon()

    def entries(self) -> tuple[TopicEntry, ...]:
        """The topics with their counts."""
        return tuple(replace(topic.entry, count=topic.messages) for topic in self._topics)

    # --- one file after the other -------------------------------------------------------------------------------------

    def _open(self) -> McapWriter:
        writer = McapWriter(self.path, self._compression)
        if self._fsync:
            sync_folder(self.folder)
        return writer

    def _is_full(self, more: int, log_time: int) -> bool:
        """Whether a message belongs into another file. A clock that jumps back begins a new stretch of time."""
        if not self._mcap.count.messages:
            return False
        if self._limits.size and self._mcap.size_with(more) > self._limits.size:
            return True
        return bool(self._limits.duration) and log_time - self._began >= self._limits.duration

    def _go_on_in_another_file(self) -> None:
        self._mcap.close(self._fsync)
        self._before += self.path.stat().st_size
        self._finished.append(self._mcap.entry())
        self._mcap = self._open()
        for name, content in self._records.items():
            self._mcap.add_metadata(name, content)
        for topic in self._topics:
            topic.channel = self._mcap.add_topic(topic.entry, topic.definition)
