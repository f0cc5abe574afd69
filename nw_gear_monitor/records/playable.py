"""Whether recorded messages can be published again as they are: what a replay asks before it lets bytes out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from nw_gear_common.errors import InputError
from nw_gear_monitor.records.definitions import type_hash
from nw_gear_monitor.records.reader import RawMessage, Recording
from nw_gear_monitor.records.schema import HASH_KEY, MESSAGE_ENCODING

LATEST = (2**31 - 1) * 1_000_000_000
"""Latest log time that a `/clock` can show (ns)."""

_HEADER = 4
_ENCODINGS = 12
"""Representations of CDR, as the second byte of a serialised message numbers them."""


def obstacle(recording: Recording, topic: str) -> str:
    """Why the messages of a topic can't be published again, in words; empty where they can."""
    types, encodings, hashes = set(), set(), set()
    for file in recording.files:
        for channel in file.summary.channels.values():
            if channel.topic == topic:
                schema = file.summary.schemas.get(channel.schema_id)
                types.add(schema.name if schema else "")
                encodings.add(channel.message_encoding)
                hashes.add(channel.metadata.get(HASH_KEY, ""))
    if len(types) > 1:
        return f"it has several types: {', '.join(sorted(types))}"
    if encodings != {MESSAGE_ENCODING}:
        return f"its messages aren't in CDR: {', '.join(sorted(encodings))}"
    here = type_hash(next(iter(types)))
    if here and any(found.startswith("RIHS01_") and found != here for found in hashes):
        return f"{next(iter(types))} had another definition when it was recorded"
    return ""


def checked(messages: Iterable[RawMessage], place: str) -> Iterator[RawMessage]:
    """Pass messages on that could be serialised ones, at times that a clock can show.

    Raises:
        InputError: one couldn't.
    """
    for message in messages:
        if message.log_time > LATEST:
            raise InputError(f"{place}: {message.topic}", "log times before 2038", f"{message.log_time} ns")
        head = message.data[:_HEADER]
        if len(head) < _HEADER or head[0] or head[1] >= _ENCODINGS:
            raise InputError(f"{place}: {message.topic}", "a serialised message", "something else")
        yield message
