"""Chaos indicators beside other packages: runs that part of `nw_gear bench` and puts its table into docs/measured.md.

python benchmark/peers.py       after `make peers`
"""

from __future__ import annotations

import importlib.metadata
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from docs_table import write_between

from nw_gear_common.machine import describe
from nw_gear_monitor import bench_peers

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "benchmark" / "results" / "peers.json"
PAGE = ROOT / "docs" / "measured.md"
PEERS = ("neurokit2", "nolds", "antropy", "accrqa")


def main() -> None:
    """Measure, write the numbers and the table."""
    part = bench_peers.measure(None, quick=False, say=lambda line: print(line, file=sys.stderr, flush=True))
    found = {"machine": describe().as_values(), "versions": _versions(), **part.values}
    RESULTS.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    write_between(PAGE, "peers", _table(part.values["indicators"], found["versions"]))


def _versions() -> dict[str, str]:
    known = {}
    for name in PEERS:
        try:
            known[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return known


def _table(indicators: Mapping[str, Mapping[str, Any]], versions: Mapping[str, str]) -> str:
    tasks = {task.name: task for task in bench_peers.tasks(bench_peers.SIZE, bench_peers.LONG)}
    lines = ["| indicator | N | time (goal) | peer | its time | ratio (goal) | values differ by |", "|" + "---|" * 7]
    for name, entry in indicators.items():
        task = tasks[name]
        goal = "" if task.goal_ms is None else f" ({task.goal_ms:g})"
        peers: Mapping[str, Mapping[str, Any]] = entry["peers"] or {"": {}}
        for number, (peer, theirs) in enumerate(peers.items()):
            first = [f"`{name}`", str(entry["samples"]), f"{_short(entry['milliseconds'])} ms{goal}"]
            own = first if number == 0 else ["", "", ""]
            lines.append(
                "| " + " | ".join([*own, *_peer(peer, theirs, versions, (task.goal_ratio or {}).get(peer))]) + " |"
            )
    return "\n".join(lines)


def _peer(name: str, theirs: Mapping[str, Any], versions: Mapping[str, str], goal: float | None) -> list[str]:
    if not name:
        return ["", "", "", ""]
    wanted = "" if goal is None else f" ({goal:g})"
    same = theirs["difference"]
    title = f"{name} {versions.get(name, '')}".strip()
    return [
        title,
        f"{_short(theirs['milliseconds'])} ms",
        f"{_short(theirs['ratio'])}{wanted}",
        "" if same is None else f"{same:.0e}",
    ]


def _short(number: float) -> str:
    """Three digits, never as a power of ten."""
    return f"{float(f'{number:.3g}'):.10g}"


if __name__ == "__main__":
    main()
