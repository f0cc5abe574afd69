"""Walks through an MCAP file from its beginning, as far as it is intact; needs no index."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message, Metadata, Schema

from nw_gear_monitor.records.bounded import LARGEST_RECORD
from nw_gear_monitor.records.mcapfile import MAGIC, READ_ERRORS, RECORD_HEAD, records_of

Record = Schema | Channel | Message | Metadata
_PLAIN: dict[int, Any] = {Opcode.SCHEMA: Schema, Opcode.CHANNEL: Channel, Opcode.METADATA: Metadata}
_USED = (*_PLAIN, Opcode.MESSAGE, Opcode.CHUNK)


@dataclass
class Scan:
    """What a walk through a file has found so far.

    Attributes:
        path: of the file.
        places: where chunks begin and the data end, from an index; behind a record with a wrong length the walk goes on
            at the next one.
        chunks: intact ones.
        damaged_chunks: those whose content doesn't fit their checksum.
        damaged_bytes: size of these.
        end: where the last intact record ends (byte).
        finished: whether the end of the data was reached.
        compression: of the chunks, as MCAP names it; "" where there are none.
    """

    path: Path
    places: tuple[int, ...] = ()
    chunks: int = 0
    damaged_chunks: int = 0
    damaged_bytes: int = 0
    end: int = field(default=len(MAGIC))
    finished: bool = False
    compression: str = ""

    @property
    def lost_bytes(self) -> int:
        """Bytes that can't be used: damaged chunks, and what follows the last intact record of an unfinished file."""
        cut = 0 if self.finished else self.path.stat().st_size - self.end
        return self.damaged_bytes + cut

    def records(self) -> Iterator[Record]:
        """Every schema, channel, message and metadata record, chunk by chunk."""
        size = self.path.stat().st_size
        with self.path.open("rb") as stream:
            while not self.finished and self.end + RECORD_HEAD.size <= size:
                stream.seek(self.end)
                opcode, length = RECORD_HEAD.unpack(stream.read(RECORD_HEAD.size))
                after = self.end + RECORD_HEAD.size + length
                if after > size or (opcode in _USED and length > LARGEST_RECORD):
                    if not self._go_on_behind():
                        return
                    continue
                if opcode in _USED:
                    yield from self._content(opcode, stream.read(length))
                self.end = after
                self.finished = opcode == Opcode.DATA_END

    def _go_on_behind(self) -> bool:
        """Go to the next place that the index names, where a file has one; the record here has a wrong length."""
        here = next((place for place in self.places if place > self.end), 0)
        if not here:
            return False
        self.damaged_chunks += 1
        self.damaged_bytes += here - self.end
        self.end = here
        return True

    def _content(self, opcode: int, content: bytes) -> list[Record]:
        """The records of one chunk, or the record itself; what is damaged is counted."""
        data = ReadDataStream(io.BytesIO(content))
        try:
            if opcode == Opcode.MESSAGE:
                return [Message.read(data, len(content))]
            if opcode in _PLAIN:
                return [_PLAIN[opcode].read(data)]
            chunk = Chunk.read(data)
            records = records_of(chunk)
        except READ_ERRORS:
            self.damaged_chunks += 1
            self.damaged_bytes += RECORD_HEAD.size + len(content)
            return []
        self.chunks += 1
        self.compression = str(chunk.compression)
        return [record for record in records if isinstance(record, Schema | Channel | Message)]
