"""Error rates of the classifier: every case at every noise level, beside plain rivals; tables for docs/indicators.md.

`python benchmark/states/run.py` writes benchmark/results/states.json after every noise level and the tables at the end.
`--set tuning` runs the cases on which thresholds were chosen and writes nothing; `--every 10` takes
a tenth of the cases and prints the tables instead.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from docs_table import write_between

from nw_gear_monitor.states.classifier import classify
from states import rivals
from states.cases import Case, read, signal
from states.report import tables

LEVELS = (40.0, 20.0, 30.0, float("inf"), 60.0)
RESULTS = Path(__file__).parents[1] / "results" / "states.json"
PAGE = Path(__file__).parents[2] / "docs" / "indicators.md"
WARM_UP = 20
LEAST_CASES = 500


def measure(case: Case, level: float, cycles: int) -> dict[str, Any]:
    """Label one case at one noise level."""
    seen = signal(case, level, cycles=cycles)
    began = time.thread_time()
    verdict = classify(seen.x, strobe=seen.phase, v=seen.v)
    cost = time.thread_time() - began
    points = rivals.section(seen)
    return {
        "family": case.family,
        "truth": case.label,
        "label": verdict.label,
        "confidence": verdict.confidence,
        "noise_db": verdict.noise_db if np.isfinite(verdict.noise_db) else None,
        "cpu_ms": 1e3 * cost,
        "map": seen.phase is None,
        "zero_one": rivals.by_zero_one(points),
        "clusters": rivals.by_clusters(points),
        "recurrence": rivals.by_recurrence(points),
    }


def run(cases: list[Case], cycles: int, levels: tuple[float, ...]) -> dict[str, list[dict[str, Any]]]:
    """Label all cases, level by level, and report on the way."""
    for case in cases[:: max(len(cases) // WARM_UP, 1)]:  # kernels are compiled before anything is timed
        measure(case, 30.0, cycles)
    found: dict[str, list[dict[str, Any]]] = {}
    for level in levels:
        rows: list[dict[str, Any]] = []
        for number, case in enumerate(cases):
            rows.append(measure(case, level, cycles))
            if number % 50 == 49:
                print(f"{level:g} dB: {number + 1} of {len(cases)}", file=sys.stderr, flush=True)
        found[f"{level:g}"] = rows
        right = sum(row["label"] == row["truth"] for row in rows)
        wrong = Counter((row["family"], row["truth"], row["label"]) for row in rows if row["label"] != row["truth"])
        print(f"{level:g} dB: {right} of {len(rows)} right", dict(wrong), file=sys.stderr, flush=True)
        _keep(found, cycles)
    return found


def _keep(found: dict[str, list[dict[str, Any]]], cycles: int) -> None:
    """Write what is known so far; times as medians."""
    cost = {level: statistics.median(row["cpu_ms"] for row in rows) for level, rows in found.items()}
    rows = {
        level: [{key: value for key, value in row.items() if key != "cpu_ms"} for row in rows]
        for level, rows in found.items()
    }
    RESULTS.parent.mkdir(exist_ok=True)
    text = json.dumps({"cycles": cycles, "median_cpu_ms": cost, "cases": rows}, separators=(",", ":"))
    RESULTS.with_suffix(".partial").write_text(text.replace("},{", "},\n{") + "\n", encoding="utf-8")


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--set", default="held-out", choices=("held-out", "tuning"))
    parser.add_argument("--every", type=int, default=1, help="take every n-th case")
    parser.add_argument("--leave-out", type=int, default=0, help="leave every n-th case out, to save time")
    parser.add_argument("--cycles", type=int, default=1000, help="length of the window, periods")
    parser.add_argument("--levels", type=float, nargs="*", default=LEVELS, help="dB")
    chosen = parser.parse_args()
    cases = read(chosen.set)[:: chosen.every]
    if chosen.leave_out:
        cases = [case for number, case in enumerate(cases) if number % chosen.leave_out != chosen.leave_out - 1]
    run(cases, chosen.cycles, tuple(chosen.levels))
    partial = RESULTS.with_suffix(".partial")
    usual = (chosen.set, chosen.cycles, tuple(chosen.levels)) == ("held-out", 1000, LEVELS)
    if usual and len(cases) >= LEAST_CASES:
        partial.replace(RESULTS)
        write_between(PAGE, "states", tables(json.loads(RESULTS.read_text(encoding="utf-8"))))
    else:
        print(tables(json.loads(partial.read_text(encoding="utf-8"))))
        partial.unlink()


if __name__ == "__main__":
    main()
