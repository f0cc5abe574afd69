"""Executables of the suite as processes whose CPU time and memory are known when they have ended."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

BIN = Path(sys.executable).parent
END_LIMIT = 30.0
Parameters = dict[str, str]


class Child:
    """One executable as a process."""

    def __init__(self, name: str, parameters: Parameters, log: Path) -> None:
        self.name = name
        self.log = log
        arguments = [part for key, value in parameters.items() for part in ("-p", f"{key}:={value}")]
        self.began = time.monotonic()
        with log.open("wb") as output:
            command = [str(BIN / name), "--ros-args", *arguments]
            self._process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
        self.cpu = self.share = self.memory = float("nan")
        self.code: int | None = None

    @property
    def pid(self) -> int:
        """Process number."""
        return self._process.pid

    def look(self) -> bool:
        """Whether it still runs; once it has ended notes exit code, CPU time (s), share of a core, memory (MB)."""
        if self.code is None:
            pid, status, usage = os.wait4(self._process.pid, os.WNOHANG)
            if pid:
                self.code = self._process.returncode = os.waitstatus_to_exitcode(status)
                self.cpu = usage.ru_utime + usage.ru_stime
                self.share = self.cpu / (time.monotonic() - self.began)
                self.memory = usage.ru_maxrss * 1024 / 1e6
        return self.code is None

    def stop(self) -> None:
        """Ask it to end and wait; kill it after END_LIMIT."""
        if self.look():
            self._process.send_signal(signal.SIGINT)
        end = time.monotonic() + END_LIMIT
        while self.look():
            if time.monotonic() > end:
                self._process.kill()
            time.sleep(0.05)


def stop_all(children: list[Child]) -> None:
    """End them all, a recorder last, so that it has everything."""
    for child in sorted(children, key=lambda child: child.name == "recorder_node"):
        child.stop()
