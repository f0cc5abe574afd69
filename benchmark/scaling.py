"""What a bifurcation diagram costs with one worker and with more, on processes and on a Dask cluster.

    .venv/bin/python benchmark/scaling.py [POINTS]

Writes benchmark/results/scaling.json and the table of docs/sweeps.md. Every run is `nw_gear study bifurcation` as it is
started by hand, in a new folder, from the first import to the page. The cluster's scheduler runs beside its workers.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from docs_table import write_between

from nw_gear_common.machine import describe

ROOT = Path(__file__).parent.parent
POINTS = 384
BIN = Path(sys.executable).parent


def study(points: int, *how: str) -> float:
    """Return the wall time (s) of a study."""
    over = f"excitation.omega_e=0.16:0.26:{points}"
    with tempfile.TemporaryDirectory() as folder:
        command = [str(BIN / "nw_gear"), "study", "bifurcation", "--over", over, "-o", f"{folder}/study", *how]
        began = time.monotonic()
        subprocess.run(command, check=True, capture_output=True, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
        return time.monotonic() - began


@contextmanager
def cluster(workers: int) -> Iterator[str]:
    """A scheduler and some workers on the loopback interface, as processes; gives the scheduler's address."""
    scheduler, worker = ([sys.executable, "-m", f"distributed.cli.dask_{name}"] for name in ("scheduler", "worker"))
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scheduler.json"
        where = ["--scheduler-file", str(file), "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
        started = [subprocess.Popen([*scheduler, *where], **quiet)]
        try:
            while not file.exists():
                time.sleep(0.1)
            told = ["--scheduler-file", str(file), "--host", "127.0.0.1", "--nthreads", "1", "--no-dashboard"]
            started += [subprocess.Popen([*worker, *told], cwd=folder, **quiet) for _ in range(workers)]
            yield json.loads(file.read_text(encoding="utf-8"))["address"]
        finally:
            for process in reversed(started):
                process.terminate()
                process.wait()


def measure(points: int) -> list[dict[str, Any]]:
    """Run the study with 1, 2, 4, .. workers, as far as there are cores."""
    cores = len(os.sched_getaffinity(0))
    counts = [n for n in (1, 2, 4, 8, 16, 32) if n <= cores]
    rows: list[dict[str, Any]] = []
    for workers in counts:
        rows.append({"where": "processes", "workers": workers, "seconds": study(points, "--workers", str(workers))})
        with cluster(workers) as address:
            study(16 * workers, "--dask", address)  # kernels are loaded
            rows.append({"where": "Dask", "workers": workers, "seconds": study(points, "--dask", address)})
    for row in rows:
        print(row, flush=True)
    return rows


def table(rows: list[dict[str, Any]], points: int) -> str:
    """The table of the documentation."""
    one = {row["where"]: row["seconds"] for row in rows if row["workers"] == 1}
    lines = ["| where | workers | wall time (s) | points a second | gain |", "|---|---|---|---|---|"]
    for row in rows:
        gain, speed = one[row["where"]] / row["seconds"], points / row["seconds"]
        lines.append(f"| {row['where']} | {row['workers']} | {row['seconds']:.1f} | {speed:.1f} | {gain:.2f} |")
    return "\n".join(lines)


def main() -> None:
    """Measure and write."""
    points = int(sys.argv[1]) if len(sys.argv) > 1 else POINTS
    rows = measure(points)
    found = {"machine": describe().as_values(), "points": points, "rows": rows}
    (ROOT / "benchmark" / "results" / "scaling.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    write_between(ROOT / "docs" / "sweeps.md", "scaling", table(rows, points))


if __name__ == "__main__":
    main()
