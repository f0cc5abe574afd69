"""How far a drive's amplitude may move within the window before labels aren't robust: prints a table in Markdown.

`python benchmark/states/drift.py`: periodic flows of the held-out set, the drive growing linearly, 40 dB.
A label is `right` where it is the state of the system frozen at either end; `lost` is any other but `transient` and
`unknown`.
"""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.states.classifier import classify
from states import systems
from states.cases import Case, read, sampled
from states.truth import WINDOW, truth

GROWTH = (0.0, 0.01, 0.03, 0.1, 0.3)
CHUNK = 5
EVERY = 16
NOISE_DB = 40.0


def ramped(case: Case, growth: float) -> tuple[Array, Array, set[str]]:
    """Samples and phase while the drive grows, and the states at either end."""
    p, s = case.p.copy(), case.state.copy()
    parts = []
    for chunk in range(WINDOW // CHUNK):
        p[4] = case.p[4] * (1.0 + growth * chunk * CHUNK / WINDOW)
        wave, _ = systems.run(case.system, p, s, case.first + chunk * CHUNK, CHUNK, keep=True)
        parts.append(wave)
    grid, clean = sampled(systems.seen(case.system, np.concatenate(parts)), case.per_cycle, case.p[0])
    x = clean[:, 0]
    noise = np.random.default_rng(case.seed).standard_normal(x.size) * x.std() * 10.0 ** (-NOISE_DB / 20.0)
    return x + noise, systems.TAU * grid, {case.label, truth(case.system, p, s).label}


def main() -> None:
    """Print the table."""
    cases = [case for case in read("held-out") if case.system in systems.FLOWS and case.label in names.PERIODS]
    print("| growth of the drive | cases | right | transient | unknown | lost | called chaotic |")
    print("|---|---|---|---|---|---|---|")
    for growth in GROWTH:
        counts: Counter[str] = Counter()
        for case in cases[::EVERY]:
            x, phase, ends = ramped(case, growth)
            label = classify(x, strobe=phase).label
            kind = "right" if label in ends else label if label in (names.TRANSIENT, names.UNKNOWN) else "lost"
            counts[kind] += 1
            counts["chaotic"] += label == names.CHAOTIC and names.CHAOTIC not in ends
        columns = ("right", names.TRANSIENT, names.UNKNOWN, "lost", "chaotic")
        cells = " | ".join(str(counts[column]) for column in columns)
        print(f"| {100 * growth:g} % | {len(cases[::EVERY])} | {cells} |", flush=True)


if __name__ == "__main__":
    main()
