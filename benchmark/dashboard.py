"""The dashboard as a process, measured: processor time for pages that take every update, memory while pages come, go.

    python benchmark/dashboard.py                    three minutes with no, one and three pages, then the memory
    python benchmark/dashboard.py --minutes 60       memory over an hour

Readers take what a browser takes, over the websocket, and answer at once, so that each gets every update; they don't
paint. Prints one JSON object, keeps it in benchmark/results and puts the table into docs/dashboard.md. A measurement,
not a test: nothing passes or fails here.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path
from typing import Any

from children import Child, stop_all
from docs_table import write_between

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "benchmark" / "results" / "dashboard.json"
PAGE = ROOT / "docs" / "dashboard.md"
READER = Path(__file__).resolve().with_name("page_reader.py")
PATIENCE = 300.0
SETTLE = 20.0
PORT = 8911
TICKS = os.sysconf("SC_CLK_TCK")
MEGA = 1e-6
FIRST = 120.0
"""Seconds after which memory counts: buffers are full then and every piece of code has run."""


def start_readers(pages: int, seconds: float) -> list[subprocess.Popen[str]]:
    """Pages as processes of their own."""
    command = [sys.executable, str(READER), f"http://127.0.0.1:{PORT}/", f"{seconds:g}"]
    return [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(pages)]


def wait_for_page() -> None:
    """Wait until the server answers."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        with contextlib.suppress(OSError), urllib.request.urlopen(f"http://127.0.0.1:{PORT}/alive", timeout=30.0):
            return
        time.sleep(0.5)


def processor(pid: int) -> float:
    """Processor time that a process has used (s)."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def memory(pid: int) -> float:
    """Resident memory of a process (MB)."""
    pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="utf-8").split()[1])
    return MEGA * pages * os.sysconf("SC_PAGE_SIZE")


def load(pid: int, pages: int, seconds: float) -> dict[str, float]:
    """Share of a core that the server uses with some pages open, and the updates that each of them got."""
    readers = start_readers(pages, SETTLE + seconds)
    time.sleep(SETTLE)
    cpu, wall = processor(pid), time.monotonic()
    time.sleep(seconds)
    share = (processor(pid) - cpu) / (time.monotonic() - wall)
    busy = os.getloadavg()[0] / len(os.sched_getaffinity(0))
    found = [json.loads(reader.communicate(timeout=PATIENCE)[0]) for reader in readers]
    rate, size = (
        sum(each[key] for each in found) / max(1, len(found)) for key in ("updates_per_second", "bytes_per_second")
    )
    return {
        "pages": pages,
        "seconds": seconds,
        "core_share": round(share, 3),
        "machine_load": round(busy, 2),
        "updates_per_second": round(rate, 2),
        "kilobytes_per_second": round(1e-3 * size, 1),
    }


def growth(pid: int, minutes: float, page_seconds: float) -> dict[str, Any]:
    """Memory over minutes in which one page after the other is opened and closed."""
    began, samples, opened = time.monotonic(), [], 0
    readers: list[subprocess.Popen[str]] = []
    while (now := time.monotonic() - began) < 60.0 * minutes:
        if not any(reader.poll() is None for reader in readers):
            readers = start_readers(2, page_seconds)
            opened += 2
        samples.append((now, memory(pid)))
        time.sleep(2.0)
    for reader in readers:
        reader.wait(PATIENCE)
    late = [(at, size) for at, size in samples if at > FIRST]
    middle = 0.5 * (late[0][0] + late[-1][0])
    first = [size for at, size in late if at <= middle]
    second = [size for at, size in late if at > middle]
    return {
        "minutes": minutes,
        "pages_opened": opened,
        "memory_at_start_mb": round(samples[0][1], 1),
        "memory_first_half_mb": round(sum(first) / len(first), 1),
        "memory_second_half_mb": round(sum(second) / len(second), 1),
        "memory_largest_mb": round(max(size for _at, size in samples), 1),
        "memory_at_end_mb": round(samples[-1][1], 1),
        "every_30_s_mb": [round(size, 1) for _at, size in samples[::15]],
    }


def measure(seconds: float, minutes: float, factor: float, pages: list[int]) -> dict[str, Any]:
    """Start the suite and measure its dashboard."""
    with tempfile.TemporaryDirectory() as folder:
        clocked = {"use_sim_time": "true"} if factor != 1.0 else {}
        wanted: list[tuple[str, dict[str, str]]] = [
            ("wind_node", clocked),
            ("gear_monitor_node", clocked),
            ("gear_sim_node", {"real_time_factor": f"{factor:.6f}"}),
            ("dashboard_node", {"port": str(PORT)}),
        ]
        children = [Child(name, parameters, Path(folder) / f"{name}.log") for name, parameters in wanted]
        try:
            pid = children[-1].pid
            wait_for_page()
            loads = [load(pid, number, seconds) for number in pages] if seconds else []
            return {"real_time_factor": factor, "load": loads, "memory": growth(pid, minutes, 15.0)}
        finally:
            stop_all(children)


def table(result: dict[str, Any]) -> str:
    """The result for the documentation."""
    rows = [
        "| pages open | updates/s, each | kB/s, each | processor (share of a core) | processes waiting for a core |",
        "|---|---|---|---|---|",
    ]
    rows += [
        f"| {r['pages']} | {r['updates_per_second']:.1f} | {r['kilobytes_per_second']:.0f} | {r['core_share']:.2f} "
        f"| {r['machine_load']:.1f} |"
        for r in result["load"]
    ]
    m = result["memory"]
    rows.append(
        f"\nMemory over {m['minutes']:g} minutes in which {m['pages_opened']} pages were opened and closed: "
        f"{m['memory_at_start_mb']:.0f} MB at the start, {m['memory_first_half_mb']:.0f} MB in the first half (after "
        f"two minutes), {m['memory_second_half_mb']:.0f} MB in the second, {m['memory_largest_mb']:.0f} MB at most."
    )
    return "\n".join(rows)


def main() -> int:
    """Read the arguments, measure, keep the result."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--seconds", type=float, default=150.0, help="length of each measurement of the processor")
    parser.add_argument("--minutes", type=float, default=12.0, help="length of the measurement of the memory")
    parser.add_argument("--factor", type=float, default=1.0, help="speed of the simulation")
    parser.add_argument("--pages", type=int, nargs="+", default=[0, 1, 3], help="pages open at the same time")
    arguments = parser.parse_args()
    result = measure(arguments.seconds, arguments.minutes, arguments.factor, arguments.pages)
    RESULTS.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    if PAGE.exists():
        write_between(PAGE, "measured", table(result))
    print(json.dumps(result))
    return 0


if __name__ == "__main__":
    sys.exit(main())
