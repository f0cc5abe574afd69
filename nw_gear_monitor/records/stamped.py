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


@dataclass(frozen=True, eq=False)
class Form:
    """Where the numbers of messages of one form stand.

    Attributes:
        names: of the joints.
        begins: where each part begins, 0 where there is none.
        width: numbers of a part.
        order: byte order, `<` or `>`.
        template: a message of this form.
        fixed: which of its bytes are the same in all.
    """

    names: tuple[str, ...]
    begins: tuple[int, ...]
    width: int
    order: str
    template: Bytes
    fixed: Whole

    def alike(self, block: Bytes) -> int:
        """How many of the first messages, one per row, have this form."""
        if block.shape[1] != len(self.template):
            return 0
        same = (block[:, self.fixed] == self.template[self.fixed]).all(axis=1)
        return len(same) if same.all() else int(np.argmin(same))


def form_of(data: bytes, kind: str) -> Form:
    """Walk through a message.

    Raises:
        KeyError, ValueError, struct.error: it isn't serialised as that type.
    """
    cursor = Cursor(data)
    cursor.at += 8
    cursor.text()
    joints: tuple[str, ...] = ()
    if kind == JOINTS:
        joints = tuple(cursor.text() for _ in range(min(cursor.word(), len(data))))
        width = len(joints)
        begins = tuple(_part(cursor, width) for _ in range(3))
    else:
        cursor.align(8)
        width = 3
        begins = tuple(cursor.at + 24 * i for i in range(2 if kind == WRENCH else 1))
    if max(begins) + 8 * width > len(data):
        raise ValueError("it ends within its numbers")
    fixed = np.ones(len(data), dtype=np.bool_)
    fixed[_STAMP] = False
    for begin in begins:
        if begin:
            fixed[begin : begin + 8 * width] = False
    template = np.frombuffer(data, dtype=np.uint8)
    return Form(joints, begins, width, cursor.order, template, np.flatnonzero(fixed))


def _part(cursor: Cursor, joints: int) -> int:
    """Where a part of a message about joints begins, 0 where it is left out."""
    count = cursor.word()
    if count not in (0, joints):
        raise ValueError(f"{count} numbers for {joints} joints")
    if not count:
        return 0
    cursor.align(8)
    begin = cursor.at
    cursor.at += 8 * count
    return begin


def rows(batch: Batch, chosen: Whole, kind: str, place: str, known: Form | None = None) -> Iterator[tuple[Form, Rows]]:
    """Numbers of some messages of a batch, in their order, as few pieces as their forms allow.

    Args:
        batch: of a recording.
        chosen: which messages: indices, ascending.
        kind: one of TYPES.
        place: the topic, for the error.
        known: the form of messages before, if any.

    Raises:
        InputError: a message isn't serialised as that type.
    """
    start, size = batch.start[chosen], batch.end[chosen] - batch.start[chosen]
    at = 0
    while at < len(chosen):
        alike = size[at:] == size[at]
        stop = len(chosen) if alike.all() else at + int(np.argmin(alike))
        block = batch.data[start[at:stop, None] + np.arange(size[at])]
        count = known.alike(block) if known is not None else 0
        if known is None or not count:
            try:
                known = form_of(block[0].tobytes(), kind)
            except (KeyError, ValueError, struct.error) as error:
                raise InputError(f"{place}: message", f"a serialised {kind}", str(error)) from None
            count = known.alike(block)
        yield known, _read(block[:count], known)
        at += count


def _read(block: Bytes, form: Form) -> Rows:
    seconds = np.ascontiguousarray(block[:, 4:8]).view(form.order + "i4")[:, 0]
    nano = np.ascontiguousarray(block[:, 8:12]).view(form.order + "u4")[:, 0]
    values = np.full((len(block), len(form.begins), form.width), np.nan)
    for i, begin in enumerate(form.begins):
        if begin:
            part = np.ascontiguousarray(block[:, begin : begin + 8 * form.width])
            values[:, i] = part.view(form.order + "f8")
    return Rows(form.names, seconds + _NANO * nano, values)
