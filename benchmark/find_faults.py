"""How small a fault the monitor finds within a minute, at rated wind and at half load.

    python benchmark/find_faults.py             everything, one process for each condition (half an hour and more)
    python benchmark/find_faults.py --table     the table in docs/indicators.md, from what was found last

Baselines are learned in wind of some seeds. Ten healthy minutes of other seeds have to stay without alarms. Then each
fault is put in at once, in wind of one more seed, and the smallest of several severities, each a third of the one
before, is looked for that raises an alarm within a minute. What was found goes to results/find_faults.json.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path
from typing import Any

from detection.cases import CONDITIONS, FACTOR, FAULTS, HEALTHY_SEEDS, LEARNING_SECONDS, LEARNING_SEEDS, Fault
from detection.runs import Finding, faulty, healthy, learn
from docs_table import write_between

from nw_gear_monitor.alarms.center import AlarmCenter

HERE = Path(__file__).resolve().parent
RESULT = HERE / "results" / "find_faults.json"
PAGE = HERE.parent / "docs" / "indicators.md"
NAME = "find_faults"


def study(condition: str) -> dict[str, Any]:
    """Learn, watch healthy minutes, and look for the smallest severity of every fault."""
    center = learn(condition)
    print(f"{condition}: learned {len(center.baseline.bins)} bins", file=sys.stderr, flush=True)
    quiet = {}
    for seed in HEALTHY_SEEDS:
        quiet[seed] = asdict(healthy(center, condition, seed))
        print(f"{condition}: healthy minute {seed}: {quiet[seed]}", file=sys.stderr, flush=True)
    found = {}
    for fault in FAULTS:
        found[fault.name] = search(center, condition, fault)
        print(f"{condition}: {fault.name}: {found[fault.name]}", file=sys.stderr, flush=True)
    return {"healthy": quiet, "faults": found}


def search(center: AlarmCenter, condition: str, fault: Fault) -> dict[str, Any]:
    """Look for the smallest severity that is found, between one that is and one that isn't.

    Returns:
        `severity`: the smallest found, None where the largest isn't; `tried`: severity -> what the alarms said.
    """
    tried: dict[float, Finding] = {}

    def finds(level: int) -> bool:
        severity = fault.largest / FACTOR**level
        tried[severity] = faulty(center, condition, fault, severity)
        return tried[severity].warn is not None

    low, high = -1, fault.steps + 1  # found at low, not found at high
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if finds(middle) else (low, middle)
    severity = None if low < 0 else fault.largest / FACTOR**low
    return {"severity": severity, "tried": {f"{s:.6g}": asdict(f) for s, f in sorted(tried.items())}}


def table(result: Mapping[str, Any]) -> str:
    """Return the table for the documentation; faults that weren't found at any severity are named as such."""
    conditions = list(result)
    head = ["| fault | " + " | ".join(f"{c}: smallest found | first alarm" for c in conditions) + " |"]
    head.append("|---|" + "---|---|" * len(conditions))
    rows = [f"| {fault.name} | " + " | ".join(_cell(fault, result[c]) for c in conditions) + " |" for fault in FAULTS]
    false = {c: [s for s, f in result[c]["healthy"].items() if f["warn"] is not None] for c in conditions}
    errors = {c: sum(f["error"] is not None for f in result[c]["healthy"].values()) for c in conditions}
    words = [
        f"Healthy minutes with an alarm: {len(false[c])} of {len(result[c]['healthy'])} at {c} ({errors[c]} ERROR)."
        for c in conditions
    ]
    learned = f"Baselines learned from {len(LEARNING_SEEDS)} times {LEARNING_SECONDS} s in each condition."
    return "\n".join([*head, *rows, "", " ".join([*words, learned])])


def _cell(fault: Fault, found: Mapping[str, Any]) -> str:
    own = found["faults"][fault.name]
    if own["severity"] is None:
        return f"**missed** up to {fault.largest * fault.scale:.3g} {fault.unit} | "
    said = own["tried"][f"{own['severity']:.6g}"]
    at_least = "≤ " if own["severity"] == fault.largest / FACTOR**fault.steps else ""
    shown = ", ".join(f"`{name}`" for name in said["features"][:2])
    return f"{at_least}{own['severity'] * fault.scale:.3g} {fault.unit} | {said['warn']:.0f} s: {shown}"


def main() -> None:
    """Run the study, or write the table again."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--table", action="store_true", help="write the table from the last results alone")
    if not parser.parse_args().table:
        with ProcessPoolExecutor(len(CONDITIONS)) as pool:
            result = dict(zip(CONDITIONS, pool.map(study, CONDITIONS), strict=True))
        RESULT.write_text(json.dumps(result, indent=1), encoding="utf-8")
    write_between(PAGE, NAME, table(json.loads(RESULT.read_text(encoding="utf-8"))))


if __name__ == "__main__":
    main()
