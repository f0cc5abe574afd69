"""Executables as processes of their own and a node to look at what they do; for every test over real DDS.

    with running("wind_node", ["seed:=3"]) as wind, Probe() as probe:
        received = probe.collect(Vector3Stamped, "/nw_gear/wind_speed", depth=20)
        probe.wait_until(lambda: len(received) >= 10, wind)
        wind.interrupt()
        assert wind.wait() == 0

Nothing here sleeps for a fixed time: everything waits for a condition and fails with the process's output after LIMIT.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile

LIMIT = 15.0
"""Longest wait for discovery, for a message or for an exit (s)."""

FIRST_DOMAIN = 20
DOMAINS_PER_WORKER = 12
LAST_DOMAIN = 101


def domain() -> int:
    """ROS domain of this pytest worker: ROS_DOMAIN_ID (or 20) plus 12 for each worker, within what Linux permits."""
    first = int(os.environ.get("ROS_DOMAIN_ID") or FIRST_DOMAIN)
    worker = int("".join(c for c in os.environ.get("PYTEST_XDIST_WORKER", "gw0") if c.isdigit()) or 0)
    return (first + DOMAINS_PER_WORKER * worker) % (LAST_DOMAIN + 1)


def environment(ros_domain: int | None = None) -> dict[str, str]:
    """Environment of a process that talks to this worker's processes alone."""
    chosen = domain() if ros_domain is None else ros_domain
    logs = os.environ.get("ROS_LOG_DIR") or str(Path(tempfile.gettempdir()) / "nw_gear_test_logs")
    alone = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_DOMAIN_ID": str(chosen), "ROS_LOG_DIR": logs}
    return {**os.environ, **alone, "PYTHONUNBUFFERED": "1"}


def command(executable: str) -> list[str]:
    """Start of a command line for an executable: the installed script, or its entry point where it isn't installed."""
    script = Path(sys.executable).with_name(executable)
    if script.is_file():
        return [str(script)]
    return [sys.executable, "-c", f"from nw_gear_common.launcher import {executable} as run; raise SystemExit(run())"]


class Process:
    """A running executable whose two output streams are collected in files.

    Args:
        arguments: the whole command line.
        ros_domain: domain other than the worker's.
        variables: further environment variables.
    """

    def __init__(
        self, arguments: Sequence[str], ros_domain: int | None = None, variables: dict[str, str] | None = None
    ) -> None:
        self.arguments = list(arguments)
        self._out = tempfile.TemporaryFile("w+")
        self._err = tempfile.TemporaryFile("w+")
        env = {**environment(ros_domain), **(variables or {})}
        self._process = subprocess.Popen(self.arguments, stdout=self._out, stderr=self._err, text=True, env=env)

    @property
    def pid(self) -> int:
        """Process number."""
        return self._process.pid

    @property
    def code(self) -> int | None:
        """Exit code, None while running."""
        return self._process.poll()

    @property
    def stdout(self) -> str:
        """Standard output so far."""
        return _content(self._out)

    @property
    def stderr(self) -> str:
        """Standard error so far (logs of nodes go there)."""
        return _content(self._err)

    def signal(self, number: int) -> None:
        """Send a signal."""
        self._process.send_signal(number)

    def interrupt(self) -> None:
        """Send SIGINT, as Ctrl-C does."""
        self.signal(signal.SIGINT)

    def wait(self, limit: float = LIMIT) -> int:
        """Wait for the end and return the exit code; fails the test after `limit` seconds."""
        try:
            return self._process.wait(limit)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"still running after {limit:g} s:\n{self.report()}") from None

    def wait_until_signals_are_answered(self, limit: float = LIMIT) -> None:
        """Wait until SIGTERM has a handler (Linux): from then on a node promises to end well, however young it is."""
        end = time.monotonic() + limit
        status = Path(f"/proc/{self.pid}/status")
        while time.monotonic() < end and self.code is None:
            caught = next(line for line in status.read_text().splitlines() if line.startswith("SigCgt:"))
            if int(caught.split()[1], 16) >> (signal.SIGTERM - 1) & 1:
                return
            time.sleep(0.002)
        raise AssertionError(f"no handler for SIGTERM:\n{self.report()}")

    def report(self) -> str:
        """Say what ran and what it printed, for a failing test."""
        return f"{' '.join(self.arguments)} (exit code {self.code})\n{self.stdout}\n{self.stderr}"

    def close(self) -> None:
        """End the process by force if it still runs, and drop its output."""
        if self.code is None:
            self._process.terminate()
            try:
                self._process.wait(LIMIT)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait(LIMIT)
        self._out.close()
        self._err.close()


