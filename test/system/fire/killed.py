"""SIGKILL at random moments of a recorder's life, its start included."""

from __future__ import annotations

import signal
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from nw_gear_monitor.records.recover import recover
from test.system.fire import feeder
from test.system.fire.checks import feeding, files, opened_everywhere, recording, stamps, wait_for

FLUSH_PERIOD = 0.2
SLACK = 0.8
"""Seconds that a busy machine may add to the flush period: until a message is taken and until the timer comes."""

LONGEST_LIFE = 3.0
FROM_THE_START = 0.3
"""Share of the recorders whose life is counted from the start of their process, not of their recording."""

FILE_DURATION = 0.6


@dataclass(frozen=True)
class Death:
    """What one SIGKILL cost.

    Attributes:
        moment: when it came, s after the start of the process or of the recording.
        started: whether anything had been recorded.
        messages: in the recording after its repair.
        files: of it.
        lost: s between the last message that is left and the SIGKILL, NaN where nothing had been recorded.
        damaged: whether there was anything to repair.
    """

    moment: float
    started: bool
    messages: int
    files: int
    lost: float
    damaged: bool


def kill_many(folder: Path, runs: int, seed: int) -> list[Death]:
    """Kill so many recorders that hear the same publisher, and look at what they leave.

    Raises:
        AssertionError: more is lost than may be, or a reader refuses what was left.
    """
    random = np.random.default_rng(seed)
    deaths = []
    with feeding("--rate", 200, "--topics", 2) as source:
        wait_for(source, "feeding")
        for number in range(runs):
            early = random.random() < FROM_THE_START
            moment = float(random.uniform(0.0, LONGEST_LIFE))
            split = f"max_file_duration:={FILE_DURATION if random.random() < 0.5 else 0.0}"
            compression = f"compression:={random.choice(['zstd', 'lz4', 'none'])}"
            fsync = f"fsync:={str(bool(random.random() < 0.5)).lower()}"
            parameters = (f"flush_period:={FLUSH_PERIOD}", split, compression, fsync)
            deaths.append(_kill(folder / f"run_{number}", moment, early, parameters))
    return deaths


def _kill(folder: Path, moment: float, early: bool, parameters: tuple[str, ...]) -> Death:
    with recording(folder, *parameters) as process:
        if not early:
            wait_for(process, "recording to")
        end = time.monotonic() + moment
        while time.monotonic() < end:
            time.sleep(max(0.0, min(0.05, end - time.monotonic())))
        killed = time.monotonic()
        process.signal(signal.SIGKILL)
        process.wait()
    if not files(folder):  # before it had made its file
        return Death(moment, False, 0, 0, float("nan"), False)
    damaged = not recover(folder).healthy
    count = opened_everywhere(folder)
    times = stamps(folder, feeder.topic(1))
    lost = killed - times[-1][0] if times else float("nan")
    if times:
        assert lost < FLUSH_PERIOD + SLACK, f"{lost:.3f} s lost at {moment:.3f} s"
        numbers = [number for _time, number in times]
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    return Death(moment, bool(times), count, len(files(folder)), lost, damaged)
