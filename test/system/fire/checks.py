"""Whether a recording opens in every reader, and what is in it."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from mcap.reader import make_reader
from rosbags.rosbag2 import Reader

from nw_gear_monitor.records.reader import Recording
from nw_gear_monitor.records.recover import recover
from test.system.processes import Process, running

ROOT = Path(__file__).resolve().parents[3]
NODE = ROOT / "test" / "node"
NODE_LIMIT = 300.0
NODE_LARGEST = 30_000_000
"""Bytes; its decompression in JavaScript takes some ten seconds for as much; larger files are left to the others."""

STARTS_WITHIN = 60.0


@contextmanager
def feeding(*arguments: Any) -> Iterator[Process]:
    """A feeder for the length of a `with` block."""
    process = Process([sys.executable, "-m", "test.system.fire.feeder", *map(str, arguments)])
    try:
        yield process
    finally:
        process.close()


def recording(folder: Path, *parameters: str, **kwargs: Any) -> Any:
    """A recorder for the length of a `with` block."""
    return running("recorder_node", [f"uri:={folder}", *parameters], **kwargs)


def wait_for(process: Process, word: str) -> None:
    """Wait until a process has printed a word."""
    end = time.monotonic() + STARTS_WITHIN
    while word not in process.stdout:
        assert process.code is None, process.report()
        assert time.monotonic() < end, process.report()
        time.sleep(0.005)


def lines(process: Process) -> list[str]:
    """What a node said on standard error, without the middleware's own complaints (which come in colours)."""
    return [line for line in process.stderr.splitlines() if "\x1b" not in line and line.strip()]


def files(folder: Path) -> list[Path]:
    """MCAP files of a recording."""
    return sorted(folder.glob("*.mcap"))


def opened_everywhere(folder: Path, repair: bool = True) -> int:
    """Repair a recording, read all of it with every reader, hold them against each other; messages in it."""
    if repair:
        recover(folder)
    with Recording.open(folder) as found:
        assert found.complete, found.damage
        count = sum(1 for _message in found.raw())
        assert found.message_count == count
    with Reader(folder) as reader:
        assert sum(1 for _message in reader.messages()) == count
    counts = {path: _by_mcap(path) for path in files(folder)}
    assert sum(counts.values()) == count
    if NODE.joinpath("node_modules").is_dir() and shutil.which("node"):
        for path, wanted in counts.items():
            assert path.stat().st_size > NODE_LARGEST or _by_node(path) == wanted, path
    return count


def _by_mcap(path: Path) -> int:
    with path.open("rb") as stream:
        return sum(1 for _message in make_reader(stream, validate_crcs=True).iter_messages(log_time_order=False))


def _by_node(path: Path) -> int:
    command = ["node", str(NODE / "read.mjs"), str(path), "count"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=NODE_LIMIT, check=False)
    assert done.returncode == 0, done.stderr
    return sum(topic["count"] for topic in json.loads(done.stdout)["topics"].values())


def stamps(folder: Path, topic: str) -> list[tuple[float, int]]:
    """Times at which the messages of a fed topic were sent (s, monotonic), and their numbers."""
    with Recording.open(folder) as found:
        if topic not in found.topics:
            return []
        return [(float(t.data[0, 0]), int(t.data[1, 0])) for _time, t in found.tables(topic)]


def losses(folder: Path) -> dict[str, Any]:
    """What the recording itself says is missing: topic to counts, or to why it isn't recorded."""
    with Recording.open(folder) as found:
        said = found.provenance["nw_gear.loss"]
    return {topic: json.loads(text) if text.startswith("{") else text for topic, text in said.items()}


def missing(numbers: Sequence[int]) -> int:
    """How many numbers are missing between the first and the last."""
    return numbers[-1] - numbers[0] + 1 - len(numbers) if numbers else 0
