"""Tables of the benchmark's results in Markdown."""

from __future__ import annotations

import itertools
from collections import Counter
from typing import Any

import numpy as np

from nw_gear_common import names
from states.rivals import right

GROUPS = ("period-1", "period-2 to 4", "period-5 to 16", names.QUASI_PERIODIC, names.CHAOTIC)
OTHER = (names.TRANSIENT, names.UNKNOWN)
RIVALS = {"zero_one": "0-1 test alone", "clusters": "counting clusters", "recurrence": "recurrence, fixed tolerance"}
CONFIDENCES = (0.0, 0.7, 0.9, 0.97, 1.01)
Rows = list[dict[str, Any]]


def tables(results: dict[str, Any]) -> str:
    """All tables: rates, confusion matrices, reliability of the confidence, noise estimate."""
    cases: dict[str, Rows] = {
        level: results["cases"][level] for level in sorted(results["cases"], key=lambda level: -float(level))
    }
    parts = [_rates(cases), *(_confusion(level, rows) for level, rows in cases.items())]
    cost = ", ".join(f"{ms:.0f} ms at {level} dB" for level, ms in results["median_cpu_ms"].items())
    return "\n\n".join([*parts, _reliability(cases), _noise(cases), f"Median CPU time of a call: {cost}."])


def group(label: str) -> str:
    """The row or column of a confusion matrix that a label belongs to."""
    if label not in names.PERIODS:
        return label
    period = names.PERIODS.index(label) + 1
    return GROUPS[0] if period == 1 else (GROUPS[1] if period <= 4 else GROUPS[2])


def _rates(cases: dict[str, Rows]) -> str:
    """Share of exact labels, per level: all, by kind of motion, and of the rivals."""
    count = len(next(iter(cases.values())))
    lines = [
        f"Exact labels of {count} held-out cases, %:",
        "",
        "| | " + " | ".join(_named(level) for level in cases) + " |",
    ]
    lines.append("|---" * (len(cases) + 1) + "|")
    kinds = {"all": GROUPS, "periodic": GROUPS[:3], "quasi-periodic": GROUPS[3:4], "chaotic": GROUPS[4:]}
    for kind, members in kinds.items():
        chosen = {level: [row for row in rows if group(row["truth"]) in members] for level, rows in cases.items()}
        shares = [np.mean([row["label"] == row["truth"] for row in rows]) for rows in chosen.values()]
        size = len(next(iter(chosen.values())))
        lines.append(f"| {kind} ({size}) | " + " | ".join(f"{100 * share:.1f}" for share in shares) + " |")
    regular = [
        sum(row["label"] == names.CHAOTIC and row["truth"] != names.CHAOTIC for row in rows) for rows in cases.values()
    ]
    lines.append("| regular called `chaotic`, cases | " + " | ".join(str(number) for number in regular) + " |")
    for rival, title in RIVALS.items():
        shares = [np.mean([right(row[rival], row["truth"]) for row in rows]) for rows in cases.values()]
        lines.append(f"| {title} | " + " | ".join(f"{100 * share:.1f}" for share in shares) + " |")
    return "\n".join(lines)


def _confusion(level: str, rows: Rows) -> str:
    """Truth in rows, label in columns; a wrong period within a group is counted apart."""
    columns = (*GROUPS, *OTHER)
    lines = [f"{_named(level)}:", "", "| truth | " + " | ".join(columns) + " | wrong period |"]
    lines.append("|---" * (len(columns) + 2) + "|")
    for truth in GROUPS:
        own = [row for row in rows if group(row["truth"]) == truth]
        wrong = [row for row in own if row["label"] != row["truth"] and group(row["label"]) == truth]
        counts = Counter(group(row["label"]) for row in own)
        counts[truth] -= len(wrong)
        cells = [str(counts[column] or "") for column in columns] + [str(len(wrong) or "")]
        lines.append(f"| {truth} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _reliability(cases: dict[str, Rows]) -> str:
    """How often labels of a confidence are right, all levels together."""
    rows = [row for level in cases.values() for row in level if row["label"] not in OTHER]
    lines = [
        "Confidence given, and share of right labels (all levels):",
        "",
        "| confidence | labels | right, % |",
        "|---|---|---|",
    ]
    for low, high in itertools.pairwise(CONFIDENCES):
        own = [row for row in rows if low <= row["confidence"] < high]
        if own:
            mean = np.mean([row["confidence"] for row in own])
            share = np.mean([row["label"] == row["truth"] for row in own])
            lines.append(f"| {mean:.2f} | {len(own)} | {100 * share:.1f} |")
    return "\n".join(lines)


def _noise(cases: dict[str, Rows]) -> str:
    """Estimated less true noise level of rightly labelled cases."""
    lines = ["Estimated less true noise level, dB, median and 5 to 95 % of rightly labelled cases:", ""]
    lines += ["| noise | flows, periodic | flows, others | maps, periodic | maps, others |", "|---" * 5 + "|"]
    for level, rows in cases.items():
        if level == "inf":
            continue
        cells = []
        for is_map in (False, True):
            for periodic in (True, False):
                error = [
                    row["noise_db"] - float(level)
                    for row in rows
                    if row["noise_db"] is not None
                    and row["label"] == row["truth"]
                    and row["map"] == is_map
                    and (row["label"] in names.PERIODS) == periodic
                ]
                low, middle, high = np.percentile(error, [5, 50, 95]) if error else (np.nan, np.nan, np.nan)
                cells.append(f"{middle:+.1f} ({low:+.1f} to {high:+.1f})")
        lines.append(f"| {_named(level)} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _named(level: str) -> str:
    return "no noise" if level == "inf" else f"{level} dB"
