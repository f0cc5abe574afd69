"""Folders that can't be written: a disk that fills up, one that is read-only, a folder that another recorder has."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from nw_gear_monitor.records.recover import recover
from test.system.fire import feeder
from test.system.fire.checks import feeding, lines, losses, missing, opened_everywhere, recording, stamps, wait_for

FLUSH_PERIOD = 0.1
DISK = 4 * 2**20
ENDS_WITHIN = 60.0


class CannotMount(Exception):
    """No right to mount a file system here; the text is the reason."""


@contextmanager
def mounted(folder: Path, options: str) -> Iterator[Path]:
    """A tmpfs of its own for the length of a `with` block.

    Raises:
        CannotMount: nobody but root may do that, and not in every container.
    """
    folder.mkdir()
    if os.geteuid():
        raise CannotMount("only root may mount a file system")
    command = ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise CannotMount(done.stderr.strip())
    try:
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def full_disk(place: Path) -> dict[str, Any]:
    """A disk of four megabytes fills up under a recorder: it says so, ends, and what it wrote can be repaired."""
    with mounted(place / "small", f"size={DISK}") as disk, feeding("--rate", 100, "--size", 20_000) as source:
        with recording(disk / "run", f"flush_period:={FLUSH_PERIOD}", "compression:=none") as process:
            code = process.wait(ENDS_WITHIN)
            ended = time.monotonic()
            assert source.code is None, source.report()
            assert code == 1, process.report()
            said = lines(process)
        assert "No space left on device" in said[-1], said
        assert "nw_gear recover" in said[-1], said
        assert not any("Traceback" in line for line in said)
        recover(disk / "run", place / "repaired")
    count = opened_everywhere(place / "repaired", repair=False)
    found = stamps(place / "repaired", feeder.topic(0))
    assert missing([number for _time, number in found]) == 0
    used = sum(path.stat().st_size for path in (place / "repaired").glob("*.mcap"))
    assert used > DISK // 2
    return {"messages": count, "lost_s": ended - found[-1][0], "said": said[-1].partition(": ")[2], "bytes": used}


def read_only_folder(place: Path) -> dict[str, Any]:
    """A recorder whose folder can't be made says so in one line, and leaves nothing."""
    with mounted(place / "fixed", "ro,size=1m") as disk, recording(disk / "run") as process:
        assert process.wait() == 2, process.report()
        said = lines(process)
        assert len(said) == 1, said
        assert "Read-only file system" in said[0]
        assert not list(disk.iterdir())
    return {"said": said[0].partition(": ")[2]}


def two_recorders(place: Path) -> dict[str, Any]:
    """The second recorder to a folder is refused; the first one doesn't notice."""
    folder = place / "run"
    with feeding("--rate", 100), recording(folder) as first:
        wait_for(first, "recording to")
        with recording(folder) as second:
            assert second.wait() == 2, second.report()
            said = lines(second)
            assert len(said) == 1, said
        assert "a new folder, got one that exists" in said[0]
        first.signal(signal.SIGINT)
        assert first.wait() == 0, first.report()
    count = opened_everywhere(folder, repair=False)
    assert losses(folder) == {}
    assert missing([number for _time, number in stamps(folder, feeder.topic(0))]) == 0
    return {"messages": count, "said": said[0].partition(": ")[2]}
