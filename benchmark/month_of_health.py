"""How often alarms are raised in a month without a fault.

    python benchmark/month_of_health.py --record 1 2 3      minutes of the full model in the wind of these seeds
    python benchmark/month_of_health.py                     a month drawn from their statistics, before the alarms

Recorded minutes are described in results/health_statistics.json; what the month gave goes to
results/month_of_health.json and into docs/indicators.md. A monitor that knows nothing learns and judges from the start.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from docs_table import write_between
from health.judging import Outcome, judge
from health.recording import Recording, record
from health.statistics import describe
from health.surrogate import Surrogate

HERE = Path(__file__).resolve().parent
STATISTICS = HERE / "results" / "health_statistics.json"
RESULT = HERE / "results" / "month_of_health.json"
PAGE = HERE.parent / "docs" / "indicators.md"
NAME = "month_of_health"
MONTH = 30 * 24 * 3600
FIRST_DAY = 24 * 3600.0


def group(feature: str) -> str:
    """Features of one kind: `bearing */rms` for all bearings, `*/rms` for all meshes."""
    element, _, column = feature.rpartition("/")
    return ("bearing */" if element.startswith("bearing ") else "*/") + column


def summary(outcome: Outcome, seconds: int, seed: int, statistics: Mapping[str, Any]) -> dict[str, Any]:
    """Counts by kind of feature."""
    kinds: dict[str, dict[str, Any]] = {}
    for name, judged, warn, error in zip(outcome.names, outcome.judged, outcome.warn, outcome.error, strict=True):
        own = kinds.setdefault(group(name), {"features": 0, "judged": 0, "warn": 0, "error": 0, "deviation": []})
        own["features"] += 1
        own["judged"] += int(judged)
        own["warn"] += int(warn)
        own["error"] += int(error)
        own["deviation"] += [b[3] for b in statistics["features"][name]["bins"]]
    for own in kinds.values():
        own["deviation"] = round(float(np.median(own["deviation"])), 3)
    return {
        "seconds": seconds,
        "seed": seed,
        "recorded_seconds": statistics["seconds"],
        "features": len(outcome.names),
        "windows_judged": int(outcome.judged.sum()),
        "warn": int(outcome.warn.sum()),
        "error": int(outcome.error.sum()),
        "error_on_the_first_day": sum(second < FIRST_DAY for second in outcome.error_seconds),
        "error_seconds": outcome.error_seconds[:100],
        "kinds": kinds,
    }


def table(result: Mapping[str, Any]) -> str:
    """The outcome for the documentation."""
    head = ["| feature | number | spread of ln | windows judged | WARN | ERROR |", "|---|---|---|---|---|---|"]
    rows = [
        f"| `{name}` | {k['features']} | {k['deviation']:g} | {k['judged']:,} | {k['warn']} | {k['error']} |"
        for name, k in result["kinds"].items()
    ]
    total = f"| all | {result['features']} | | {result['windows_judged']:,} | {result['warn']} | {result['error']} |"
    days = result["seconds"] / 86400
    recorded = " + ".join(str(s) for s in result["recorded_seconds"])
    words = f"{days:g} days, drawn from {recorded} s of the full model, seed {result['seed']}:"
    return "\n".join([words, "", *head, *rows, total]).replace(",", " ")


def main() -> int:
    """Record, or draw and judge."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--record", type=int, nargs="+", metavar="SEED", help="seeds of the wind to record")
    parser.add_argument("--minutes", type=int, default=20, help="recorded for each seed")
    parser.add_argument("--recordings", type=Path, nargs="+", help="recordings that exist, as NPZ")
    parser.add_argument("--keep", type=Path, help="folder for the recordings")
    parser.add_argument("--seconds", type=int, default=MONTH)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    if given.record or given.recordings:
        recordings = [Recording.open(path) for path in given.recordings or []]
        for seed in given.record or []:
            print(f"seed {seed}: {given.minutes} min", file=sys.stderr)
            recordings.append(record(seed, 60 * given.minutes))
            if given.keep is not None:
                recordings[-1].save(given.keep / f"health_{seed}.npz")
        STATISTICS.write_text(json.dumps(describe(recordings), separators=(",", ":")) + "\n", encoding="utf-8")
        return 0
    statistics = json.loads(STATISTICS.read_text(encoding="utf-8"))
    outcome = judge(Surrogate(statistics, given.seed), given.seconds)
    result = summary(outcome, given.seconds, given.seed, statistics)
    print(f"WARN {result['warn']}, ERROR {result['error']} in {given.seconds} s", file=sys.stderr)
    RESULT.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    write_between(PAGE, NAME, table(result))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