def _content(stream: Any) -> str:
    position = os.lseek(stream.fileno(), 0, os.SEEK_CUR)
    text = os.pread(stream.fileno(), position, 0)
    return text.decode(errors="replace")


@contextmanager
def running(
    executable: str,
    parameters: Sequence[str] = (),
    *,
    ros: Sequence[str] = (),
    arguments: Sequence[str] = (),
    **kwargs: Any,
) -> Iterator[Process]:
    """Start an executable for the length of a `with` block.

    Args:
        executable: name of a console script, for instance "wind_node".
        parameters: ROS parameters such as "seed:=3" (each gets its -p).
        ros: further ROS arguments such as "-r", "__ns:=/other".
        arguments: ordinary arguments, for executables that aren't nodes.
        kwargs: passed to `Process`.
    """
    given = [part for parameter in parameters for part in ("-p", parameter)]
    ros_arguments = ["--ros-args", *given, *ros] if given or ros else []
    process = Process([*command(executable), *arguments, *ros_arguments], **kwargs)
    try:
        yield process
    finally:
        process.close()


class Probe:
    """A node inside the test, with a context and an executor of its own; use it in a `with` block."""

    def __init__(self, ros_domain: int | None = None, name: str = "probe") -> None:
        self._domain = domain() if ros_domain is None else ros_domain
        self._name = name

    def __enter__(self) -> Probe:
        own = environment(self._domain)
        os.environ.update({key: own[key] for key in ("ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOG_DIR")})
        os.makedirs(own["ROS_LOG_DIR"], exist_ok=True)
        self.context = Context()
        rclpy.init(context=self.context, domain_id=self._domain)
        self.node: Node = rclpy.create_node(self._name, context=self.context)
        self._executor = SingleThreadedExecutor(context=self.context)
        self._executor.add_node(self.node)
        return self

    def __exit__(self, *_exception: object) -> None:
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self.context)

    def collect(self, kind: Any, topic: str, qos: QoSProfile | None = None, *, depth: int = 1000) -> list[Any]:
        """Subscribe and return the list into which messages will come while the probe waits."""
        received: list[Any] = []
        self.node.create_subscription(kind, topic, received.append, qos or QoSProfile(depth=depth))
        return received

    def spin_once(self, seconds: float = 0.05) -> None:
        """Dispatch what has arrived, at most one callback."""
        self._executor.spin_once(timeout_sec=seconds)

    def wait_until(self, condition: Callable[[], bool], *processes: Process, limit: float = LIMIT) -> None:
        """Dispatch messages until a condition holds; fails after `limit` seconds or when a process ended before."""
        end = time.monotonic() + limit
        while not condition():
            dead = [p for p in processes if p.code is not None]
            if (dead or time.monotonic() > end) and not condition():
                what = "ended early" if dead else f"condition not met after {limit:g} s"
                raise AssertionError("\n".join([what, *(p.report() for p in dead or processes)]))
            self.spin_once()

    def wait_for_match(self, topic: str, *processes: Process, publishers: int = 0, subscribers: int = 0) -> None:
        """Wait until a topic has at least so many publishers and subscribers."""
        self.wait_until(
            lambda: (
                self.node.count_publishers(topic) >= publishers and self.node.count_subscribers(topic) >= subscribers
            ),
            *processes,
        )

    def call(self, kind: Any, service: str, request: Any, *processes: Process, limit: float = LIMIT) -> Any:
        """Call a service and return its response."""
        client = self.node.create_client(kind, service)
        try:
            self.wait_until(client.service_is_ready, *processes, limit=limit)
            future = client.call_async(request)
            self.wait_until(future.done, *processes, limit=limit)
            return future.result()
        finally:
            self.node.destroy_client(client)
