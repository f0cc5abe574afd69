"""The whole suite in real time, measured: lost blocks, simulated against wall time, CPU of each process.

Starts wind, gearbox, monitor and recorder as processes, subscribes to the waveform beside them, and prints a table
and one JSON object. A measurement, not a test: nothing passes or fails here.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Float64MultiArray

from nw_gear_common import names
from nw_gear_common.ros import live_qos

BIN = Path(sys.executable).parent
WAVEFORM = f"{names.NAMESPACE}/{names.WAVEFORM}"
START_LIMIT = 120.0
END_LIMIT = 30.0
SUBSCRIBERS = 3
WATCHED = ("gear_sim_node: integration", "gear_monitor_node: computation")


class Child:
    """One executable as a process whose CPU time is known when it has ended."""

    def __init__(self, name: str, parameters: dict[str, str], log: Path) -> None:
        self.name = name
        arguments = [part for key, value in parameters.items() for part in ("-p", f"{key}:={value}")]
        with log.open("wb") as output:
            command = [str(BIN / name), "--ros-args", *arguments]
            self._process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
        self._began = time.monotonic()
        self.cpu = float("nan")
        self.share = float("nan")
        self.code: int | None = None

    def look(self) -> bool:
        """Whether it still runs; notes CPU time (s), its share of the life (1) and exit code when it has ended."""
        if self.code is None:
            pid, status, usage = os.wait4(self._process.pid, os.WNOHANG)
            if pid:
                self.code = self._process.returncode = os.waitstatus_to_exitcode(status)
                self.cpu = usage.ru_utime + usage.ru_stime
                self.share = self.cpu / (time.monotonic() - self._began)
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


@dataclass
class Listener:
    """What arrived at a subscriber of the waveform, and what the nodes said about themselves."""

    first: tuple[float, float] | None = None
    last: tuple[float, float] = (0.0, 0.0)
    blocks: int = 0
    samples: int = 0
    missing: int = 0
    largest_delay: float = 0.0
    period: float = 0.0
    said: dict[str, dict[str, str]] = field(default_factory=dict)

    def waveform(self, message: Float64MultiArray) -> None:
        """Take in one block: its stamps (s) against the last one's and against the clock."""
        now = time.time()
        rows, columns = (dimension.size for dimension in message.layout.dim)
        stamps = np.frombuffer(message.data).reshape(rows, columns)[:, 0]
        self.period = float(stamps[-1] - stamps[0]) / (rows - 1)
        if self.first is None:
            self.first = (float(stamps[0]), now)
        else:
            self.missing += round((float(stamps[0]) - self.last[0]) / self.period) - 1
        self.last = (float(stamps[-1]), now)
        self.blocks += 1
        self.samples += rows
        self.largest_delay = max(self.largest_delay, now - float(stamps[-1]))

    def diagnostics(self, array: DiagnosticArray) -> None:
        """Keep the last word of each node that says how it is doing."""
        for status in array.status:
            if status.name in WATCHED:
                self.said[status.name] = {"message": status.message, **{v.key: v.value for v in status.values}}

    def result(self) -> dict[str, Any]:
        """The figures of one run."""
        first = self.first or (0.0, 0.0)
        simulated = self.last[0] - first[0] + self.period
        return {
            "blocks": self.blocks,
            "lost_blocks": round(self.missing * self.blocks / max(self.samples, 1)),
            "missing_samples": self.missing,
            "simulated_s": simulated,
            "wall_s": self.last[1] - first[1] + simulated / max(self.blocks, 1),
            "delay_at_end_s": self.last[1] - self.last[0],
            "largest_delay_s": self.largest_delay,
            "said": self.said,
        }


def start(folder: Path, duration: float, config: str) -> list[Child]:
    """Start the four nodes; the simulator waits for monitor, recorder and the listener."""
    chosen = {"config": config} if config else {}
    wanted: list[tuple[str, dict[str, str]]] = [
        ("recorder_node", {"uri": str(folder / "recording")}),
        ("gear_monitor_node", chosen),
        ("gear_sim_node", {**chosen, "duration": f"{duration:.3f}", "wait_for": str(SUBSCRIBERS)}),
        ("wind_node", {"seed": "1", **chosen}),
    ]
    return [Child(name, parameters, folder / f"{name}.log") for name, parameters in wanted]


