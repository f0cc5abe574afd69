"""Executables of the suite as child processes: started, watched, ended one by one."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

from nw_gear_common.errors import NwGearError

STOP_WITHIN = 20.0
"""Seconds between SIGINT and SIGKILL: more than a node may take while its kernels compile."""


class ChildRefused(NwGearError):
    """A node refused what it was given."""

    exit_code = 2


class Process:
    """One node as a child process with its output in a log file.

    Args:
        command: executable and its parameters.
        logs: folder of the log file.
        environment: environment of the child.
    """

    def __init__(self, command: tuple[str, Mapping[str, object]], logs: Path, environment: Mapping[str, str]) -> None:
        self.name, parameters = command
        self.log = logs / f"{self.name}.log"
        arguments = [part for key, value in parameters.items() for part in ("-p", f"{key}:={_as_yaml(value)}")]
        with self.log.open("wb") as output:
            self._child = subprocess.Popen(
                [sys.executable, "-m", "nw_gear_common.launcher", self.name, "--ros-args", *arguments],
                env=dict(environment),
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

    @property
    def running(self) -> bool:
        """Whether the child is still there."""
        return self._child.poll() is None

    @property
    def code(self) -> int | None:
        """Exit code, None while it runs."""
        return self._child.poll()

    def stop(self) -> None:
        """Ask the child to end, wait for it, kill it when it doesn't."""
        if self.running:
            with contextlib.suppress(ProcessLookupError):
                self._child.send_signal(signal.SIGINT)
        try:
            self._child.wait(STOP_WITHIN)
        except subprocess.TimeoutExpired:
            self._child.kill()
            self._child.wait()

    def failure(self) -> NwGearError:
        """The error that describes how the child ended, with the last line that it wrote about it."""
        lines = self.log.read_text(errors="replace").strip().splitlines()
        own = [line for line in lines if line.startswith(f"{self.name}:")]
        reason = own[-1] if own else (lines[-1] if lines else f"{self.name}: no output")
        kind = ChildRefused if self.code == 2 else NwGearError
        return kind(reason if self.code == 2 else f"{reason} (exit code {self.code}, log {self.log})")


def stop_all(processes: Iterable[Process]) -> None:
    """End all of them, one after the other."""
    for process in processes:
        process.stop()


def _as_yaml(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    return repr(value)
