"""Whole chunks of an MCAP file, decompressed ahead by threads and indexed in one go: for an hour of samples.

`McapFile.messages` makes an object of every message; here a chunk is one array of bytes, with arrays that tell where
its messages begin and end. Chunks come in the order of the file, their checksums are verified, and only a few are held.
"""

from __future__ import annotations

import os
import struct
from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from itertools import islice
from typing import NamedTuple

import numba
import numpy as np
import numpy.typing as npt
from mcap.opcode import Opcode

from nw_gear_common.errors import InputError
from nw_gear_monitor.records.mcapfile import READ_ERRORS, RECORD_HEAD, McapFile
from nw_gear_monitor.records.unpacking import decompress

THREADS = 2
AHEAD = 4
"""Chunks that are fetched before they are asked for."""
GROUP = 512
"""Messages per batch where a file has no chunks."""

Bytes = npt.NDArray[np.uint8]
Whole = npt.NDArray[np.int64]

_CHUNK = struct.Struct("<QQQI")
_MESSAGE = int(Opcode.MESSAGE)
_HEAD = RECORD_HEAD.size
_MESSAGE_HEAD = 22


@dataclass(frozen=True, eq=False)
class Batch:
    """Messages of one chunk, in order.

    Attributes:
        data: bytes of the chunk.
        channel: channel of each message.
        start, end: where its content begins and ends in `data`.
        log_time: ns.
    """

    data: Bytes
    channel: Whole
    start: Whole
    end: Whole
    log_time: Whole


class Place(NamedTuple):
    """Where a chunk stands: number of the file in the recording, and offset in it."""

    file: int
    offset: int


@numba.njit(cache=True, nogil=True)
def _word(data: Bytes, at: int, size: int) -> np.int64:
    value = np.int64(0)
    for i in range(size):
        value |= np.int64(data[at + i]) << (8 * i)
    return value


@numba.njit(cache=True, nogil=True)
def _walk(data: Bytes, found: Whole) -> int:
    """Write channel, start, end and log time of every message into `found`; how many, or -1 where a record is cut."""
    at, count, size = 0, 0, len(data)
    while at + _HEAD <= size:
        length = _word(data, at + 1, 8)
        begin = at + _HEAD
        if length < 0 or length > size - begin:
            return -1
        if data[at] == _MESSAGE:
            if length < _MESSAGE_HEAD:
                return -1
            if count < len(found):
                found[count, 0] = _word(data, begin, 2)
                found[count, 1] = begin + _MESSAGE_HEAD
                found[count, 2] = begin + length
                found[count, 3] = _word(data, begin + 6, 8)
            count += 1
        at = begin + length
    return count if at == size else -1


def index(data: Bytes) -> Batch:
    """Find the messages in the records of a chunk.

    Raises:
        ValueError: a record doesn't end within the chunk.
    """
    found = np.empty((1024, 4), dtype=np.int64)
    count = _walk(data, found)
    if count > len(found):
        found = np.empty((count, 4), dtype=np.int64)
        count = _walk(data, found)
    if count < 0:
        raise ValueError("a record is cut")
    channel, start, end, log_time = found[:count].T.copy()
    return Batch(data, channel, start, end, log_time)


def unpack(record: bytes) -> Bytes:
    """Content of a chunk record, decompressed.

    Raises:
        ValueError, RuntimeError, zstandard.ZstdError: unknown compression, wrong size or wrong checksum.
    """
    _first, _last, size, crc = _CHUNK.unpack_from(record)
    (length,) = struct.unpack_from("<I", record, _CHUNK.size)
    at = _CHUNK.size + 4 + length
    compression = record[_CHUNK.size + 4 : at].decode()
    packed = memoryview(record)[at + 8 :]
    content = decompress(compression, packed, size, crc)
    return np.frombuffer(content, dtype=np.uint8)


class ChunkReader:
    """Reads the chunks of one file; use it in a `with` block.

    Args:
        file: an open file.
        number: of the file in its recording, for `Place`.
    """

    def __init__(self, file: McapFile, number: int = 0) -> None:
        self._file = file
        self._number = number
        self._handle = os.open(file.path, os.O_RDONLY)
        self._indexes = sorted(file.summary.chunk_indexes, key=lambda i: i.chunk_start_offset)
        self._sizes = {i.chunk_start_offset: i.chunk_length for i in self._indexes}

    def __enter__(self) -> ChunkReader:
        return self

    def __exit__(self, *_ended: object) -> None:
        os.close(self._handle)

    def batches(self, channels: Collection[int]) -> Iterator[tuple[Place, Batch]]:
        """Batches that hold some of the channels; of a file without chunks, groups of messages by number.

        Raises:
            InputError: a chunk is damaged.
        """
        if not self._sizes:
            yield from ((Place(self._number, i), batch) for i, batch in enumerate(self._groups()))
            return
        offsets = (i.chunk_start_offset for i in self._indexes if _holds(i.message_index_offsets, channels))
        with ThreadPoolExecutor(THREADS, thread_name_prefix="chunks") as pool:
            waiting: deque[tuple[Place, Future[Batch]]] = deque()
            try:
                for offset in offsets:
                    waiting.append((Place(self._number, offset), pool.submit(self._read, offset)))
                    if len(waiting) > AHEAD:
                        yield self._done(waiting.popleft())
                while waiting:
                    yield self._done(waiting.popleft())
            finally:
                for _place, future in waiting:
                    future.cancel()

    def at(self, place: Place) -> Batch:
        """One batch again.

        Raises:
            InputError: it is damaged.
        """
        if not self._sizes:
            return next(islice(self._groups(), place.offset, None))
        return self._checked(lambda: self._read(place.offset))

    def _done(self, item: tuple[Place, Future[Batch]]) -> tuple[Place, Batch]:
        return item[0], self._checked(item[1].result)

    def _checked(self, read: Callable[[], Batch]) -> Batch:
        try:
            return read()
        except READ_ERRORS as error:
            got = f"a damaged one, {str(error) or type(error).__name__}: see `nw_gear recover`"
            raise InputError(str(self._file.path), "an intact MCAP file", got) from None

    def _read(self, offset: int) -> Batch:
        record = os.pread(self._handle, self._sizes[offset], offset)
        if len(record) < self._sizes[offset]:
            raise ValueError("a chunk is cut")
        return index(unpack(record[_HEAD:]))

    def _groups(self) -> Iterator[Batch]:
        messages = ((m.channel_id, m.log_time, m.data) for _channel, m in self._file.messages())
        while group := list(islice(messages, GROUP)):
            ends = np.cumsum([len(data) for _c, _t, data in group])
            data = np.frombuffer(b"".join(data for _c, _t, data in group), dtype=np.uint8)
            channel, log_time = np.array([c for c, _t, _d in group]), np.array([t for _c, t, _d in group])
            yield Batch(data, channel, np.append(0, ends[:-1]), ends, log_time)


def _holds(offsets: Mapping[int, int], channels: Collection[int]) -> bool:
    """Whether a chunk has messages of some channels; one without message indexes may have any."""
    return not offsets or not offsets.keys().isdisjoint(channels)
