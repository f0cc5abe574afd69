"""What the paper's Sec. 4 says about Figs 13-21, as statements and as 39 labels of single motions.

`statements.csv` has one row for every statement, numbered C1 to C13. A `motion` is what a stage does at one frequency
(Figs 13-15) or all through an open interval of them (Figs 19-21; beyond the last printed limit up to 0.270).
`labels.csv` has the 9 motions of Figs 13-15 and 30 more: the three stages at ten frequencies, each amid a part of the
axis in which no stage changes, chosen so that every interval has one at least.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array

MOTION, DOMINANT, ONLY = "motion", "dominant", "only"
REGIMES, MINUTE, INTEGRATOR, RING = "regimes", "minute", "integrator", "ring"
MULTI = "multi"
"""Any period from 2 up: the paper calls three dots period-doubling as well."""
FEW = 0.05
"""A section is seen as n dots where it scatters about them by less than this share of the signal's deviation."""


@dataclass(frozen=True)
class Statement:
    """One statement.

    Attributes:
        id, figure, stage: which it is; kind: how it is tested.
        low, high: of omega_e; the same number for a single frequency, NaN where it isn't about any.
        expected: label of a motion, or the multiple of the mesh frequency of a line.
        contradicts: other statements that it can't be true together with; text: it in words.
    """

    id: str
    figure: str
    stage: str
    kind: str
    low: float
    high: float
    expected: str
    contradicts: tuple[str, ...]
    text: str

    def covers(self, omega_e: float) -> bool:
        """Tell whether a frequency is the statement's, or inside its interval."""
        return omega_e == self.low if self.low == self.high else self.low < omega_e < self.high


@dataclass(frozen=True)
class Label:
    """What one stage does at one frequency, according to a statement."""

    statement: str
    stage: str
    omega_e: float
    expected: str


def read_statements() -> tuple[Statement, ...]:
    """Return all statements of the paper's Sec. 4."""
    return tuple(
        Statement(
            id=row["id"],
            figure=row["figure"],
            stage=row["stage"],
            kind=row["kind"],
            low=float(row["low"] or "nan"),
            high=float(row["high"] or "nan"),
            expected=row["expected"],
            contradicts=tuple(row["contradicts"].split()),
            text=row["text"],
        )
        for row in _rows("statements.csv")
    )


def read_labels() -> tuple[Label, ...]:
    """Return the 39 labels that the search counts."""
    return tuple(
        Label(row["statement"], row["stage"], float(row["omega_e"]), row["expected"]) for row in _rows("labels.csv")
    )


def frequencies(labels: Sequence[Label]) -> tuple[float, ...]:
    """Return the frequencies that labels need, ascending."""
    return tuple(sorted({label.omega_e for label in labels}))


def agrees(expected: str, found: str) -> bool:
    """Tell whether a motion that was found is the one expected."""
    return found in names.PERIODS[1:] if expected == MULTI else found == expected


def incompatible(one: str, other: str) -> bool:
    """Tell whether no motion agrees with both labels."""
    return not any(agrees(one, found) and agrees(other, found) for found in (*names.PERIODS, names.CHAOTIC))


def seen(x: Array, deviation: float, label: str) -> str:
    """Return what a stage's own section shows: a section of few dots is called by their number, as the paper does.

    One exponent belongs to the whole gearbox. Where it is positive every stage is chaotic, some by so little that their
    sections are dots to the eye.

    Args:
        x: section, m, (n,); deviation: standard deviation of the signal, m.
        label: by the exponent; kept where the section isn't a few dots.
    """
    if label not in (names.CHAOTIC, names.UNKNOWN) or not deviation > 0.0:
        return label
    x = x[np.isfinite(x)]
    for n in range(1, len(names.PERIODS) + 1):
        rows = len(x) // n
        if rows < 4:
            break
        folded = x[: rows * n].reshape(rows, n)
        if np.sqrt(np.mean((folded - folded.mean(axis=0)) ** 2)) < FEW * deviation:
            return names.PERIODS[n - 1]
    return label


def _rows(name: str) -> list[dict[str, str]]:
    return list(csv.DictReader(files(__package__).joinpath(name).read_text(encoding="utf-8").splitlines()))
