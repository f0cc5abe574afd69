"""A subscriber that counts: which blocks of the waveform arrived, when, and what the nodes said about themselves."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Float64MultiArray

from nw_gear_common import names
from nw_gear_common.ros import live_qos

WAVEFORM = f"{names.NAMESPACE}/{names.WAVEFORM}"
DEPTH = 100
"""Blocks that wait here while this process is busy elsewhere."""
WATCHED = ("gear_sim_node: integration", "gear_monitor_node: computation")
SHARE = "integration (share of a core)"


class Listener:
    """Takes in the waveform and the diagnostics."""

    def __init__(self) -> None:
        self.first: tuple[float, float] | None = None
        self.last = (0.0, 0.0)
        self.blocks = self.samples = self.missing = 0
        self.largest_delay = self.period = 0.0
        self.said: dict[str, dict[str, str]] = {}
        self.shares: list[float] = []

    def waveform(self, message: Float64MultiArray) -> None:
        """Take in one block: its stamps (s) against the last one's and against the clock."""
        now, moment = time.time(), time.monotonic()
        rows, columns = (dimension.size for dimension in message.layout.dim)
        stamps = np.frombuffer(message.data).reshape(rows, columns)[:, 0]
        self.period = float(stamps[-1] - stamps[0]) / (rows - 1)
        if self.first is None:
            self.first = (float(stamps[0]), moment)
        else:
            self.missing += round((float(stamps[0]) - self.last[0]) / self.period) - 1
        self.last = (float(stamps[-1]), moment)
        self.blocks += 1
        self.samples += rows
        self.largest_delay = max(self.largest_delay, now - float(stamps[-1]))

    def diagnostics(self, array: DiagnosticArray) -> None:
        """Keep the last word of each node that says how it is doing."""
        for status in array.status:
            if status.name in WATCHED:
                said = {"message": status.message, **{v.key: v.value for v in status.values}}
                self.said[status.name] = said
                if SHARE in said:
                    self.shares.append(float(said[SHARE]))

    def result(self) -> dict[str, Any]:
        """The figures of one run; the first block counts as a start of the clock alone."""
        first = self.first or (0.0, 0.0)
        simulated = self.last[0] - first[0] + self.period
        wall = self.last[1] - first[1]
        counted = simulated * (1.0 - 1.0 / max(self.blocks, 1))
        return {
            "blocks": self.blocks,
            "lost_blocks": round(self.missing * self.blocks / max(self.samples, 1)),
            "missing_samples": self.missing,
            "simulated_s": simulated,
            "real_time_factor": counted / wall if wall > 0.0 else None,
            "integration_share": float(np.median(self.shares)) if self.shares else None,
            "said": self.said,
        }


@contextmanager
def listening() -> Iterator[tuple[Listener, Callable[[float], None]]]:
    """Give a listener, and a function that takes in messages for some time (s) at most."""
    listener = Listener()
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("benchmark")
    executor = EventsExecutor()
    executor.add_node(node)
    node.create_subscription(Float64MultiArray, WAVEFORM, listener.waveform, live_qos(DEPTH))
    node.create_subscription(DiagnosticArray, names.DIAGNOSTICS, listener.diagnostics, live_qos(50))
    try:
        yield listener, lambda seconds: executor.spin_once(timeout_sec=seconds)
    finally:
        executor.remove_node(node)
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()
