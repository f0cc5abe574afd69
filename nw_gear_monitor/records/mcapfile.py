"""One MCAP file: whether it is whole, what is in it, and its messages in the order in which they were recorded.

Messages are read chunk by chunk, so that memory stays bounded however long the file is.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Collection, Iterator
from pathlib import Path
from types import TracebackType
from typing import Self

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import Channel, Chunk, ChunkIndex, Message
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap.summary import Summary
from zstandard import ZstdError

from nw_gear_common.errors import InputError

MAGIC = b"\x89MCAP0\r\n"
RECORD_HEAD = struct.Struct("<BQ")
_FOOTER = struct.Struct("<BQQQI")
READ_ERRORS = (McapError, ZstdError, struct.error, ValueError, RuntimeError, OSError, IndexError)
"""What a damaged file makes the libraries raise."""


def damage(path: Path) -> str:
    """Say what is wrong with the ends of a file: empty where it was finished, else a few words.

    Raises:
        InputError: it can't be read, or isn't an MCAP file.
    """
    try:
        with path.open("rb") as stream:
            head = stream.read(len(MAGIC))
            if head != MAGIC:
                got = "an empty file" if not head else "another kind of file"
                raise InputError(str(path), "an MCAP file", "an SQLite bag" if head.startswith(b"SQLite") else got)
            size = stream.seek(0, 2)
            tail = _FOOTER.size + len(MAGIC)
            if size < len(MAGIC) + tail:
                return "it ends before its index"
            stream.seek(size - tail)
            footer = stream.read(_FOOTER.size)
            opcode, length, summary_start, _offsets, crc = _FOOTER.unpack(footer)
            if stream.read() != MAGIC or opcode != Opcode.FOOTER or length != _FOOTER.size - RECORD_HEAD.size:
                return "it ends before its index"
            if not len(MAGIC) <= summary_start <= size - tail:
                return "it has no index"
            stream.seek(summary_start)
            covered = stream.read(size - tail - summary_start) + footer[:-4]
            return "its index is damaged" if crc and zlib.crc32(covered) != crc else ""
    except OSError as error:
        raise InputError(str(path), "a readable MCAP file", error.strerror or str(error)) from None


class McapFile:
    """An MCAP file that is whole; use it in a `with` block or close it.

    Raises:
        InputError: it isn't an MCAP file, or it is damaged.
    """

    def __init__(self, path: Path) -> None:
        reason = damage(path)
        if reason:
            raise InputError(str(path), "a finished recording", f"a damaged one, {reason}: see `nw_gear recover`")
        self.path = path
        self._stream = path.open("rb")
        try:
            self._reader = SeekingReader(self._stream)
            summary = self._reader.get_summary()
        except READ_ERRORS as error:
            self._stream.close()
            raise self._unreadable(error) from None
        assert summary is not None  # `damage` has seen it
        self.summary: Summary = summary

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, _kind: type[BaseException] | None, _error: BaseException | None, _trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._stream.close()

    @property
    def message_count(self) -> int:
        """Messages in the file."""
        return int(self.summary.statistics.message_count) if self.summary.statistics else 0

    def count(self, channel: int) -> int:
        """Messages of one channel."""
        statistics = self.summary.statistics
        return int(statistics.channel_message_counts.get(channel, 0)) if statistics else 0

    def bounds(self) -> tuple[int, int]:
        """First and last log time (ns); (0, 0) without messages."""
        statistics = self.summary.statistics
        return (int(statistics.message_start_time), int(statistics.message_end_time)) if statistics else (0, 0)

    def metadata(self) -> Iterator[tuple[str, dict[str, str]]]:
        """Every metadata record: name and content."""
        try:
            for record in self._reader.iter_metadata():
                yield record.name, dict(record.metadata)
        except READ_ERRORS as error:
            raise self._unreadable(error) from None

    def messages(self, topics: Collection[str] | None = None, since: int = 0) -> Iterator[tuple[Channel, Message]]:
        """Messages in the order in which they were recorded.

        Args:
            topics: only these (None = all).
            since: only those with at least this log time (ns).
        """
        wanted = {
            number: channel
            for number, channel in self.summary.channels.items()
            if topics is None or channel.topic in topics
        }
        try:
            for message in self._all(set(wanted), since):
                if message.channel_id in wanted and message.log_time >= since:
                    yield wanted[message.channel_id], message
        except READ_ERRORS as error:
            raise self._unreadable(error) from None

    def _all(self, channels: set[int], since: int) -> Iterator[Message]:
        """Messages of the chunks that have any of the channels; of an unchunked file, all."""
        indexes = sorted(self.summary.chunk_indexes, key=lambda index: index.chunk_start_offset)
        if not indexes:
            self._stream.seek(0)
            yield from (r for r in StreamReader(self._stream).records if isinstance(r, Message))
        for index in indexes:
            held = index.message_index_offsets
            if index.message_end_time >= since and (not held or channels & held.keys()):
                yield from (r for r in breakup_chunk(self._chunk(index), True) if isinstance(r, Message))

    def _chunk(self, index: ChunkIndex) -> Chunk:
        self._stream.seek(index.chunk_start_offset + RECORD_HEAD.size)
        chunk: Chunk = Chunk.read(ReadDataStream(self._stream))
        return chunk

    def _unreadable(self, error: Exception) -> InputError:
        words = str(error) or type(error).__name__
        return InputError(str(self.path), "an intact MCAP file", f"a damaged one, {words}: see `nw_gear recover`")
