"""Copies whatever is intact in one damaged MCAP file into a new one, whole chunks at a time."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from pathlib import Path

from mcap.records import Channel, Message, Metadata, Schema

from nw_gear_common.errors import InputError
from nw_gear_monitor.records.mcapfile import McapFile
from nw_gear_monitor.records.mcapwriter import McapWriter
from nw_gear_monitor.records.scan import Record, Scan
from nw_gear_monitor.records.schema import PROVENANCE

RECORD = f"{PROVENANCE}recovered"
"""Metadata record that a repaired file carries."""


@dataclass(frozen=True)
class Rescued:
    """What came out of one damaged file.

    Attributes:
        file: its name.
        reason: what was wrong with it.
        messages: how many were recovered.
        lost_bytes: bytes that held nothing usable.
        lost_messages: messages of topics whose description was lost.
        kept_as: name of the damaged file afterwards, empty where it was left alone.
    """

    file: str
    reason: str
    messages: int
    lost_bytes: int
    lost_messages: int = 0
    kept_as: str = ""

    def words(self) -> str:
        """A part of a sentence for people."""
        orphans = f", {self.lost_messages} messages of unknown topics left out" if self.lost_messages else ""
        return f"{self.messages} messages recovered, {self.lost_bytes} bytes lost{orphans}"


def rescue(path: Path, new: Path, reason: str) -> Rescued:
    """Copy what is intact in a damaged file into a new one, which isn't there afterwards if that fails.

    Raises:
        OSError: the new file can't be written.
    """
    schemas, channels, places = _known(path)
    scan = Scan(path, places)
    with contextlib.ExitStack() as stack:
        stack.callback(new.unlink, missing_ok=True)
        writer = McapWriter(new, _compression(path))
        stack.callback(writer.abandon)
        copy = _Copy(writer, schemas, channels)
        for record in scan.records():
            copy.add(record)
        rescued = Rescued(path.name, reason, writer.count.messages, scan.lost_bytes, copy.orphans)
        noted = {"file": path.name, "reason": reason}
        writer.add_metadata(RECORD, {**noted, "messages": str(rescued.messages), "lost_bytes": str(rescued.lost_bytes)})
        writer.close()
        stack.pop_all()
    return rescued


class _Copy:
    """Writes records of one file into another, where channels and schemas have other numbers."""

    def __init__(self, writer: McapWriter, schemas: dict[int, Schema], channels: dict[int, Channel]) -> None:
        self.orphans = 0
        self._writer = writer
        self._schemas = schemas
        self._channels = channels
        self._numbers: dict[int, int] = {}

    def add(self, record: Record) -> None:
        """Write one record; a message whose channel is unknown is counted instead."""
        if isinstance(record, Schema):
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            self._channels[record.id] = record
            self._number(record.id)
        elif isinstance(record, Metadata):
            self._writer.add_metadata(record.name, record.metadata)
        else:
            self._message(record)

    def _message(self, message: Message) -> None:
        number = self._number(message.channel_id)
        if number is None:
            self.orphans += 1
        else:
            self._writer.write(number, message.data, message.log_time, message.publish_time, message.sequence)

    def _number(self, channel: int) -> int | None:
        """Number of a channel in the new file, where it begins when it is first met; None where it is unknown."""
        if channel not in self._numbers and channel in self._channels:
            found = self._channels[channel]
            schema = self._schemas.get(found.schema_id)
            under = self._writer.add_schema(schema.name, schema.encoding, schema.data) if schema else 0
            self._numbers[channel] = self._writer.add_channel(
                found.topic, found.message_encoding, under, found.metadata
            )
        return self._numbers.get(channel)


def _known(path: Path) -> tuple[dict[int, Schema], dict[int, Channel], tuple[int, ...]]:
    """Schemas, channels and places of the chunks from the index, where a file still has one."""
    try:
        with McapFile(path) as file:
            places = sorted(index.chunk_start_offset for index in file.summary.chunk_indexes)
            return dict(file.summary.schemas), dict(file.summary.channels), tuple(places)
    except InputError:
        return {}, {}, ()


def _compression(path: Path) -> str:
    """Compression of the first intact chunk, so that the copy looks like its original."""
    scan = Scan(path)
    for _record in scan.records():
        if scan.chunks:
            break
    return (scan.compression or "none") if scan.chunks else "zstd"
