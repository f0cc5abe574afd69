"""Entry points of the executables: answer signals first, import the heavy libraries second.

A console script imports only this light module, so that SIGINT and SIGTERM already end a process cleanly while rclpy
and numba are still being imported. Nothing is open at that time, hence `os._exit`. `python -m nw_gear_common.launcher
NAME ...` does the same without an installed script.
"""

from __future__ import annotations

import importlib
import os
import signal
import sys
from types import FrameType

NODES = {
    "wind_node": "nw_gear_sim.nodes.wind_node",
    "gear_sim_node": "nw_gear_sim.nodes.gear_sim_node",
    "gear_monitor_node": "nw_gear_monitor.nodes.gear_monitor_node",
    "recorder_node": "nw_gear_monitor.nodes.recorder_node",
    "replay_node": "nw_gear_monitor.nodes.replay_node",
    "dashboard_node": "nw_gear_monitor.nodes.dashboard_node",
}
"""Module of each node; it has `main(argv)` and its parameters as `Settings`."""

SIGNALS = (signal.SIGINT, signal.SIGTERM)


def _leave_with_zero(_number: int, _frame: FrameType | None) -> None:
    os._exit(0)


def _leave_with_signal(number: int, _frame: FrameType | None) -> None:
    os._exit(128 + number)


def _use_one_thread_for_matrices() -> None:
    """Matrices are small here: more threads only burn processor time that the integration needs."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def _run_node(name: str) -> int:
    _use_one_thread_for_matrices()
    for number in SIGNALS:
        signal.signal(number, _leave_with_zero)
    return int(importlib.import_module(NODES[name]).main(sys.argv))


def wind_node() -> int:
    """Start the wind."""
    return _run_node("wind_node")


def gear_sim_node() -> int:
    """Start the gearbox."""
    return _run_node("gear_sim_node")


def gear_monitor_node() -> int:
    """Start the monitor."""
    return _run_node("gear_monitor_node")


def recorder_node() -> int:
    """Start the recorder."""
    return _run_node("recorder_node")


def replay_node() -> int:
    """Start the replay."""
    return _run_node("replay_node")


def dashboard_node() -> int:
    """Start the live page."""
    return _run_node("dashboard_node")


def nw_gear() -> int:
    """Run the command line."""
    _use_one_thread_for_matrices()
    for number in SIGNALS:
        signal.signal(number, _leave_with_signal)
    return int(importlib.import_module("nw_gear_common.cli").main(sys.argv[1:]))


if __name__ == "__main__":
    command = sys.argv.pop(1)
    sys.exit(nw_gear() if command == "nw_gear" else _run_node(command))
