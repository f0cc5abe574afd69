"""The nodes as processes, measured: start, real time, as fast as possible, with and without a recorder.

Prints a table on standard error and one JSON object on standard output. A measurement, not a test: nothing passes or
fails here.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from children import BIN, Child, Parameters, stop_all
from listening import WAVEFORM, listening

START_LIMIT = 120.0
FIXED = "rated"
"""Preset for the runs that shouldn't wait for the wind."""
Wanted = list[tuple[str, Parameters]]


def run(wanted: Wanted, simulated: float, folder: Path) -> dict[str, Any]:
    """Start executables, the simulator first among those that count, and listen until it ends by itself."""
    with listening() as (listener, take):
        children = [Child(name, parameters, folder / f"{name}.log") for name, parameters in wanted]
        simulator = next(child for child in children if child.name == "gear_sim_node")
        limit = time.monotonic() + START_LIMIT + 3.0 * simulated
        try:
            while simulator.look() and time.monotonic() < limit:
                take(0.1)
            take(0.1)
        finally:
            stop_all(children)
        to_first = listener.first[1] - simulator.began if listener.first else None
        return {
            **listener.result(),
            "to_first_block_s": to_first,
            "delay_s": listener.largest_delay,
            "processes": {
                child.name: {
                    "cpu_s": child.cpu,
                    "cpu_share": child.share,
                    "memory_mb": child.memory,
                    "exit_code": child.code,
                }
                for child in children
            },
        }


def recorded_blocks(recording: Path) -> int | None:
    """Number of waveform blocks in the recording, as `nw_gear info` counts them."""
    command = [str(BIN / "nw_gear"), "info", str(recording), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return None
    count = json.loads(done.stdout)["topics"].get(WAVEFORM, {}).get("count")
    return None if count is None else int(count)


def start(repeats: int) -> dict[str, Any]:
    """Time from the start of the simulator's process to its first block at a subscriber that is there already.

    CPU time is that of the whole process with 0.1 simulated seconds. A first start, which may have to compile, isn't
    counted.
    """
    parameters = {"config": FIXED, "wait_for": "1", "duration": "0.1"}
    runs = []
    for _ in range(repeats + 1):
        with tempfile.TemporaryDirectory() as name:
            runs.append(run([("gear_sim_node", parameters)], 0.1, Path(name)))
    times = [one["to_first_block_s"] for one in runs[1:]]
    cpu = [one["processes"]["gear_sim_node"]["cpu_s"] for one in runs[1:]]
    return {
        "median_s": statistics.median(times),
        "largest_s": max(times),
        "median_cpu_s": statistics.median(cpu),
        "repeats": repeats,
    }


def real_time(duration: float, config: str) -> dict[str, Any]:
    """Wind, simulator, monitor and recorder in step with the wall."""
    chosen = {"config": config} if config else {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        wanted: Wanted = [
            ("recorder_node", {"uri": str(folder / "recording")}),
            ("gear_monitor_node", chosen),
            ("gear_sim_node", {**chosen, "duration": f"{duration:.3f}", "wait_for": "3"}),
            ("wind_node", {"seed": "1", **chosen}),
        ]
        result = run(wanted, duration, folder)
        return {**result, "recorded_blocks": recorded_blocks(folder / "recording")}


def unpaced(duration: float, *, recorded: bool) -> dict[str, Any]:
    """The simulator as fast as it goes, at a fixed operating point."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        subscribers = "2" if recorded else "1"
        simulator = {"config": FIXED, "real_time_factor": "0.0", "duration": f"{duration:.3f}", "wait_for": subscribers}
        wanted: Wanted = [("recorder_node", {"uri": str(folder / "recording")})] if recorded else []
        result = run([*wanted, ("gear_sim_node", simulator)], duration, folder)
        return {**result, "recorded_blocks": recorded_blocks(folder / "recording")} if recorded else result


def lines(title: str, result: dict[str, Any]) -> list[str]:
    """The figures of a run for people."""
    out = [
        f"{title}: {result['simulated_s']:.2f} s at {result['real_time_factor']:.2f} times real time",
        f"  blocks at the subscriber {result['blocks']}, lost {result['lost_blocks']}"
        + (f"; in the recording {result['recorded_blocks']}" if "recorded_blocks" in result else ""),
        f"  integration takes {100 * (result['integration_share'] or float('nan')):.1f} % of a core (median)",
    ]
    for name, process in result["processes"].items():
        out.append(
            f"  {name:<18} CPU {process['cpu_s']:6.1f} s ({100 * process['cpu_share']:5.1f} % of a core), "
            f"memory {process['memory_mb']:4.0f} MB, exit code {process['exit_code']}"
        )
    return out


def main() -> None:
    """Measure once."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--duration", type=float, default=60.0, help="seconds in real time (60)")
    parser.add_argument("--unpaced", type=float, default=120.0, help="simulated seconds as fast as possible (120)")
    parser.add_argument("--starts", type=int, default=5, help="starts of the simulator (5)")
    parser.add_argument("--config", default="", help="configuration in real time, laid over the default one")
    parser.add_argument("-o", "--output", type=Path, help="file for the JSON object")
    arguments = parser.parse_args()
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    os.environ.setdefault("ROS_DOMAIN_ID", str(1 + os.getpid() % 100))
    result: dict[str, Any] = {"cores": os.cpu_count(), "load": os.getloadavg()[0]}
    text = [f"{result['cores']} cores, load {result['load']:.2f} at the start"]
    if arguments.starts:
        result["start"] = start(arguments.starts)
        begun = result["start"]
        text.append(
            f"start to first block: {begun['median_s']:.2f} s (median), {begun['largest_s']:.2f} s at most; "
            f"{begun['median_cpu_s']:.2f} s of CPU time"
        )
    if arguments.duration:
        result["real_time"] = real_time(arguments.duration, arguments.config)
        text += lines("real time", result["real_time"])
        text.append(f"  delay of a block {result['real_time']['delay_s']:.3f} s at most")
        for name, values in result["real_time"]["said"].items():
            text.append(f"  {name}: {', '.join(f'{k} {v}' for k, v in values.items())}")
    if arguments.unpaced:
        result["unpaced"] = unpaced(arguments.unpaced, recorded=False)
        result["unpaced_recorded"] = unpaced(arguments.unpaced, recorded=True)
        text += lines("as fast as possible", result["unpaced"])
        text += lines("as fast as possible, recorded", result["unpaced_recorded"])
    print("\n".join(text), file=sys.stderr)
    if arguments.output is not None:
        arguments.output.write_text(json.dumps(result) + "\n", encoding="utf-8")
    else:
        print(json.dumps(result))


if __name__ == "__main__":
    main()
