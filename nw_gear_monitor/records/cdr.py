"""A Float64MultiArray from its serialised bytes (CDR) and back, without going through it element by element."""

from __future__ import annotations

import struct
from typing import NamedTuple

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Table

TABLE_TYPE = "std_msgs/msg/Float64MultiArray"

_ENCAPSULATION = 4
_ORDERS = {b"\x00\x00": ">", b"\x00\x01": "<"}


class Cursor:
    """Walks over CDR data; positions are aligned relative to the end of the encapsulation header."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.order = _ORDERS[bytes(data[:2])]
        self.at = _ENCAPSULATION
        self._word = struct.Struct(self.order + "I")

    def word(self) -> int:
        """An unsigned number of four bytes."""
        self.align(4)
        (value,) = self._word.unpack_from(self.data, self.at)
        self.at += 4
        return int(value)

    def text(self) -> str:
        """A string: its length with the final zero, then its bytes."""
        length = self.word()
        start, self.at = self.at, self.at + length
        if self.at > len(self.data):
            raise ValueError("a string that is longer than the message")
        return self.data[start : start + max(0, length - 1)].decode()

    def align(self, size: int) -> None:
        """Go on to the next multiple of `size`."""
        self.at += -(self.at - _ENCAPSULATION) % size


class Layout(NamedTuple):
    """How a table stands in its message: its head, and where its numbers begin, in which byte order (`<` or `>`)."""

    row: str
    columns: tuple[str, ...]
    rows: int
    begin: int
    order: str

    @property
    def size(self) -> int:
        """Bytes of the numbers."""
        return 8 * self.rows * len(self.columns)


def to_table(data: bytes, place: str) -> Table:
    """Turn a serialised std_msgs/Float64MultiArray into a table.

    Args:
        data: CDR with its encapsulation header, as received or recorded.
        place: the topic, for the error.

    Raises:
        InputError: it isn't serialised as that type, or its layout isn't that of a table.
    """
    found = layout(data, place)
    count = found.rows * len(found.columns)
    values = np.frombuffer(data, dtype=found.order + "f8", count=count, offset=found.begin)
    return Table(found.row, found.columns, values.astype(np.float64).reshape(found.rows, len(found.columns)))


def layout(data: bytes, place: str) -> Layout:
    """Find out how a table stands in its message; arguments and errors as for `to_table`."""
    try:
        labels, sizes, count, begin, order = _parse(data)
    except (KeyError, ValueError, struct.error) as error:
        raise InputError(f"{place}: message", f"a serialised {TABLE_TYPE}", str(error)) from None
    if len(labels) != 2:
        raise InputError(f"{place}: layout", "two dimensions", str(len(labels)))
    columns = tuple(labels[1].split(","))
    rows = sizes[0]
    if len(columns) != sizes[1] or count != rows * len(columns):
        raise InputError(f"{place}: data", f"{rows} x {len(columns)} numbers", str(count))
    return Layout(labels[0], columns, rows, begin, order)


def _parse(data: bytes) -> tuple[list[str], list[int], int, int, str]:
    cursor = Cursor(data)
    labels, sizes = [], []
    for _dimension in range(cursor.word()):
        labels.append(cursor.text())
        sizes.append(cursor.word())
        cursor.word()  # the stride follows from the sizes
    cursor.word()  # offset of the data, always 0
    count = cursor.word()
    if count:
        cursor.align(8)
    if cursor.at + 8 * count > len(data):
        raise ValueError("fewer numbers than it says")
    return labels, sizes, count, cursor.at, cursor.order


def from_table(table: Table) -> bytes:
    """Serialise a table as a std_msgs/Float64MultiArray (CDR, little-endian), the inverse of `to_table`."""
    rows, columns = table.data.shape
    parts = [b"\x00\x01\x00\x00", struct.pack("<I", 2)]
    for label, size, stride in ((table.row, rows, rows * columns), (",".join(table.columns), columns, columns)):
        text = label.encode() + b"\x00"
        padding = b"\x00" * (-len(text) % 4)
        parts.append(struct.pack("<I", len(text)) + text + padding + struct.pack("<II", size, stride))
    parts.append(struct.pack("<II", 0, rows * columns))
    length = sum(map(len, parts)) - _ENCAPSULATION
    return b"".join([*parts, b"\x00" * (-length % 8), np.ascontiguousarray(table.data, dtype="<f8").tobytes()])
