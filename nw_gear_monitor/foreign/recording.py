"""Writes a waveform into a new recording, as the recorder would have."""

from __future__ import annotations

import sys
from pathlib import Path

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.records.cdr import TABLE_TYPE, from_table
from nw_gear_monitor.records.definitions import define
from nw_gear_monitor.records.metadata import TopicEntry
from nw_gear_monitor.records.provenance import run_record
from nw_gear_monitor.records.qos import Qos
from nw_gear_monitor.records.schema import PROVENANCE, RUN
from nw_gear_monitor.records.writer import RecordingWriter

MACHINE = f"{PROVENANCE}machine"
"""Metadata record with the description of the machine that was measured, and where the samples come from."""

NANO = 1e9


def write(folder: Path, table: Table, rate: float, about: dict[str, str]) -> int:
    """Write a recording with the topic `waveform` in blocks; the log time of a block is that of its last sample.

    Args:
        folder: new folder.
        table: the samples.
        rate: of them, Hz.
        about: content of the metadata record MACHINE.

    Returns:
        Number of blocks.

    Raises:
        InputError: the folder exists, or can't be made; ROS' definition of the table's type isn't installed.
    """
    definition = define(TABLE_TYPE)
    writer = RecordingWriter(folder)
    writer.add_metadata(RUN, run_record(sys.argv, ""))
    writer.add_metadata(MACHINE, about)
    entry = TopicEntry(f"{names.NAMESPACE}/{names.WAVEFORM}", TABLE_TYPE, definition.type_hash, (Qos(),))
    topic = writer.add_topic(entry, definition.text)
    rows = max(round(rate / names.WAVEFORM_BLOCKS_PER_SECOND), 2)
    starts = range(0, len(table) - 1, rows)  # a last block of one row would tell no sample rate
    for number, start in enumerate(starts, start=1):
        last = len(table) if number == len(starts) else start + rows
        block = Table(table.row, table.columns, table.data[start:last])
        moment = round(NANO * float(block.data[-1, 0]))
        writer.write(topic, from_table(block), moment, moment, number)
    writer.close()
    return len(starts)
