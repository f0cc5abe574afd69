"""Turns serialised messages into objects by the definitions in a recording, neither of which is trusted."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
from typing import Any, SupportsIndex

from mcap.exceptions import McapError
from mcap.records import Channel, Schema
from mcap_ros2.decoder import DecoderFactory

from nw_gear_common.errors import InputError

LONGEST = 1024 * 1024
"""Characters of a definition with all that it depends on; the longest of ROS have some ten thousand."""

DECODE_ERRORS = (
    ValueError, LookupError, RuntimeError, TypeError, AttributeError, MemoryError, OverflowError,
    struct.error, McapError,
)  # fmt: skip
"""What a strange definition, or a message that doesn't fit, makes the library raise."""

_ASSIGNED = re.compile(r"^[ \t]*[^\s#]+[ \t]+([^\s=#\"']+)[ \t]*=", re.MULTILINE)
_CONSTANT = re.compile(r"[A-Z](?:_?[A-Z0-9])*")


class _Exact(bytes):
    """Bytes of which no piece can be taken beyond their end: the library would go on there for ever, with nothing."""

    def __getitem__(self, key: SupportsIndex | slice) -> Any:
        if isinstance(key, slice) and key.stop is not None and key.stop > len(self):
            raise IndexError("it ends within a text or an array")
        return super().__getitem__(key)


def decoder_of(factory: DecoderFactory, channel: Channel, schema: Schema | None, place: str) -> Callable[[bytes], Any]:
    """What turns messages of a channel into objects with the fields of its type.

    Args:
        factory: of the file, which keeps what it has parsed.
        channel: of the file.
        schema: its definition.
        place: for errors.

    Raises:
        InputError: the definition can't be used; when the result is called, a message doesn't fit it.
    """
    try:
        if schema is not None:
            _check(schema.data.decode())
        decode = factory.decoder_for(channel.message_encoding, schema)
    except Exception as error:  # whatever the parser of definitions meets in a strange one
        raise InputError(place, "a message definition", str(error) or type(error).__name__) from None
    if decode is None or schema is None:
        raise InputError(place, "messages in CDR with a ros2msg definition", channel.message_encoding or "nothing")
    kind = schema.name

    def checked(data: bytes) -> Any:
        try:
            return decode(_Exact(data))
        except DECODE_ERRORS as error:
            raise InputError(place, f"a serialised {kind}", str(error) or type(error).__name__) from None

    return checked


def _check(text: str) -> None:
    """Refuse what the parser of definitions would take very long for.

    Raises:
        ValueError: the definition is too long, or a constant has a name that isn't one.
    """
    if len(text) > LONGEST:
        raise ValueError(f"one of {len(text)} characters")
    for match in _ASSIGNED.finditer(text):
        if not _CONSTANT.fullmatch(match[1]):
            raise ValueError(f"the constant {match[1][:60]}")
