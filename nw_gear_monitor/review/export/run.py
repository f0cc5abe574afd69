"""Writes the tables of a recording into a folder, chunk by chunk."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import pyarrow

from nw_gear_common import __version__, names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Table
from nw_gear_monitor.records.bulk import BulkBatch, BulkReader, stamped
from nw_gear_monitor.records.cdr import TABLE_TYPE
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.review.export import tidy_topics
from nw_gear_monitor.review.export.sinks import Sinks
from nw_gear_monitor.review.gather import Gatherer
from nw_gear_monitor.review.read import SAY_EVERY, namespace, relative_to

DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"
STATUS = "diagnostic_msgs/msg/DiagnosticStatus"

Progress = Callable[[str], None]


def export(source: Path, folder: Path, kind: str, progress: Progress) -> tuple[dict[str, int], list[str]]:
    """Write every topic whose type is known as a table; the folder is there when all of it is whole.

    Everything that was recorded is written, in the order of recording, also where a run was restarted.

    Args:
        source: the recording.
        folder: new or empty.
        kind: `parquet` or `csv`.
        progress: called now and then with a line of words.

    Returns:
        File -> rows, and remarks: damage, and topics that were left out.

    Raises:
        InputError: not a recording; no room.
    """
    with Recording.open(source, repair=True) as recording, BulkReader(recording) as reader:
        space = namespace(recording.topics, Gatherer().topics)
        remarks = [] if recording.complete else [f"The recording is damaged: {recording.damage}."]
        kinds = {topic: about.type for topic, about in recording.topics.items()}
        known = {topic: relative_to(topic, space) for topic, type_ in kinds.items() if _known(type_)}
        left = sorted(f"{t} ({k})" for t, k in kinds.items() if t not in known and recording.topics[t].messages)
        if left:
            remarks.append(f"Left out, since there is no table for their types: {', '.join(left)}.")
        partial = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
        try:
            sinks = Sinks(partial, kind, _about(recording, source))
            due, length = time.monotonic(), max(recording.duration, 1e-9)
            for batch in reader.batches(set(known)):
                _feed(sinks, batch, known, kinds)
                if time.monotonic() >= due:
                    due = time.monotonic() + SAY_EVERY
                    progress(f"writing {folder}: {100 * min(1.0, (batch.last - recording.start) / length):.0f} %")
            files = sinks.close()
            _put(partial, folder)
        except (OSError, pyarrow.ArrowException) as error:
            words = (error.strerror if isinstance(error, OSError) else None) or str(error)
            raise InputError(f"-o {folder}", "a folder with room for the data", words) from None
        finally:
            shutil.rmtree(partial, ignore_errors=True)
    return files, remarks


def _known(kind: str) -> bool:
    return kind in (TABLE_TYPE, DIAGNOSTICS, STATUS) or stamped(kind)


def _about(recording: Recording, source: Path) -> dict[str, str]:
    """Where the data come from: goes into every Parquet file."""
    return {
        "source": source.resolve().name if source.name != "recording" else source.resolve().parent.name,
        "nw_gear": __version__,
        "complete": json.dumps(recording.complete),
        "provenance": json.dumps(recording.provenance),
    }


def _put(partial: Path, folder: Path) -> None:
    """Give the finished folder its name."""
    mask = os.umask(0)
    os.umask(mask)
    partial.chmod(0o777 & ~mask)
    partial.replace(folder)


def _feed(sinks: Sinks, batch: BulkBatch, known: Mapping[str, str], kinds: Mapping[str, str]) -> None:
    others = []
    for topic, relative in known.items():
        numbers = batch.of(topic)
        if not len(numbers):
            continue
        if stamped(kinds[topic]):
            for rows in batch.rows(topic, numbers):
                tidy_topics.add_rows(sinks.add, relative, kinds[topic], rows)
        else:
            others.append(topic)
    for number in batch.of(*others).tolist() if others else []:
        log_time, topic, value = batch.log_time(number), batch.topic(number), batch.value(number)
        if isinstance(value, Table):
            tidy_topics.add_table(sinks.add, known[topic], log_time, value)
        elif kinds[topic] == DIAGNOSTICS:
            tidy_topics.add_diagnostics(sinks.add, value)
        elif kinds[topic] == STATUS and known[topic] == names.TRUTH:
            tidy_topics.add_truth(sinks.add, log_time, value)
