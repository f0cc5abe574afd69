"""The nodes of the suite as processes that can be ended and started again by name, with their memory over time."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

BIN = Path(sys.executable).parent
END_LIMIT = 30.0
WARM_UP = 0.3
"""Share of a process's life that is left out of its growth: caches and queues fill."""


@dataclass
class Run:
    """One process of a node: its name and number, when it began (s), and its memory (MB) over its age (s)."""

    name: str
    process: subprocess.Popen[bytes]
    began: float
    ages: list[float] = field(default_factory=list)
    sizes: list[float] = field(default_factory=list)

    def sample(self) -> None:
        """Note the memory that is resident now; nothing where the process has ended."""
        try:
            status = Path(f"/proc/{self.process.pid}/status").read_text()
        except OSError:
            return
        size = [line.split()[1] for line in status.splitlines() if line.startswith("VmRSS:")]
        if size:
            self.ages.append(time.monotonic() - self.began)
            self.sizes.append(float(size[0]) * 1024 / 1e6)

    def growth(self) -> tuple[float, float, float]:
        """Return memory (MB) after the warm-up and at the end, and the slope between (MB an hour)."""
        ages, sizes = np.array(self.ages), np.array(self.sizes)
        warm = ages >= WARM_UP * ages[-1]
        if np.count_nonzero(warm) < 3:
            return float(sizes[0]), float(sizes[-1]), float("nan")
        slope = np.polyfit(ages[warm] / 3600.0, sizes[warm], 1)[0]
        return float(sizes[warm][0]), float(sizes[-1]), float(slope)


class Suite:
    """All nodes, in a folder of their own.

    Args:
        folder: of logs and recordings.
        parameters: of each node by its name, in the order in which they start.
    """

    def __init__(self, folder: Path, parameters: dict[str, dict[str, str]]) -> None:
        self.folder = folder
        self.names = tuple(parameters)
        self.recordings: list[Path] = []
        self.ended: list[Run] = []
        self.codes: list[tuple[str, int]] = []
        self._parameters = parameters
        self._runs: dict[str, Run] = {}

    def start(self, name: str) -> None:
        """Start a node; a recorder gets a new folder."""
        given = dict(self._parameters[name])
        if name == "recorder_node":
            self.recordings.append(self.folder / f"recording_{len(self.recordings) + 1}")
            given["uri"] = str(self.recordings[-1])
        arguments = [part for key, value in given.items() for part in ("-p", f"{key}:={value}")]
        with self.log(name).open("ab") as output:
            command = [str(BIN / name), "--ros-args", *arguments]
            process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
        self._runs[name] = Run(name, process, time.monotonic())

    def stop(self, name: str) -> None:
        """End a node as a service manager does, and keep its exit code; it is killed where it doesn't end."""
        run = self._runs.pop(name)
        if run.process.poll() is None:
            run.process.send_signal(signal.SIGTERM)
        try:
            run.process.wait(END_LIMIT)
        except subprocess.TimeoutExpired:
            run.process.kill()
            run.process.wait()
        self.ended.append(run)
        self.codes.append((name, run.process.returncode))

    def stop_all(self) -> None:
        """End what runs, a recorder last, so that it has everything."""
        for name in sorted(self._runs, key=lambda name: name == "recorder_node"):
            self.stop(name)

    def sample(self) -> None:
        """Note everybody's memory."""
        for run in self._runs.values():
            run.sample()

    def dead(self) -> list[str]:
        """Names of nodes that ended by themselves."""
        return [name for name, run in self._runs.items() if run.process.poll() is not None]

    def log(self, name: str) -> Path:
        """The file with a node's output."""
        return self.folder / f"{name}.log"


def apart() -> None:
    """Put this process and its children into a ROS domain of their own on the loopback interface."""
    os.environ.setdefault("ROS_DOMAIN_ID", str(1 + os.getpid() % 100))
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
