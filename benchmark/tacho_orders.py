"""Orders by the tacho alone against those by the simulator's own phase, in turbulent wind.

    .venv/bin/python benchmark/tacho_orders.py [SECONDS]

Writes benchmark/results/tacho_orders.json and the table of docs/sensors.md.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from docs_table import write_between

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.signals.tacho import OrderSpectrum, read_pulses, strongest, tacho_orders
from nw_gear_sim import config
from nw_gear_sim.drives import WindDriven
from nw_gear_sim.kinematics import derive
from nw_gear_sim.nodes.session import Session
from nw_gear_sim.sensors.accelerometer import Accelerometers, Sensor
from nw_gear_sim.sensors.path import housings_of
from nw_gear_sim.sensors.tacho import Tacho
from nw_gear_sim.wind import Settings, make_source

ROOT = Path(__file__).parent.parent
SECONDS = 120.0
BEARING_OF_STAGE = {"I": "pb1_1", "II": "sb", "III": "b21"}
TACHOS = (("output", 1), ("output", 60), ("sun", 1), ("planet", 1), ("ring", 1), ("ring", 91))
RATE = 5120.0


def simulate(seconds: float, seed: int = 1) -> dict[str, Any]:
    """Run the gearbox in Weibull wind: acceleration by column, pulses by tacho, true angle of the ring (rad)."""
    base = config.load()
    session = Session(base, WindDriven(base), "kinematic", "equilibrium", RATE, every_step=True)
    bearings = tuple(BEARING_OF_STAGE.values())
    sensor = Sensor(RATE, 490.0, 5e-4, 0.0102, 5.0, 24)
    sensors = Accelerometers(housings_of(base, bearings), sensor, session.fine_rate, seed)
    tachos = {key: Tacho(key[1]) for key in TACHOS}
    places = [names.BEARINGS.index(bearing) for bearing in bearings]
    source = make_source(Settings(seed=seed), base.wind, base.turbine)
    known = [source.sample(i) for i in range(int(seconds * 10) + 12)]

    def wind(time: float) -> dict[str, float]:
        return {"wind": float(np.interp(10.0 * time, np.arange(len(known)), known))}

    session.begin(wind(0.0))
    rows, angle = [], []
    pulses: dict[tuple[str, int], list[Array]] = {key: [] for key in TACHOS}
    while session.time < seconds:
        block = session.advance(wind(session.time + session.tick))
        fine = session.fine
        assert fine is not None
        rows.append(sensors.advance(fine.bearing_force[:, places, :2].reshape(len(fine.time), -1))[1])
        angle.append(block.phase[:, 0] / 91.0)
        for (shaft, count), tacho in tachos.items():
            column = names.SHAFTS.index(shaft)
            found = tacho.advance(fine.time, fine.shaft_angle[:, column], fine.shaft_speed[:, column])
            pulses[shaft, count].append(found)
    samples = np.concatenate(rows)
    columns = names.acceleration_columns(bearings)[1:]
    return {
        "time": np.arange(len(samples)) / RATE,
        "acceleration": dict(zip(columns, samples.T, strict=True)),
        "pulses": {key: np.concatenate(times) for key, times in pulses.items()},
        "angle": np.concatenate(angle)[: len(samples)],
        "ratio": derive(base).shaft_ratio,
        "mesh": {stage: derive(base).stage(stage).mesh_ratio for stage in names.STAGES},
    }


def compare(run: dict[str, Any]) -> list[dict[str, Any]]:
    """One row for each tacho and stage: the order of its mesh line, by pulses and by phase."""
    rows = []
    for (shaft, count), times in run["pulses"].items():
        pulses = read_pulses(times, count)
        true_turns = run["angle"] * run["ratio"][shaft] / (2.0 * math.pi)
        marks = np.arange(math.ceil(true_turns[0] * 64), math.floor(true_turns[-1] * 64)) / 64.0
        ideal = read_pulses(np.interp(marks, true_turns, run["time"]), 64)
        for stage, bearing in BEARING_OF_STAGE.items():
            x = run["acceleration"][f"ax_{bearing}"]
            order = run["mesh"][stage] / run["ratio"][shaft]
            spectra = [
                tacho_orders(p, run["time"], x, turns=_turns(p.number[-1] // p.per_turn)) for p in (pulses, ideal)
            ]
            (found, size), (expected, true_size) = (_line(spectrum, order) for spectrum in spectra)
            rows.append(
                {
                    "shaft": shaft,
                    "pulses": count,
                    "faults": len(pulses.faults),
                    "stage": stage,
                    "order": order,
                    "found": found,
                    "error_by_phase": abs(found / expected - 1.0),
                    "error_by_teeth": abs(found / order - 1.0),
                    "amplitude": size,
                    "amplitude_ratio": size / true_size,
                }
            )
    return rows


def _turns(there: int) -> int:
    return int(min(256, there))


def _line(spectrum: OrderSpectrum, order: float) -> tuple[float, float]:
    return strongest(spectrum, 0.99 * order, 1.01 * order)


def table(rows: list[dict[str, Any]], run: dict[str, Any]) -> str:
    """The rows as Markdown."""
    intervals = np.diff(run["pulses"]["output", 1])
    seconds, sway = run["time"][-1], intervals.max() / intervals.min() - 1.0
    lines = [
        f"{seconds:.0f} s in Weibull wind (seed 1); the speed varies by {100 * sway:.1f} %.",
        "",
        "| tacho | pulses a turn | line | order by teeth | off the order by phase | off the teeth | amplitude |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        lines.append(
            f"| {row['shaft']} | {row['pulses']} | f_{row['stage']} | {row['order']:.4f} | {row['error_by_phase']:.1e} "
            f"| {row['error_by_teeth']:.1e} | {100 * row['amplitude_ratio']:.1f} % |"
        )
    return "\n".join(lines)


def main() -> None:
    """Measure and write."""
    run = simulate(float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS)
    rows = compare(run)
    results = ROOT / "benchmark/results"
    results.mkdir(exist_ok=True)
    (results / "tacho_orders.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    write_between(ROOT / "docs/sensors.md", "tacho_orders", table(rows, run))
    print(table(rows, run))


if __name__ == "__main__":
    main()
