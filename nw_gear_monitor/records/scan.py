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
from mcap.stream_reader import breakup_chunk

from nw_gear_monitor.records.mcapfile import MAGIC, READ_ERRORS, RECORD_HEAD

Record = Schema | Channel | Message | Metadata


@dataclass
class Scan:
    """What a walk through a file has found so far.

    Attributes:
        path: of the file.
        chunks: intact ones.
        damaged_chunks: those whose content doesn't fit their checksum.
        damaged_bytes: size of these.
        end: where the last intact record ends (byte).
        finished: whether the end of the data was reached.
        compression: of the chunks, as MCAP names it; "" where there are none.
    """

    path: Path
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
            stream.seek(self.end)
            while not self.finished and self.end + RECORD_HEAD.size <= size:
                opcode, length = RECORD_HEAD.unpack(stream.read(RECORD_HEAD.size))
                if self.end + RECORD_HEAD.size + length > size:
                    return
                content = stream.read(length)
                yield from self._content(opcode, content)
                self.end += RECORD_HEAD.size + length
                self.finished = opcode == Opcode.DATA_END

    def _content(self, opcode: int, content: bytes) -> list[Record]:
        """The records of one chunk, or the record itself; what is damaged is counted."""
        data = ReadDataStream(io.BytesIO(content))
        plain: dict[int, Any] = {Opcode.SCHEMA: Schema, Opcode.CHANNEL: Channel, Opcode.METADATA: Metadata}
        try:
            if opcode == Opcode.MESSAGE:
                return [Message.read(data, len(content))]
            if opcode in plain:
                return [plain[opcode].read(data)]
            if opcode != Opcode.CHUNK:
                return []
            chunk = Chunk.read(data)
            records = breakup_chunk(chunk, validate_crc=True)
        except READ_ERRORS:
            self.damaged_chunks += 1
            self.damaged_bytes += RECORD_HEAD.size + len(content)
            return []
        self.chunks += 1
        self.compression = str(chunk.compression)
        return [record for record in records if isinstance(record, Schema | Channel | Message)]
