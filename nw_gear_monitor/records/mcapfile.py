"""One MCAP file: whether it is whole, what is in it, and its messages in the order in which they were recorded.

Messages are read chunk by chunk, so that memory stays bounded however long the file is.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self, TypeGuard, cast

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import Channel, Chunk, ChunkIndex, Message
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap.summary import Summary
from zstandard import ZstdError

from nw_gear_common.errors import InputError
from nw_gear_monitor.records.bounded import LARGEST_RECORD, Bounded
from nw_gear_monitor.records.metadata import CONVERT, CONVERT_ROS1
from nw_gear_monitor.records.unpacking import LARGEST, decompress

MAGIC = b"\x89MCAP0\r\n"
RECORD_HEAD = struct.Struct("<BQ")
_FOOTER = struct.Struct("<BQQQI")
READ_ERRORS = (
    McapError, ZstdError, struct.error, ValueError, RuntimeError, OSError, LookupError, TypeError, MemoryError,
    OverflowError,
)  # fmt: skip
"""What a damaged file makes the libraries raise."""

_NOT_IN_INDEX = (Opcode.CHUNK, Opcode.MESSAGE, Opcode.HEADER, Opcode.FOOTER, Opcode.DATA_END, Opcode.ATTACHMENT)
_OTHER_KINDS = {b"SQLite": f"an SQLite bag: {CONVERT}", b"#ROSBAG": f"a bag of ROS 1: {CONVERT_ROS1}"}


def damage(path: Path) -> str:
    """Say what is wrong with the ends of a file: empty where it was finished, else a few words.

    Raises:
        InputError: it can't be read, or isn't an MCAP file.
    """
    try:
        with path.open("rb") as stream:
            head = stream.read(len(MAGIC))
            if head != MAGIC:
                if MAGIC.startswith(head):
                    return "it ends before anything was recorded"
                known = (words for start, words in _OTHER_KINDS.items() if head.startswith(start))
                raise InputError(str(path), "an MCAP file", next(known, "another kind of file"))
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
            if size - summary_start > LARGEST_RECORD:
                return "its index is too large"
            stream.seek(summary_start)
            summary = stream.read(size - tail - summary_start)
            sound = _is_index(summary) and (not crc or zlib.crc32(footer[:-4], zlib.crc32(summary)) == crc)
            return "" if sound else "its index is damaged"
    except OSError as error:
        raise InputError(str(path), "a readable MCAP file", error.strerror or str(error)) from None


def _is_index(summary: bytes) -> bool:
    """Whether the records before the footer are those of an index, each as long as it says."""
    at = 0
    while at + RECORD_HEAD.size <= len(summary):
        opcode, length = RECORD_HEAD.unpack_from(summary, at)
        if opcode in _NOT_IN_INDEX:
            return False
        at += RECORD_HEAD.size + length
    return at == len(summary)


def unusable(path: Path) -> str:
    """Say why a file can't be opened as it is: empty where it can.

    Raises:
        InputError: it can't be read, or isn't an MCAP file.
    """
    reason = damage(path)
    if not reason:
        try:
            McapFile(path).close()
        except InputError:
            return "its index makes no sense"
    return reason


def records_of(chunk: Chunk) -> list[Any]:
    """The records in a chunk, whose checksum is verified.

    Raises:
        READ_ERRORS: it is damaged, or claims more than can be.
    """
    content = decompress(chunk.compression, chunk.data, chunk.uncompressed_size, chunk.uncompressed_crc)
    return list(breakup_chunk(replace(chunk, compression="", data=bytes(content))))


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
        self._bounded = cast(IO[bytes], Bounded(self._stream))
        try:
            self._reader = SeekingReader(self._bounded)
            summary = self._reader.get_summary()
            if summary is None or not _in_order(summary.chunk_indexes, path.stat().st_size):
                raise ValueError("its index points to wrong places")
        except READ_ERRORS as error:
            self._stream.close()
            raise self._unreadable(error) from None
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
            self._bounded.seek(0)
            for record in StreamReader(self._bounded, emit_chunks=True).records:
                yield from (
                    r for r in (records_of(record) if isinstance(record, Chunk) else [record]) if _is_message(r)
                )
        for index in indexes:
            held = index.message_index_offsets
            if index.message_end_time >= since and (not held or channels & held.keys()):
                yield from filter(_is_message, records_of(self._chunk(index)))

    def _chunk(self, index: ChunkIndex) -> Chunk:
        self._bounded.seek(index.chunk_start_offset)
        opcode, length = RECORD_HEAD.unpack(self._bounded.read(RECORD_HEAD.size))
        if opcode != Opcode.CHUNK or RECORD_HEAD.size + length != index.chunk_length:
            raise ValueError("its index points to no chunk")
        chunk: Chunk = Chunk.read(ReadDataStream(self._bounded))
        return chunk

    def _unreadable(self, error: Exception) -> InputError:
        words = str(error) or type(error).__name__
        return InputError(str(self.path), "an intact MCAP file", f"a damaged one, {words}: see `nw_gear recover`")


def _is_message(record: object) -> TypeGuard[Message]:
    return isinstance(record, Message)


def _in_order(indexes: Sequence[ChunkIndex], size: int) -> bool:
    """Whether the chunks of an index lie in the file, one behind the other and none twice."""
    end = len(MAGIC)
    for index in sorted(indexes, key=lambda index: index.chunk_start_offset):
        if index.chunk_start_offset < end or not RECORD_HEAD.size <= index.chunk_length <= LARGEST + LARGEST // 8:
            return False
        end = index.chunk_start_offset + index.chunk_length
    return end <= size
