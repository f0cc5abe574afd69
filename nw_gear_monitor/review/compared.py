"""Tables of two runs: what ran, what each stage did, and which indicators differ most."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_monitor.review import page, summary, tables
from nw_gear_monitor.review.figures import indicators as wordings
from nw_gear_monitor.review.rundata import RunData
from nw_gear_monitor.review.tables import Cell, DataTable

Pair = tuple[RunData, RunData]
Labels = tuple[str, str]
MICRO = 1e6
MOST = 25
LEAST = 3
"""Finite values below which a mean isn't compared."""


def facts(runs: Pair, labels: Labels) -> DataTable:
    """What ran, when and in which range, of both runs."""
    both = [page.facts(run, summary.summarise(run)) for run in runs]
    rows = tuple((name, one, other) for (name, one), (_name, other) in zip(*both, strict=True))
    return DataTable("What ran", ("", *labels), rows)


def stages(runs: Pair, labels: Labels) -> DataTable:
    """Vibration and worst state of each stage in both runs."""
    rows: list[tuple[Cell, ...]] = []
    both = [summary.summarise(run).stages for run in runs]
    for one, other in zip(*both, strict=True):
        changes = (change(one.rms, other.rms), change(one.peak_to_peak, other.peak_to_peak))
        for label, row, (rms, spread) in ((labels[0], one, ("", "")), (labels[1], other, changes)):
            rows.append(
                (
                    row.stage,
                    label,
                    summary.in_words(row.frequency, 1.0, "Hz", 1),
                    f"{MICRO * row.rms:.2f}",
                    rms,
                    f"{MICRO * row.peak_to_peak:.1f}",
                    spread,
                    "not judged" if row.worst is None else (tables.state_chip(row.worst.state),),
                )
            )
    head = ("Stage", "Run", "Mesh frequency", "RMS (µm)", "Change", "Peak to peak (µm)", "Change", "Worst state")
    note = "Over the whole run; the largest of the stage's meshes. The change is from the first run to the second."
    return DataTable("Stages", head, tuple(rows), frozenset(range(3, 7)), note)


def change(one: float, other: float) -> str:
    """Relative change in words, empty where there is none to tell."""
    if not (math.isfinite(one) and math.isfinite(other)) or one == 0.0:
        return ""
    return f"{100.0 * (other / one - 1.0):+.1f} %"


@dataclass(frozen=True)
class Differing:
    """An indicator of a mesh in two runs: its means (SI), and their difference over the spread."""

    mesh: str
    column: str
    means: tuple[float, float]
    far: float


def differing(runs: Pair) -> list[Differing]:
    """Indicators of meshes that both runs have, those that differ most in terms of their spread first.

    The difference of the means is divided by the root mean square of the two standard deviations: above about 2 the
    two runs hardly overlap.
    """
    found = []
    for mesh in names.MESHES:
        tables_of = [run.indicators[mesh] for run in runs if mesh in run.indicators]
        if len(tables_of) < len(runs):
            continue
        for column in tables_of[0].columns:
            if column == "time" or column not in tables_of[1].columns:
                continue
            one, other = (v[np.isfinite(v)] for v in (table.column(column) for table in tables_of))
            if min(len(one), len(other)) < LEAST:
                continue
            spread = math.sqrt(0.5 * (float(one.var()) + float(other.var())))
            means = float(one.mean()), float(other.mean())
            if spread > 0.0:
                found.append(Differing(mesh, column, means, abs(means[1] - means[0]) / spread))
    return sorted(found, key=lambda row: -row.far)


def indicators(runs: Pair, labels: Labels) -> DataTable:
    """Means of the indicators of every mesh in both runs, those that differ most first."""
    found = differing(runs)
    rows = tuple(_indicator(row) for row in found[:MOST])
    head = ("Indicator", "Mesh", *(f"Mean {label}" for label in labels), "Change", "Change over spread")
    note = f"The {len(rows)} of {len(found)} that differ most. Runs at another speed or load differ without any fault."
    return DataTable("Indicators that differ most", head, rows, frozenset(range(2, 6)), note, folded=True)


def _indicator(row: Differing) -> tuple[str, ...]:
    words = wordings.wording(row.column)
    one, other = (f"{words.scale * mean:.4g} {words.unit}".strip() for mean in row.means)
    return (words.title, row.mesh, one, other, change(*row.means), f"{row.far:.1f}")


def alarms(run: RunData, label: str) -> DataTable:
    """Every stretch above OK of one run."""
    table = tables.alarms(run, summary.summarise(run))
    return dataclasses.replace(table, title=f"{label}: {table.title.lower()}")
