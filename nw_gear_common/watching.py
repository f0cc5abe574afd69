"""Progress of a running simulator, taken from its diagnostics and shown on standard error."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Self

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.signals import SignalHandlerOptions
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from nw_gear_common.names import DIAGNOSTICS
from nw_gear_common.ros import live_qos

STATUS = "gear_sim_node: integration"
PLAIN_PERIOD = 5.0


class Watch:
    """Follows the simulated time: a bar on a terminal, a line every few seconds elsewhere."""

    def __init__(self, duration: float) -> None:
        self._duration = duration
        self.message = "starting"
        self.simulated = 0.0
        self._console = Console(file=sys.stderr)
        self._bar: Progress | None = None
        self._next_line = 0.0

    def __enter__(self) -> Self:
        rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node("nw_gear_demo", start_parameter_services=False)
        self._node.create_subscription(DiagnosticArray, DIAGNOSTICS, self._on_diagnostics, live_qos(50))
        self._executor = EventsExecutor()
        self._executor.add_node(self._node)
        if self._console.is_terminal:
            amount = TextColumn("{task.completed:.1f}/{task.total:g} s")
            columns = (TextColumn("{task.description}"), BarColumn(), amount, TimeRemainingColumn())
            self._bar = Progress(*columns, console=self._console)
            self._task = self._bar.add_task("starting", total=self._duration)
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            if kind is None:
                self._bar.update(self._task, completed=self._duration)
            self._bar.stop()
        self._executor.remove_node(self._node)
        self._executor.shutdown()
        self._node.destroy_node()
        rclpy.try_shutdown()

    def look(self, seconds: float) -> None:
        """Take in what arrives within some seconds and show it."""
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)
        if self._bar is not None:
            self._bar.update(self._task, completed=self.simulated, description=self.message)
        elif time.monotonic() >= self._next_line:
            self._next_line = time.monotonic() + PLAIN_PERIOD
            print(f"{self.simulated:.1f} of {self._duration:g} s simulated; {self.message}", file=sys.stderr)

    def _on_diagnostics(self, array: DiagnosticArray) -> None:
        for status in array.status:
            if status.name == STATUS:
                values = {pair.key: pair.value for pair in status.values}
                self.message = status.message
                self.simulated = float(values.get("simulated (s)", self.simulated))