def listen(children: list[Child], duration: float) -> Listener:
    """Take in everything until the simulator has ended by itself."""
    listener = Listener()
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("benchmark")
    executor = EventsExecutor()
    executor.add_node(node)
    node.create_subscription(
        Float64MultiArray,
        WAVEFORM,
        listener.waveform,
        live_qos(names.WAVEFORM_BLOCKS_PER_SECOND),
    )
    node.create_subscription(DiagnosticArray, names.DIAGNOSTICS, listener.diagnostics, live_qos(50))
    simulator = next(child for child in children if child.name == "gear_sim_node")
    limit = time.monotonic() + START_LIMIT + 3.0 * duration
    while simulator.look() and time.monotonic() < limit:
        executor.spin_once(timeout_sec=0.1)
    executor.remove_node(node)
    executor.shutdown()
    node.destroy_node()
    rclpy.try_shutdown()
    return listener


def recorded_blocks(recording: Path) -> int | None:
    """Number of waveform blocks in the recording, as `nw_gear info` counts them."""
    command = [str(BIN / "nw_gear"), "info", str(recording), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return None
    count = json.loads(done.stdout)["topics"].get(WAVEFORM, {}).get("count")
    return None if count is None else int(count)


def measure(duration: float, config: str) -> dict[str, Any]:
    """Run the suite for some simulated seconds and return the figures."""
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    os.environ.setdefault("ROS_DOMAIN_ID", str(1 + os.getpid() % 100))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        children = start(folder, duration, config)
        try:
            listener = listen(children, duration)
        finally:
            for child in sorted(children, key=lambda child: child.name == "recorder_node"):
                child.stop()
        own = resource.getrusage(resource.RUSAGE_SELF)
        return {
            "duration_s": duration,
            "config": config or "default",
            "cores": os.cpu_count(),
            **listener.result(),
            "recorded_blocks": recorded_blocks(folder / "recording"),
            "exit_codes": {child.name: child.code for child in children},
            "cpu_s": {**{child.name: child.cpu for child in children}, "listener": own.ru_utime + own.ru_stime},
            "cpu_share": {child.name: child.share for child in children},
        }


def table(result: dict[str, Any]) -> str:
    """The figures for people."""
    lines = [
        f"simulated                  {result['simulated_s']:.3f} s in {result['wall_s']:.3f} s of wall time, "
        f"{result['cores']} cores, configuration {result['config']}",
        f"blocks at the subscriber   {result['blocks']}, lost {result['lost_blocks']}",
        f"blocks in the recording    {result['recorded_blocks']}",
        f"delay of a block           {result['delay_at_end_s']:.3f} s at the end",
        f"                           {result['largest_delay_s']:.3f} s at most",
        "process                    CPU (s)   of a core   exit code",
    ]
    for name, share in result["cpu_share"].items():
        lines.append(
            f"  {name:<24} {result['cpu_s'][name]:>7.1f}   {100 * share:>7.1f} %   {result['exit_codes'][name]}"
        )
    lines.append(f"  {'listener (this process)':<24} {result['cpu_s']['listener']:>7.1f}")
    lines += [f"{name}: {', '.join(f'{k} {v}' for k, v in values.items())}" for name, values in result["said"].items()]
    return "\n".join(lines)


def main() -> None:
    """Measure once; the table goes to standard error, the JSON object to standard output or a file."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--duration", type=float, default=60.0, help="simulated seconds (60)")
    parser.add_argument("--config", default="", help="configuration laid over the default one")
    parser.add_argument("-o", "--output", type=Path, help="file for the JSON object")
    arguments = parser.parse_args()
    result = measure(arguments.duration, arguments.config)
    print(table(result), file=sys.stderr)
    text = json.dumps(result)
    if arguments.output is not None:
        arguments.output.write_text(text + "\n", encoding="utf-8")
    else:
        print(text)


if __name__ == "__main__":
    main()
