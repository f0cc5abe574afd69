"""An hour's recording made of a short one: every message again and again, with its times moved on.

The writer is the recorder's. Samples are scaled from copy to copy, so that no two stretches are the same bytes, and one
copy is larger than all others, so that there is a largest event to find.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.records.cdr import TABLE_TYPE, from_table, to_table
from nw_gear_monitor.records.definitions import define
from nw_gear_monitor.records.metadata import TopicEntry
from nw_gear_monitor.records.reader import RawMessage, Recording
from nw_gear_monitor.records.writer import RecordingWriter

NANO = 1_000_000_000
STAMP = struct.Struct("<iI")
SWAY = 0.1
"""Samples of copy k are scaled by 1 + SWAY sin(2 pi k / copies)."""
EVENT = 1.5
"""Factor of the largest copy, three quarters through the hour."""
UNSTAMPED = (names.SPECTRUM, names.ORDERS, names.TRUTH, names.CLOCK)

Progress = Callable[[str], None]


def make(source: Path, folder: Path, seconds: float, say: Progress) -> int:
    """Write the long recording; returns the number of values in its waveform.

    Args:
        source: a recording of the demo.
        folder: new folder.
        seconds: how long it becomes, rounded up to whole copies.
        say: called now and then with words.
    """
    with Recording.open(source) as recording:
        waveform = f"{names.NAMESPACE}/{names.WAVEFORM}"
        blocks = [(time, table.data) for time, table in recording.tables(waveform)]
        data = np.concatenate([block for _, block in blocks])
        rate = (len(data) - 1) / (data[-1, 0] - data[0, 0])
        period = len(data) / rate
        turned = (data[-1, 1:4] - data[0, 1:4]) * len(data) / (len(data) - 1)
        first, last = blocks[0][0], blocks[-1][0]
        writer = RecordingWriter(folder)
        for name, content in recording.provenance.items():
            writer.add_metadata(name, content)
        numbers = {t: writer.add_topic(TopicEntry(t, k.type), define(k.type).text) for t, k in recording.topics.items()}
        kept = [m for m in recording.raw() if first - period < 1e-9 * m.log_time <= last + 0.01]
        copies = math.ceil(seconds / period)
        for k in range(copies):
            say(f"writing {k * period:.0f} of {seconds:.0f} s")
            factor = EVENT if k == 3 * copies // 4 else 1.0 + SWAY * math.sin(2.0 * math.pi * k / copies)
            shift = round(NANO * k * period)
            for message in kept:
                if k and 1e-9 * message.log_time < first:
                    continue
                payload = moved(message, recording.topics[message.topic].type, k, shift, turned, factor)
                writer.write(numbers[message.topic], payload, message.log_time + shift, message.publish_time + shift)
        writer.close()
    return int(copies * data.size)


def moved(message: RawMessage, kind: str, k: int, shift: int, turned: np.ndarray, factor: float) -> bytes:
    """One message of copy k, `shift` ns later."""
    relative = message.topic.removeprefix(f"{names.NAMESPACE}/")
    if relative in UNSTAMPED or not k:
        return message.data
    if kind != TABLE_TYPE:
        seconds, nano = STAMP.unpack_from(message.data, 4)
        later = seconds * NANO + nano + shift
        return message.data[:4] + STAMP.pack(later // NANO, later % NANO) + message.data[12:]
    table = to_table(message.data, message.topic)
    data = table.data.copy()
    data[:, 0] += 1e-9 * shift
    if relative == names.WAVEFORM:
        data[:, 1:4] += k * turned
        data[:, 4:] *= factor
    elif relative == names.ACCELERATION:
        data[:, 1:] *= factor
    return from_table(Table(table.row, table.columns, data))
