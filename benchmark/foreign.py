"""Labels that the monitor gives the gear pair of Kahraman and Singh, which isn't our model, beside its true states.

`PYTHONPATH=. python benchmark/foreign.py` writes benchmark/results/foreign.json and the table in docs/foreign.md.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from docs_table import write_between

from nw_gear_common.tables import Array
from nw_gear_monitor.machinefile.read import load
from nw_gear_monitor.pipeline import Pipeline
from test.monitor import foreign

ROOT = Path(__file__).resolve().parents[1]
OMEGAS = (0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 1.0, 1.05, 1.15, 1.2, 1.3, 1.4, 1.6, 1.8)
NOISE = {"40 dB": 1e-2, "20 dB": 1e-1}
SECONDS = 16.0
STILL = 1e-4
"""Strobes that come back within this (half gaps) are the same."""
LEAST_EXPONENT = 0.02
"""Exponents nearer to zero than this, a mesh period, leave the state open."""


def truth(omega: float) -> tuple[str, float]:
    """The true state by returning strobes and a twin, and the largest exponent a mesh period."""
    times: Array = np.arange(150.0) * (2.0 * np.pi / omega)
    strobes = foreign.integrate(foreign.settled(omega), times, omega)
    exponent = foreign.largest_exponent(omega)
    periods = [n for n in range(1, 17) if np.abs(strobes[n:] - strobes[:-n]).max() < STILL]
    if periods:
        return f"period-{periods[0]}", exponent
    return "chaotic" if exponent > LEAST_EXPONENT else "open", exponent


def label(omega: float, noise: float) -> str:
    """What the monitor shows after SECONDS."""
    time, x, angle = foreign.pair(omega, SECONDS, noise)
    machine = load(ROOT / "config" / "machine_example.yaml")
    hops = Pipeline(machine).feed(foreign.table(np.column_stack([time, angle, x, foreign.bearing(time, angle)])))
    return hops[-1].stages["pair"].state.label


def row(omega: float) -> dict[str, float | str]:
    """One line of the table."""
    state, exponent = truth(omega)
    found: dict[str, float | str] = {"omega": omega, "truth": state, "exponent": round(exponent, 3)}
    return found | {name: label(omega, noise) for name, noise in NOISE.items()}


def publish(rows: list[dict[str, float | str]]) -> None:
    """Write the results and the table of the documentation."""
    (ROOT / "benchmark" / "results" / "foreign.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    head = ["Ω", "true state", "exponent per mesh period", *NOISE]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for found in rows:
        shown = [found["omega"], found["truth"], found["exponent"], *(found[name] for name in NOISE)]
        lines.append("| " + " | ".join(map(str, shown)) + " |")
    exact = {name: sum(found[name] == found["truth"] for found in rows) for name in NOISE}
    counted = ", ".join(f"{number} of {len(rows)} at {name}" for name, number in exact.items())
    write_between(ROOT / "docs" / "foreign.md", "foreign", "\n".join(lines) + f"\n\nRight: {counted}.")


if __name__ == "__main__":
    publish([row(omega) for omega in OMEGAS])
