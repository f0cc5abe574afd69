"""Elements of a MAT file of version 5 to 7, and the arrays in them.

Source: MAT-File Format, The MathWorks, R2017a, chapter 1. Only what holds real numbers is read; a length is looked at
before anything of that length is made, so that a damaged file can't ask for more memory than it has bytes (1000 times
as much where it is compressed).
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array

MATRIX, COMPRESSED = 14, 15
NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
STRUCTURE = 2
NUMERIC = range(6, 16)
KINDS = {1: "a cell array", 3: "an object", 4: "text", 5: "a sparse matrix", 16: "a function", 17: "an object"}
COMPLEX = 0x0800
DEEPEST = 8
MOST_FIELDS = 10_000
LARGEST = 2**30
"""Bytes of one variable, unpacked."""


@dataclass(frozen=True, eq=False)
class Variable:
    """An array of a file: its numbers in the shape it has there, or why there are none."""

    name: str
    numbers: Array | None
    reason: str = ""


class Elements:
    """Goes through the elements of a piece of a file.

    Args:
        place: for errors; data: the piece; order: `<` or `>`, as the file's header says.
    """

    def __init__(self, place: str, data: memoryview, order: str) -> None:
        self.place, self.data, self.order, self.at = place, data, order, 0

    def __bool__(self) -> bool:
        return self.at + 8 <= len(self.data)

    def next(self) -> tuple[int, memoryview]:
        """Return type and content of the next element; raises InputError where it isn't whole."""
        if not self:
            raise self.broken("another element", "the end")
        kind, size = struct.unpack_from(f"{self.order}II", self.data, self.at)
        if kind >> 16:
            kind, size = kind & 0xFFFF, kind >> 16
            begin, after = self.at + 4, self.at + 8
            if size > 4:
                raise self.broken("4 bytes or less in a short element", str(size))
        else:
            begin = self.at + 8
            after = begin + size + (0 if kind == COMPRESSED else -size % 8)
        if begin + size > len(self.data):
            raise self.broken(f"an element of {size} bytes", f"{len(self.data) - begin}: the file is cut short")
        self.at = after
        return kind, self.data[begin : begin + size]

    def numbers(self) -> Array:
        """Return the next element, which must hold real numbers, as float64."""
        kind, content = self.next()
        if kind not in NUMBERS:
            raise self.broken("an element of numbers", f"type {kind}")
        number = np.dtype(self.order + NUMBERS[kind])
        if len(content) % number.itemsize:
            raise self.broken(f"whole numbers of {number.itemsize} bytes", f"{len(content)} bytes")
        return np.frombuffer(content, number).astype(np.float64)

    def text(self) -> str:
        """Return the next element as text."""
        return bytes(self.next()[1]).decode("ascii", "replace")

    def inside(self, content: memoryview) -> Elements:
        """The elements of a part."""
        return Elements(self.place, content, self.order)

    def broken(self, expected: str, got: str) -> InputError:
        """An error that names the file."""
        return InputError(self.place, expected, got)


def variables(elements: Elements) -> Iterator[Variable]:
    """Arrays of a file; fields of a structure are called structure.field."""
    while elements:
        kind, content = elements.next()
        if kind == COMPRESSED:
            kind, content = elements.inside(_unpacked(elements, content)).next()
        if kind == MATRIX:
            yield from _matrix(elements.inside(content), "", 0)


def _unpacked(elements: Elements, content: memoryview) -> memoryview:
    stream = zlib.decompressobj()
    try:
        head = stream.decompress(content, 8)
        if len(head) < 8:
            raise elements.broken("a compressed variable", "less than its first 8 bytes")
        size = struct.unpack(f"{elements.order}II", head)[1]
        if size > LARGEST:
            raise elements.broken(f"variables of {LARGEST} bytes or less", str(size))
        return memoryview(head + stream.decompress(stream.unconsumed_tail, max(size, 1)))
    except zlib.error as error:
        raise elements.broken("a compressed variable", f"damage ({error})") from None


def _matrix(elements: Elements, given: str, depth: int) -> Iterator[Variable]:
    """One array: the name of a field is `given` from outside."""
    if not elements:
        return
    flags, shape, own = elements.numbers(), elements.numbers(), elements.text()
    name = given or own
    if flags.size != 2 or not 2 <= shape.size <= 32 or np.any(shape < 0):
        raise elements.broken("flags and sides of an array", f"{flags.size} flags, sides {shape[:4].tolist()}")
    sides = tuple(int(side) for side in shape)
    word = int(flags[0]) & 0xFFFFFFFF
    kind = word & 0xFF
    if kind in NUMERIC:
        if word & COMPLEX:
            yield Variable(name, None, "complex numbers")
        else:
            yield Variable(name, _shaped(elements, name, sides))
    elif kind == STRUCTURE and sides == (1, 1):
        yield from _structure(elements, name, depth)
    else:
        yield Variable(name, None, KINDS.get(kind, "an array of structures" if kind == STRUCTURE else "unknown"))


def _shaped(elements: Elements, name: str, sides: tuple[int, ...]) -> Array:
    numbers = elements.numbers()
    if numbers.size != math.prod(sides):
        raise elements.broken(f"{math.prod(sides)} numbers in {name!r}"[:80], str(numbers.size))
    return numbers.reshape(sides, order="F")


def _structure(elements: Elements, name: str, depth: int) -> Iterator[Variable]:
    width = elements.numbers()
    if depth >= DEEPEST or width.size != 1 or not 1 <= width[0] <= 64:
        raise elements.broken(f"structures, {DEEPEST} deep or less, with names of fields", "something else")
    joined = bytes(elements.next()[1])
    size = int(width[0])
    if len(joined) > size * MOST_FIELDS:
        raise elements.broken(f"{MOST_FIELDS} fields or less", str(len(joined) // size))
    for start in range(0, len(joined) - size + 1, size):
        field = joined[start : start + size].partition(b"\0")[0].decode("ascii", "replace")
        kind, content = elements.next()
        if kind != MATRIX:
            raise elements.broken(f"an array in field {field!r}", f"an element of type {kind}")
        yield from _matrix(elements.inside(content), f"{name}.{field}", depth + 1)
