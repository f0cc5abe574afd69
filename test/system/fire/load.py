"""More topics and more bytes than a recorder is made for: what doesn't get through is counted."""

from __future__ import annotations

import json
import shutil
import signal
import time
from pathlib import Path
from typing import Any

from nw_gear_monitor.records.reader import Recording
from test.system.fire import feeder
from test.system.fire.checks import feeding, losses, missing, opened_everywhere, recording, stamps
from test.system.processes import Process

FREE = 2 * 2**30
"""Bytes that stay free on the disk."""

MEGABYTE = 1_000_000
SETTLES_WITHIN = 120.0


def many_topics(place: Path, topics: int = 200, rate: float = 5.0, seconds: float = 4.0) -> dict[str, Any]:
    """Two hundred topics at once: all are found, and none loses a message unseen."""
    folder = place / "run"
    with feeding("--topics", topics, "--rate", rate, "--seconds", seconds, "--size", 200) as source:
        with recording(folder) as process:
            _ended(source)
            process.signal(signal.SIGINT)
            assert process.wait(SETTLES_WITHIN) == 0, process.report()
        sent = json.loads(source.stdout.splitlines()[-1])
    opened_everywhere(folder, repair=False)
    said = losses(folder)
    with Recording.open(folder) as found:
        recorded = {name: topic.messages for name, topic in found.topics.items() if "/fed_" in name}
    assert len(recorded) == topics
    for name, count in recorded.items():
        lost = said.get(name, {"lost": 0})["lost"]
        assert count + lost == sent["sent"], (name, count, lost, sent)
    return {"topics": topics, "sent": sent["sent"] * topics, "recorded": sum(recorded.values())}


def heavy(place: Path, megabytes_per_second: float = 100.0, seconds: float = 60.0) -> dict[str, Any]:
    """Messages of a megabyte each as fast as that: everything is in the file, or counted as lost."""
    room = shutil.disk_usage(place).free - FREE
    seconds = min(seconds, room / (megabytes_per_second * MEGABYTE))
    assert seconds > 1.0, "less than two gigabytes are free"
    folder = place / "run"
    arguments = ("--size", MEGABYTE, "--rate", megabytes_per_second, "--seconds", seconds, "--depth", 50)
    with feeding(*arguments) as source, recording(folder, "max_file_size:=1000000000") as process:
        _ended(source, seconds + SETTLES_WITHIN)
        process.signal(signal.SIGINT)
        assert process.wait(SETTLES_WITHIN) == 0, process.report()
        sent = json.loads(source.stdout.splitlines()[-1])
    count = opened_everywhere(folder, repair=False)
    numbers = [number for _time, number in stamps(folder, feeder.topic(0))]
    counted = losses(folder).get(feeder.topic(0), {"lost": 0})["lost"]
    assert missing(numbers) == counted, (missing(numbers), counted)
    return {
        "seconds": sent["seconds"],
        "sent": sent["sent"],
        "megabytes_per_second": sent["sent"] / sent["seconds"],
        "recorded": len(numbers),
        "lost": counted,
        "before_the_first": numbers[0] - 1,
        "after_the_last": sent["sent"] - numbers[-1],
        "files": len(list(folder.glob("*.mcap"))),
        "messages": count,
    }


def _ended(source: Process, limit: float = SETTLES_WITHIN) -> None:
    end = time.monotonic() + limit
    while source.code is None:
        assert time.monotonic() < end, source.report()
        time.sleep(0.05)
