"""Many stamped messages of one topic at once: numbers out of their bytes, without decoding them one by one.

A message of a fixed type whose texts (frame, names of joints) don't change has every number at a fixed place. The first
message is walked through to find the places; those that differ from it in anything but numbers and stamp are walked
through each by itself.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.records.cdr import Cursor
from nw_gear_monitor.records.chunks import Batch, Bytes, Whole

JOINTS = "sensor_msgs/msg/JointState"
WRENCH = "geometry_msgs/msg/WrenchStamped"
VECTOR = "geometry_msgs/msg/Vector3Stamped"
TYPES = (JOINTS, WRENCH, VECTOR)

_STAMP = slice(4, 12)
_NANO = 1e-9


@dataclass(frozen=True)
class Rows:
    """Numbers of messages that have the same form.

    Attributes:
        names: of the joints, empty for the other types.
        time: stamps (s), shape (n,).
        values: shape (n, parts, width): position, velocity and effort of joints, force and torque, or one vector; NaN
            where the messages leave a part out.
    """

    names: tuple[str, ...]
    time: Array
    values: Array


@dataclass(frozen=True)
class _Form:
    """Names, and where the numbers of each part begin (0 where there is none) and how many a part has."""

    names: tuple[str, ...]
    begins: tuple[int, ...]
    width: int
    order: str


def _form(data: bytes, kind: str) -> _Form:
    cursor = Cursor(data)
    cursor.at += 8
    cursor.text()
    if kind != JOINTS:
        cursor.align(8)
        count = 2 if kind == WRENCH else 1
        return _checked(_Form((), tuple(cursor.at + 24 * i for i in range(count)), 3, cursor.order), len(data))
    joints = tuple(cursor.text() for _ in range(min(cursor.word(), len(data))))
    begins = []
    for _part in range(3):
        count = cursor.word()
        if count not in (0, len(joints)):
            raise ValueError(f"{count} numbers for {len(joints)} joints")
        if count:
            cursor.align(8)
        begins.append(cursor.at if count else 0)
        cursor.at += 8 * count
    return _checked(_Form(joints, tuple(begins), len(joints), cursor.order), len(data))


def _checked(form: _Form, size: int) -> _Form:
    if max(form.begins) + 8 * form.width > size:
        raise ValueError("it ends within its numbers")
    return form


def rows(batch: Batch, chosen: Whole, kind: str, place: str) -> Iterator[Rows]:
    """Numbers of some messages of a batch, in their order, as few pieces as their forms allow.

    Args:
        batch: of a recording.
        chosen: which messages: indices, ascending.
        kind: one of TYPES.
        place: the topic, for the error.

    Raises:
        InputError: a message isn't serialised as that type.
    """
    start, size = batch.start[chosen], batch.end[chosen] - batch.start[chosen]
    at = 0
    while at < len(chosen):
        first = batch.data[start[at] : start[at] + size[at]].tobytes()
        try:
            form = _form(first, kind)
        except (KeyError, ValueError, struct.error) as error:
            raise InputError(f"{place}: message", f"a serialised {kind}", str(error)) from None
        alike = size[at:] == size[at]
        stop = at + (int(np.argmin(alike)) if not alike.all() else len(alike))
        block = batch.data[start[at:stop, None] + np.arange(size[at])]
        fixed = np.ones(size[at], dtype=np.bool_)
        fixed[_STAMP] = False
        for begin in form.begins:
            if begin:
                fixed[begin : begin + 8 * form.width] = False
        same = (block[:, fixed] == block[0, fixed]).all(axis=1)
        count = len(same) if same.all() else int(np.argmin(same))
        yield _read(block[:count], form)
        at += count


def _read(block: Bytes, form: _Form) -> Rows:
    seconds = np.ascontiguousarray(block[:, 4:8]).view(form.order + "i4")[:, 0]
    nano = np.ascontiguousarray(block[:, 8:12]).view(form.order + "u4")[:, 0]
    values = np.full((len(block), len(form.begins), form.width), np.nan)
    for i, begin in enumerate(form.begins):
        if begin:
            part = np.ascontiguousarray(block[:, begin : begin + 8 * form.width])
            values[:, i] = part.view(form.order + "f8")
    return Rows(form.names, seconds + _NANO * nano, values)
