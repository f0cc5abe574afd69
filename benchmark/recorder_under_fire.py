"""The recorder under fire, long: the table of docs/records.md and benchmark/results/recorder_under_fire.json.

    PYTHONPATH=. python benchmark/recorder_under_fire.py                 some fifteen minutes
    PYTHONPATH=. python benchmark/recorder_under_fire.py --only killed   one scenario again

The scenarios are those of test/system/test_recorder_fire.py; each ends with an AssertionError where it must.
"""

from __future__ import annotations

import argparse
import json
import re
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from docs_table import write_between

from nw_gear_common.machine import describe
from test.system.fire import changes, disks, load
from test.system.fire.killed import FLUSH_PERIOD, kill_many

ROOT = Path(__file__).resolve().parents[1]
RESULT = ROOT / "benchmark" / "results" / "recorder_under_fire.json"
RUNS = 50
SEED = 6


def killed(place: Path) -> dict[str, Any]:
    """SIGKILL at so many moments drawn with one seed."""
    deaths = kill_many(place, RUNS, SEED)
    lost = [death.lost for death in deaths if death.started]
    return {
        "runs": RUNS,
        "seed": SEED,
        "flush_period_s": FLUSH_PERIOD,
        "with_messages": len(lost),
        "repaired": sum(death.damaged for death in deaths),
        "most_files": max(death.files for death in deaths),
        "lost_s_median": float(np.median(lost)),
        "lost_s_max": float(np.max(lost)),
    }


SCENARIOS: dict[str, Callable[[Path], dict[str, Any]]] = {
    "killed": killed,
    "full_disk": disks.full_disk,
    "read_only_folder": disks.read_only_folder,
    "two_recorders": disks.two_recorders,
    "clock_back": changes.clock_back,
    "changing_topics": changes.changing_topics,
    "many_topics": load.many_topics,
    "heavy": load.heavy,
}

ROWS: dict[str, tuple[str, str]] = {
    "killed": (
        "SIGKILL at {runs} random moments, start included (flush period {flush_period_s} s)",
        "{with_messages} recordings had begun, {repaired} needed repair (up to {most_files} files); "
        "lost: {lost_s_median:.2f} s in the median, {lost_s_max:.2f} s at most",
    ),
    "full_disk": (
        "Disk full (tmpfs of 4 MiB)",
        "exit code 1, `No space left on device`; {messages} messages repaired, {lost_s:.2f} s lost",
    ),
    "read_only_folder": ("Read-only folder", "exit code 2, one line"),
    "two_recorders": (
        "Two recorders to one folder",
        "the second: exit code 2, one line; the first: {messages} messages, none lost",
    ),
    "clock_back": (
        "Clock jumps back from 14 s to 1 s, files of 3 s",
        "{messages} of 10 messages, in order, in {files} files",
    ),
    "changing_topics": (
        "Topic comes late, its publishers change reliability, durability, type",
        "all {messages} messages of the first type; {other_type} of another type counted",
    ),
    "many_topics": ("{topics} topics at 5 Hz", "{recorded} of {sent} messages, the rest counted"),
    "heavy": (
        "{megabytes_per_second:.0f} MB/s in messages of 1 MB for {seconds:.0f} s",
        "{recorded} of {sent} messages in {files} files, {lost} lost and counted, {after_the_last} after the last one",
    ),
}


def publish(found: dict[str, Any]) -> None:
    """Write the results and the table of the documentation."""
    text = re.sub(rf"{re.escape(tempfile.gettempdir())}/[^/]+", "FOLDER", json.dumps(found, indent=1))
    RESULT.write_text(text + "\n", encoding="utf-8")
    lines = ["| what happens | what comes of it |", "|---|---|"]
    for name, (what, outcome) in ROWS.items():
        if name in found["scenarios"]:
            values = found["scenarios"][name]
            lines.append(f"| {what.format(**values)} | {outcome.format(**values)} |")
    machine = found["machine"]
    where = f"{machine['processor']}, {machine['cores']} cores, load {machine['load']:.0f}"
    lines += [
        "",
        f"Measured by `benchmark/recorder_under_fire.py` on {where}: everything else that ran took its share.",
    ]
    write_between(ROOT / "docs" / "records.md", "recorder_under_fire", "\n".join(lines))


def main() -> None:
    """Run the scenarios, keep what others gave before."""
    parser = argparse.ArgumentParser(description="The recorder under fire.")
    parser.add_argument("--only", choices=SCENARIOS, action="append", help="run these alone")
    parser.add_argument("--folder", type=Path, help="where to record (default: the system's temporary folder)")
    given = parser.parse_args()
    before = json.loads(RESULT.read_text(encoding="utf-8"))["scenarios"] if RESULT.exists() else {}
    results = dict(before)
    for name in given.only or SCENARIOS:
        began = time.monotonic()
        with tempfile.TemporaryDirectory(prefix="nw_gear_fire_", dir=given.folder) as place:
            results[name] = SCENARIOS[name](Path(place))
        print(f"{name}: {results[name]} ({time.monotonic() - began:.0f} s)", flush=True)
        publish({"machine": describe().as_values(), "scenarios": results})


if __name__ == "__main__":
    main()
