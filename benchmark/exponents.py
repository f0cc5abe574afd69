"""Exponents of the presets: variational equations with the rigid and the flexible ring, and twins, in one run.

Run `python benchmark/exponents.py`; it writes results/exponents.json, goes on from there where it was stopped, and
writes the table of docs/lyapunov.md. Without the file it measures all anew.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from docs_table import write_between

from nw_gear_sim import config
from nw_gear_sim.kinematics import derive
from nw_gear_sim.lyapunov import largest_exponent
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.simulation import Simulation
from nw_gear_sim.studies.lyapunov import steps_between
from nw_gear_sim.tangent.benettin import spectrum
from nw_gear_sim.tangent.flow import Flow

HERE = Path(__file__).parent
PAGE = HERE.parent / "docs" / "lyapunov.md"
TRANSIENT = 2.0
RECORD = {"rigid": 10.0, "flexible": 4.0}
SPECTRUM = 1.0
SAMPLES = 1024
"""Between two pulls of the twins, of 5120 a second."""


def cases() -> dict[str, Configuration]:
    """Return the motions, by name."""
    found = {name: config.load(name) for name in ("rated", "rattling", "period2", "period4")}
    return found | {"load 3 %": config.with_values({"operation.load": 0.03}, config.load("rated"))}


def variational(configuration: Configuration, ring: str, count: int, record: float) -> dict[str, Any]:
    """Return exponents by the variational equations, and what they cost."""
    flow = Flow(configuration, count, ring=ring)
    flow.carry(flow.beginning(), 1)
    flow.settle(TRANSIENT)
    steps = steps_between(flow, 1.0 / flow.mesh_frequency("II"))
    interval = steps * flow.step
    began = time.thread_time()
    found = spectrum(lambda y: flow.carry(y, steps), flow.beginning(), interval, round(record / interval))
    cost = (time.thread_time() - began) / record
    return {
        "rate": found.rate.tolist(), "error": found.error.tolist(), "divergence": found.divergence,
        "dimension": found.dimension, "seconds_per_second": cost,
    }  # fmt: skip


def twins(configuration: Configuration, ring: str, record: float) -> dict[str, Any]:
    """Return the largest exponent by a twin trajectory of the same solver, and what it costs."""
    changed = {"numerics.integrator": "etdrk4", "numerics.ring": ring}
    kinematics = derive(configuration)
    speed, torque = kinematics.ring_speed, kinematics.input_torque
    drive = Drive(speed, speed, torque, torque)
    simulation = Simulation(config.with_values(changed, configuration), drive)
    simulation.advance(round(TRANSIENT * 5120), drive)
    began = time.thread_time()
    found = largest_exponent(simulation, [(SAMPLES, drive)] * round(record * 5120 / SAMPLES))
    return {"rate": [found.rate], "error": [found.error], "seconds_per_second": (time.thread_time() - began) / record}


def main() -> None:
    """Measure what isn't there yet, keep each figure as it comes, and write the table."""
    path = HERE / "results" / "exponents.json"
    results: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    fixed = {name: config.with_values({"operation.drive": "fixed"}, case) for name, case in cases().items()}
    wanted: list[tuple[str, str, Callable[[], dict[str, Any]]]] = []
    for name, case in fixed.items():
        wanted.append((name, "rigid", partial(variational, case, "rigid", 1, RECORD["rigid"])))
        wanted.append((name, "rigid twins", partial(twins, case, "rigid", RECORD["rigid"])))
    for name in ("rated", "rattling"):
        wanted.append((name, "spectrum", partial(variational, fixed[name], "rigid", 134, SPECTRUM)))
    for name, case in fixed.items():
        wanted.append((name, "flexible", partial(variational, case, "flexible", 1, RECORD["flexible"])))
    for name, way, measure in wanted:
        if way in results.setdefault(name, {}):
            continue
        found = results[name][way] = measure()
        print(name, way, found["rate"][:3], found["error"][:3], f"{found['seconds_per_second']:.2g} s/s", flush=True)
        path.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    write_between(PAGE, "exponents", _table(results))


def _table(results: dict[str, Any]) -> str:
    ways = ("rigid", "rigid twins", "flexible")
    lines = [
        "| motion | rigid ring, variational (1/s) | rigid ring, twins (1/s) | flexible ring, variational (1/s) |",
        "|---|---|---|---|",
    ]
    for name, found in results.items():
        cells = (_measured(found.get(way)) for way in ways)
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    cost = results["rated"]
    seconds = [cost[way]["seconds_per_second"] for way in (*ways, "spectrum")]
    lines += [
        "",
        f"Processor seconds for a second of motion: {seconds[0]:.2g}, {seconds[1]:.2g}, {seconds[2]:.2g}; "
        f"all 134 exponents of the rigid ring: {seconds[3]:.2g}.",
        "",
        "| all 134 exponents | first three (1/s) | sum (1/s) | mean divergence (1/s) | Kaplan-Yorke dimension |",
        "|---|---|---|---|---|",
    ]
    for name in ("rated", "rattling"):
        found = results[name]["spectrum"]
        first = ", ".join(
            f"{rate:.1f} ± {error:.1f}" for rate, error in zip(found["rate"][:3], found["error"][:3], strict=True)
        )
        total = sum(found["rate"])
        lines.append(f"| {name} | {first} | {total:.1f} | {found['divergence']:.1f} | {found['dimension']:.1f} |")
    return "\n".join(lines)


def _measured(found: dict[str, Any] | None) -> str:
    return f"{found['rate'][0]:.2f} ± {found['error'][0]:.2f}" if found else "not measured"


if __name__ == "__main__":
    main()
