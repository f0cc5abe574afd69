"""What a soak has to show, judged after its end, and the table of the documentation."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from docs_table import write_between

from nw_gear_common.machine import describe
from nw_gear_monitor.records.reader import Recording
from soak.suite import Suite
from soak.witness import WAVEFORM, Witness

MOST_GROWTH = 0.05
"""Share of its memory by which a process may grow after its warm-up, besides SLACK megabytes."""
SLACK = 8.0
JUDGED = 600.0
"""Seconds that a process has to have lived for its growth to be judged."""


def result(
    hours: float,
    suite: Suite,
    witness: Witness,
    restarts: list[dict[str, Any]],
    problems: list[str],
    lost: float,
) -> dict[str, Any]:
    """Return everything that was found; `problems` gets what isn't as it should be."""
    problems = list(problems)
    problems += [f"{name} ended with exit code {code}" for name, code in suite.codes if code != 0]
    if witness.gaps:
        problems.append(f"{witness.missing} samples missing at {witness.gaps} places of the waveform")
    if lost != 0.0:
        problems.append(f"the recorder lost {lost:g} messages")
    memory = [_memory(run.name, run.ages, run.growth()) for run in suite.ended if run.ages]
    problems += [f"{m['node']} grew from {m['warm_mb']:.0f} to {m['end_mb']:.0f} MB" for m in memory if m["grew"]]
    recordings = [_recording(path, problems) for path in suite.recordings]
    return {
        "machine": describe().as_values(),
        "hours": hours,
        "blocks": witness.blocks,
        "samples": witness.samples,
        "missing_samples": witness.missing,
        "recorder_lost": lost,
        "restarts": restarts,
        "memory": memory,
        "recordings": recordings,
        "problems": problems,
    }


def _memory(name: str, ages: list[float], growth: tuple[float, float, float]) -> dict[str, Any]:
    warm, end, slope = growth
    grew = ages[-1] > JUDGED and end - warm > MOST_GROWTH * warm + SLACK
    return {"node": name, "age_s": ages[-1], "warm_mb": warm, "end_mb": end, "slope_mb_per_hour": slope, "grew": grew}


def _recording(path: Path, problems: list[str]) -> dict[str, Any]:
    """Open a recording and look for breaks in its waveform: one for each start of the simulator meanwhile, no more."""
    if not path.exists():
        problems.append(f"{path.name} isn't there")
        return {"name": path.name}
    with Recording.open(path) as recording:
        if not recording.complete:
            problems.append(f"{path.name} isn't complete: {recording.damage}")
        blocks, last, breaks, period = 0, np.nan, 0, np.nan
        for _time, table in recording.tables(WAVEFORM):
            stamps = table.column("time")
            period = float(stamps[-1] - stamps[0]) / (len(stamps) - 1)
            breaks += bool(abs(stamps[0] - last - period) > 0.5 * period)
            last = float(stamps[-1])
            blocks += 1
        return {"name": path.name, "seconds": recording.end - recording.start, "blocks": blocks, "breaks": breaks}


def publish(found: dict[str, Any], root: Path) -> None:
    """Keep the result and write the tables of docs/soak.md."""
    (root / "benchmark" / "results" / "soak.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    page = root / "docs" / "soak.md"
    write_between(page, "soak", "\n".join(_tables(found)))


def _tables(found: dict[str, Any]) -> list[str]:
    lines = [
        f"{found['hours']:g} h in real time: {found['blocks']} blocks heard, "
        f"{found['missing_samples']} samples missing, {found['recorder_lost']:g} messages lost by the recorder, "
        + ("; ".join(found["problems"]) or "nothing else to complain of")
        + ".",
        "",
        "| process | age (s) | memory after the warm-up (MB) | at its end (MB) | slope (MB/h) |",
        "|---|---|---|---|---|",
    ]
    for m in found["memory"]:
        cells = (f"{m['age_s']:.0f}", f"{m['warm_mb']:.1f}", f"{m['end_mb']:.1f}", f"{m['slope_mb_per_hour']:+.1f}")
        lines.append(f"| {m['node']} | " + " | ".join(cells) + " |")
    lines += ["", "| restarted | missing noticed after (s) | back after (s) |", "|---|---|---|"]
    for r in found["restarts"]:
        times = ["never" if r[key] is None else f"{r[key]:.1f}" for key in ("noticed_s", "back_s")]
        lines.append(f"| {r['node']} | {times[0]} | {times[1]} |")
    lines += ["", "| recording | seconds | blocks | breaks |", "|---|---|---|---|"]
    for r in found["recordings"]:
        if "blocks" in r:
            lines.append(f"| {r['name']} | {r['seconds']:.0f} | {r['blocks']} | {r['breaks']} |")
    return lines
