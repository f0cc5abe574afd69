"""Reads a recording once, from begin to end, into `RunData`."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Collection
from pathlib import Path

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.review.gather import Gatherer
from nw_gear_monitor.review.rundata import RunData

SAY_EVERY = 2.0
"""Seconds between two reports of progress."""


def read(folder: Path, progress: Callable[[str], None]) -> RunData:
    """Read what the report shows.

    Args:
        folder: the recording; a damaged one is read through a temporary repaired copy.
        progress: called now and then with a line of words.

    Raises:
        InputError: it is no recording, can't be repaired, or holds nothing of this suite.
    """
    gatherer = Gatherer()
    with Recording.open(folder, repair=True) as recording:
        known = gatherer.topics
        space = namespace(recording.topics, known)
        wanted = {topic: relative for topic in recording.topics if (relative := relative_to(topic, space)) in known}
        if not wanted:
            raise InputError(
                str(folder), f"topics of nw_gear such as {names.NAMESPACE}/{names.WAVEFORM}", "none of them"
            )
        if not recording.complete:
            gatherer.remarks.append(f"The recording is damaged: {recording.damage}.")
        length = max(recording.duration, 1e-9)
        due = time.monotonic()
        for topic, log_time, value in recording.read(wanted):
            gatherer.take(wanted[topic], log_time, value)
            if time.monotonic() >= due:
                due = time.monotonic() + SAY_EVERY
                progress(f"reading {folder}: {100 * min(1.0, (log_time - recording.start) / length):.0f} %")
        bounds = (recording.start, recording.end)
        topics = {name: (topic.type, topic.messages) for name, topic in recording.topics.items()}
        return gatherer.result(folder, recording.complete, bounds, topics, recording.provenance)


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
