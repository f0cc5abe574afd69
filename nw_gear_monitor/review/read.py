"""Reads a recording once, from begin to end, into `RunData`."""

from __future__ import annotations

import dataclasses
import time
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_monitor.records.bulk import BulkBatch, BulkReader
from nw_gear_monitor.records.chunks import Whole
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.review import windows
from nw_gear_monitor.review.gather import VIEWS, Gatherer
from nw_gear_monitor.review.rundata import RunData

SAY_EVERY = 2.0
"""Seconds between two reports of progress."""

Progress = Callable[[str], None]


def read(folder: Path, progress: Progress, zoom: Sequence[tuple[float, float]] = ()) -> RunData:
    """Read what the report shows.

    Args:
        folder: the recording; a damaged one is read through a temporary repaired copy.
        progress: called now and then with a line of words.
        zoom: begin and end of stretches to hold sample by sample, s since the start of the run.

    Raises:
        InputError: it is no recording, can't be repaired, or holds nothing of this suite; a stretch isn't in it.
    """
    gatherer = Gatherer()
    with Recording.open(folder, repair=True) as recording, BulkReader(recording) as reader:
        wanted = chosen(recording, gatherer)
        if not recording.complete:
            gatherer.remarks.append(f"The recording is damaged: {recording.damage}.")
        length = max(recording.duration, 1e-9)
        due = time.monotonic()
        for batch in reader.batches(wanted):
            feed(gatherer, batch, wanted)
            if time.monotonic() >= due:
                due = time.monotonic() + SAY_EVERY
                progress(f"reading {folder}: {100 * min(1.0, (batch.last - recording.start) / length):.0f} %")
        bounds = (recording.start, recording.end)
        topics = {name: (topic.type, topic.messages) for name, topic in recording.topics.items()}
        run = gatherer.result(folder, recording.complete, bounds, topics, recording.provenance)
        waveform = next((topic for topic, relative in wanted.items() if relative == names.WAVEFORM), "")
        choices = [*windows.asked(run, zoom), *windows.worth(run)]
        found = [windows.fetch(reader, waveform, gatherer.chunks, choice) for choice in choices]
        return dataclasses.replace(run, windows=(*(w for w in found if w is not None), *run.windows))


def chosen(recording: Recording, gatherer: Gatherer) -> dict[str, str]:
    """Topics of the recording that the report uses, each with its name relative to the namespace.

    Raises:
        InputError: there is none.
    """
    known = gatherer.topics
    space = gatherer.namespace = namespace(recording.topics, known)
    wanted = {topic: relative for topic in recording.topics if (relative := relative_to(topic, space)) in known}
    if not wanted:
        expected = f"topics of nw_gear such as {names.NAMESPACE}/{names.WAVEFORM}"
        raise InputError(str(recording.path), expected, "none of them")
    for topic, relative in list(wanted.items()):
        kind = recording.topics[topic].type
        if relative in VIEWS and kind != VIEWS[relative]:
            gatherer.remarks.append(f"Left out: {topic} is of type {kind}, not {VIEWS[relative]}.")
            del wanted[topic]
    return wanted


def feed(gatherer: Gatherer, batch: BulkBatch, wanted: Mapping[str, str]) -> None:
    """Give the messages of a chunk to the gatherer.

    Messages of views are taken in bulk: only where the run starts over does their place among the others matter.
    Collectors copy what they keep of a table.
    """
    views = {topic: batch.of(topic) for topic, relative in wanted.items() if relative in VIEWS}

    def flush(before: int | None = None) -> None:
        for topic, numbers in views.items():
            split = len(numbers) if before is None else int(np.searchsorted(numbers, before))
            if split:
                for rows in batch.rows(topic, numbers[:split]):
                    gatherer.take_rows(wanted[topic], rows)
                views[topic] = numbers[split:]

    others: Whole = batch.of(*(topic for topic, relative in wanted.items() if relative not in VIEWS))
    for number in others.tolist():
        relative, value = wanted[batch.topic(number)], batch.value(number, copy=False)
        if gatherer.starts_over(relative, value):
            flush(number)
        gatherer.take(relative, batch.log_time(number), value, batch.place)
    flush()


def namespace(topics: Collection[str], known: Collection[str]) -> str:
    """The namespace that holds most of the known topics: a run may have any, and a recording may hold other things."""
    found = Counter(
        topic.removesuffix(f"/{relative}")
        for topic in topics
        for relative in known
        if not relative.startswith("/") and topic.endswith(f"/{relative}")
    )
    return found.most_common(1)[0][0] if found else names.NAMESPACE


def relative_to(topic: str, space: str) -> str:
    """Name of a topic relative to a namespace; one outside keeps its name."""
    return topic.removeprefix(f"{space}/") if topic.startswith(f"{space}/") else topic
