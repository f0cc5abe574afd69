"""How long `nw_gear review` takes for an hour's recording, how much memory, and how large what it writes is.

    python benchmark/hour_of_review.py --work FOLDER [--source RUN] [--seconds 3600] [--formats html,parquet,json]

A demo of half a minute is recorded (or RUN taken), an hour's recording is made of it, and each format is written by a
process of its own. The hour needs 8 GB in FOLDER, and each export of data some more; both stay there for another time
or are removed with --clean. Results go to results/hour_of_review.json and into docs/review.md.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from docs_table import write_between
from hour.making import make

from nw_gear_common.machine import describe

HERE = Path(__file__).resolve().parent
RESULT = HERE / "results" / "hour_of_review.json"
PAGE = HERE.parent / "docs" / "review.md"
NAME = "hour_of_review"
NW_GEAR = Path(sys.executable).parent / "nw_gear"
DEMO_SECONDS = 30
WALL_GOAL, MEMORY_GOAL, PAGE_GOAL = 60.0, 2000.0, 25.0


@dataclass(frozen=True)
class Cost:
    """What writing one format took.

    Attributes:
        format: html, parquet, csv or json.
        wall, cpu: s.
        memory: largest resident set, MB.
        written: MB.
        load: processes that wanted to run just before, from the system's load average over a minute.
    """

    format: str
    wall: float
    cpu: float
    memory: float
    written: float
    load: float


def measure(run: Path, kind: str, work: Path) -> Cost:
    """Run the command once."""
    goal = work / f"hour.{kind}"
    if goal.is_dir():
        shutil.rmtree(goal)
    load, began = os.getloadavg()[0], time.monotonic()
    process = subprocess.Popen([NW_GEAR, "review", run, "--format", kind, "-o", goal], stdout=subprocess.DEVNULL)
    _pid, status, usage = os.wait4(process.pid, 0)
    wall = time.monotonic() - began
    if status:
        raise SystemExit(f"nw_gear review --format {kind} ended with {os.waitstatus_to_exitcode(status)}")
    files = list(goal.iterdir()) if goal.is_dir() else [goal]
    written = 1e-6 * sum(file.stat().st_size for file in files)
    return Cost(kind, wall, usage.ru_utime + usage.ru_stime, 1e-3 * usage.ru_maxrss, written, load)


def summary(costs: list[Cost], about: dict[str, Any]) -> dict[str, Any]:
    """The result with its goals and what they are held against."""
    page = next((cost for cost in costs if cost.format == "html"), None)
    goals = {}
    if page is not None:
        goals = {
            "wall_under_60_s": page.wall < WALL_GOAL,
            "memory_under_2_gb": page.memory < MEMORY_GOAL,
            "page_under_25_mb": page.written < PAGE_GOAL,
        }
    return {**about, "machine": asdict(describe()), "goals": goals, "costs": [asdict(cost) for cost in costs]}


def table(result: dict[str, Any]) -> str:
    """The result for the documentation."""
    names = ("written", "wall time (s)", "CPU time (s)", "memory (MB)", "size (MB)", "load before")
    head = [f"| {' | '.join(names)} |", "|---" * len(names) + "|"]
    rows = []
    for cost in (Cost(**entry) for entry in result["costs"]):
        numbers = (f"{n:.1f}" for n in (cost.wall, cost.cpu, cost.memory, cost.written, cost.load))
        rows.append(f"| {cost.format} | {' | '.join(numbers)} |")
    words = (
        f"A recording of {result['seconds']:g} s with {result['values'] / 1e6:.0f} million values in its waveform, "
        f"{result['messages'] / 1e6:.1f} million messages, {result['size_gb']:.1f} GB; {result['cores']} cores of "
        f"{result['machine']['processor']}, shared with others: the last column says how many processes wanted to run "
        "in the minute before."
    )
    return "\n".join([words, "", *head, *rows])


def recording_of(given: argparse.Namespace) -> tuple[Path, int]:
    """The hour's run, made where it isn't there, and the number of values in its waveform."""
    run = given.work / "hour"
    counted = run / "values.json"
    if not counted.is_file():
        source = given.source or given.work / "demo"
        if not source.exists():
            demo = [NW_GEAR, "demo", "--duration", str(DEMO_SECONDS), "--no-report", "-o", source]
            subprocess.run(demo, check=True, stdout=subprocess.DEVNULL)
        shutil.rmtree(run, ignore_errors=True)
        values = make(
            source / "recording", run / "recording", given.seconds, lambda words: print(words, file=sys.stderr)
        )
        counted.write_text(json.dumps(values), encoding="utf-8")
    return run, int(json.loads(counted.read_text(encoding="utf-8")))


def _say(words: str) -> None:
    print(words, file=sys.stderr)


def main() -> int:
    """Make the hour, measure, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", type=Path, required=True, help="folder for the recordings")
    parser.add_argument("--source", type=Path, help="run of a demo that exists")
    parser.add_argument("--seconds", type=float, default=3600.0)
    parser.add_argument("--formats", default="html,json,parquet")
    parser.add_argument("--clean", action="store_true", help="remove the hour and what was written")
    given = parser.parse_args()
    given.work.mkdir(parents=True, exist_ok=True)
    run, values = recording_of(given)
    info = subprocess.run([NW_GEAR, "info", run / "recording", "--json"], check=True, capture_output=True, text=True)
    found = json.loads(info.stdout)
    size = sum(file.stat().st_size for file in (run / "recording").iterdir())
    about = {
        "seconds": given.seconds,
        "values": values,
        "messages": sum(topic["count"] for topic in found["topics"].values()),
        "size_gb": 1e-9 * size,
        "cores": os.cpu_count(),
    }
    costs = []
    for kind in given.formats.split(","):
        costs.append(measure(run, kind, given.work))
        print(costs[-1], file=sys.stderr)
    result = summary(costs, about)
    RESULT.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    write_between(PAGE, NAME, table(result))
    if given.clean:
        shutil.rmtree(given.work)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
