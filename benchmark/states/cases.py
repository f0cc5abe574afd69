"""Cases of the benchmark: parameters drawn at random, kept as lists of numbers in CSV files, turned into signals.

`python benchmark/states/cases.py` draws both sets anew (minutes); benchmark/states/run.py only reads them.
"""

from __future__ import annotations

import csv
import json
import sys
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))

from nw_gear_common import names
from nw_gear_common.tables import Array
from states import systems
from states.draw import FAMILIES, Family
from states.truth import WINDOW, truth

FOLDER = Path(__file__).parent
SETS = {"tuning": 20240, "held-out": 77001}
"""Seeds of the two sets: thresholds were chosen on the first, error rates come from the second."""
FIELDS = ("family", "system", "label", "exponent", "per_cycle", "both", "seed", "first", "p", "state")


@dataclass(frozen=True, eq=False)
class Case:
    """One system at one setting, and how it is seen.

    Attributes:
        family, system: what it is; families are drawn from one box of parameters.
        label: its true state.
        exponent: largest Lyapunov exponent, nats a strobe.
        per_cycle: samples to a period of the drive (flows), not a whole number.
        both: whether a second channel (v, or the second coordinate) is seen.
        seed: of the noise.
        first, p, state: cycle, parameters and state at which the window begins.
    """

    family: str
    system: str
    label: str
    exponent: float
    per_cycle: float
    both: bool
    seed: int
    first: int
    p: Array
    state: Array


@dataclass(frozen=True, eq=False)
class Signal:
    """What a sensor sees of a case: samples with their strobe phase, or one point a period (phase None)."""

    x: Array
    v: Array | None
    phase: Array | None


def signal(case: Case, noise_db: float, *, cycles: int = WINDOW) -> Signal:
    """The sampled signal of a case with white noise on each channel.

    Args:
        case: the case.
        noise_db: 20 log10(standard deviation of the sampled channel / that of its noise); infinite: none.
        cycles: length of the window, periods of the drive.
    """
    wave, _ = systems.run(case.system, case.p, case.state.copy(), case.first, cycles, keep=True)
    view = systems.seen(case.system, wave)
    if systems.is_map(case.system):
        phase, clean = None, view[:, 0, :2]
    else:
        grid, clean = sampled(view, case.per_cycle, case.p[0])
        phase = systems.TAU * grid
    random = np.random.default_rng([case.seed, 0 if np.isinf(noise_db) else int(10 * noise_db)])
    noise = clean.std(axis=0) * 10.0 ** (-noise_db / 20.0) * random.standard_normal(clean.shape)
    noisy = clean + noise
    return Signal(noisy[:, 0].copy(), noisy[:, 1].copy() if case.both else None, phase)


def sampled(view: Array, per_cycle: float, omega: float) -> tuple[Array, Array]:
    """Sample an orbit at equal steps: cycles (fractional) and (samples, 2) x and v, by quintic Hermite interpolation.

    Args:
        view: (cycles, values, 3) x, v and v' at equal phases.
        per_cycle: samples to a cycle.
        omega: of the drive, rad per unit time.
    """
    cycles, width = view.shape[:2]
    flat = view.reshape(-1, 3)
    step = systems.TAU / (omega * width)
    grid = np.arange(0.0, cycles - 1.5 / width, 1.0 / per_cycle)
    i = np.minimum((grid * width).astype(np.int64), len(flat) - 2)
    t = (grid * width - i)[:, None]
    a, b = flat[i], flat[i + 1]
    x0, v0, w0 = a[:, :1], step * a[:, 1:2], step * step * a[:, 2:]
    x1, v1, w1 = b[:, :1], step * b[:, 1:2], step * step * b[:, 2:]
    gap, c1, c2 = x1 - x0 - v0 - 0.5 * w0, v1 - v0 - w0, w1 - w0
    k3, k4, k5 = 10.0 * gap - 4.0 * c1 + 0.5 * c2, -15.0 * gap + 7.0 * c1 - c2, 6.0 * gap - 3.0 * c1 + 0.5 * c2
    x = x0 + t * (v0 + t * (0.5 * w0 + t * (k3 + t * (k4 + t * k5))))
    v = (v0 + t * (w0 + t * (3.0 * k3 + t * (4.0 * k4 + t * 5.0 * k5)))) / step
    return grid, np.hstack([x, v])


def draw(name: str) -> tuple[list[Case], Counter[str]]:
    """Draw a set; returns its cases and how many candidates each rule of exclusion took."""
    cases: list[Case] = []
    excluded: Counter[str] = Counter()
    for number, family in enumerate(FAMILIES):
        if name in family.sets:
            began = time.monotonic()
            found, dropped = _of_family(family, np.random.default_rng([SETS[name], number]))
            cases += found
            excluded += dropped
            print(
                f"{name} {family.name}: {len(found)} cases, {time.monotonic() - began:.0f} s",
                file=sys.stderr,
                flush=True,
            )
    return cases, excluded


def _of_family(family: Family, random: np.random.Generator) -> tuple[list[Case], Counter[str]]:
    cases: list[Case] = []
    have: Counter[str] = Counter()
    excluded: Counter[str] = Counter()
    for _ in range(family.candidates):
        p, start = family.parameters(random)
        per_cycle, both, seed = random.uniform(12.3, 60.0), bool(random.integers(2)), int(random.integers(2**31))
        found = truth(family.system, p, start)
        if not found.label:
            excluded[found.why] += 1
        elif have[found.label] >= family.quota(found.label):
            excluded["enough of these"] += 1
        else:
            have[found.label] += 1
            both = both and family.two_channels
            cases.append(
                Case(
                    family.name,
                    family.system,
                    found.label,
                    found.exponent,
                    per_cycle,
                    both,
                    seed,
                    found.first,
                    p,
                    found.state,
                )
            )
    return cases, excluded


def path(name: str) -> Path:
    """File of a set."""
    return FOLDER / f"{name}.csv"


def write(name: str, cases: list[Case]) -> None:
    """Keep a set: one row a case, numbers so that they come back bit for bit."""
    with path(name).open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(FIELDS)
        for case in cases:
            lists = [" ".join(repr(float(value)) for value in values) for values in (case.p, case.state)]
            writer.writerow([getattr(case, field) for field in FIELDS[:-2]] + lists)


def read(name: str) -> list[Case]:
    """Read a set."""
    with path(name).open(newline="", encoding="utf-8") as file:
        return [_case(row) for row in csv.DictReader(file)]


def _case(row: dict[str, str]) -> Case:
    if row["label"] not in names.STATES:
        raise ValueError(f"no such state: {row['label']}")
    return Case(
        family=row["family"],
        system=row["system"],
        label=row["label"],
        exponent=float(row["exponent"]),
        per_cycle=float(row["per_cycle"]),
        both=row["both"] == "True",
        seed=int(row["seed"]),
        first=int(row["first"]),
        p=np.array([float(part) for part in row["p"].split()]),
        state=np.array([float(part) for part in row["state"].split()]),
    )


if __name__ == "__main__":
    dropped = {}
    for chosen in sys.argv[1:] or list(SETS):
        drawn, counts = draw(chosen)
        write(chosen, drawn)
        dropped[chosen] = dict(sorted(counts.items()))
        (FOLDER / f"{chosen}-excluded.json").write_text(json.dumps(dropped[chosen], indent=1) + "\n", encoding="utf-8")
        print(chosen, len(drawn), dict(Counter(case.label for case in drawn)), dropped[chosen], file=sys.stderr)
