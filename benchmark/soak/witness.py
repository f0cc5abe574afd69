"""Somebody who listens to the whole suite: is the waveform contiguous, and what does each node say about itself."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Float64MultiArray

from nw_gear_common import names
from nw_gear_common.ros import live_qos

WAVEFORM = f"{names.NAMESPACE}/{names.WAVEFORM}"
DEPTH = 200
OK, WARN, ERROR, STALE = range(4)


class Witness:
    """What was heard.

    Attributes:
        blocks, samples: of the waveform; gaps: number of places where samples are missing, and how many are.
    """

    def __init__(self) -> None:
        self.blocks = self.samples = self.gaps = self.missing = 0
        self._last = self._period = float("nan")
        self._said: dict[str, tuple[float, int, str, dict[str, str]]] = {}

    def expect_a_break(self) -> None:
        """Begin anew with the next block: the simulator is started again."""
        self._last = float("nan")

    def waveform(self, message: Float64MultiArray) -> None:
        """Take in a block."""
        rows, columns = (dimension.size for dimension in message.layout.dim)
        stamps = np.frombuffer(message.data).reshape(rows, columns)[:, 0]
        self._period = float(stamps[-1] - stamps[0]) / (rows - 1)
        lost = 0 if np.isnan(self._last) else round((float(stamps[0]) - self._last) / self._period) - 1
        self.gaps += lost != 0
        self.missing += lost
        self._last = float(stamps[-1])
        self.blocks += 1
        self.samples += rows

    def diagnostics(self, array: DiagnosticArray) -> None:
        """Keep the last word of everybody."""
        for status in array.status:
            values = {pair.key: pair.value for pair in status.values}
            self._said[status.name] = (time.monotonic(), status.level[0], status.message, values)

    def level(self, status: str) -> int | None:
        """Level of a status, None where nobody said it within the last three seconds."""
        moment, level, _message, _values = self._said.get(status, (float("-inf"), 0, "", {}))
        return level if time.monotonic() - moment < 3.0 else None

    def message(self, status: str) -> str:
        """Words of a status."""
        return self._said[status][2] if status in self._said else ""

    def value(self, status: str, key: str) -> float:
        """A number of a status, NaN where there is none."""
        return float(self._said[status][3].get(key, "nan")) if status in self._said else float("nan")


@contextmanager
def witnessing() -> Iterator[Witness]:
    """Give a witness who listens in a thread of its own."""
    witness = Witness()
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("soak_witness")
    executor = EventsExecutor()
    executor.add_node(node)
    node.create_subscription(Float64MultiArray, WAVEFORM, witness.waveform, live_qos(DEPTH))
    node.create_subscription(DiagnosticArray, names.DIAGNOSTICS, witness.diagnostics, live_qos(100))
    over = threading.Event()

    def listen() -> None:
        while not over.is_set():
            executor.spin_once(timeout_sec=0.2)

    thread = threading.Thread(target=listen)
    thread.start()
    try:
        yield witness
    finally:
        over.set()
        thread.join()
        executor.remove_node(node)
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()
