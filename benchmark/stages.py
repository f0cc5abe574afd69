"""Labels of the gear stages against the model's own exponents, on records that no threshold was set on.

    python benchmark/stages.py            64 records through the monitor (some ten minutes)
    python benchmark/stages.py --table    the tables in docs/indicators.md, from the last results

Truth is the largest exponent by a twin trajectory over the record itself, and the subharmonic lines of the record
without noise. Classes are fixed beforehand: strongly chaotic above STRONG with three standard errors to 0, weakly
chaotic or undecided from there to three standard errors below 0, regular under that. The label of a record is the one
that its stage shows in most seconds once the window is full.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from docs_table import write_between

from nw_gear_common import names
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.gearing import gearing
from nw_gear_monitor.pipeline import Pipeline
from nw_gear_sim import config
from nw_gear_sim.kinematics import derive
from nw_gear_sim.lyapunov import largest_exponent
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.rotor import Rotor
from nw_gear_sim.physics.wind_weibull import WeibullWind
from nw_gear_sim.readings import Block
from nw_gear_sim.simulation import Simulation

HERE = Path(__file__).resolve().parent
RESULT = HERE / "results" / "stages.json"
PAGE = HERE.parent / "docs" / "indicators.md"
STRONG = 8.0
"""1/s; the largest exponent of rattling is about 20."""
NOISE = (None, 60.0, 40.0, 30.0, 20.0)
USUAL_SETTLING, SECONDS, WINDOW = 10.0, 22, 16
SETTLING = {"near period 4": 40.0}
"""s; motions there settle with 1.6 1/s or more slowly."""
TICK = 0.2
SUBHARMONIC = 0.15
"""A stage has period n where lines at odd multiples of f/n hold this share of the rms of its vibration."""
COLUMNS = names.waveform_columns(())
RPM = np.pi / 30.0


@dataclass(frozen=True)
class Case:
    """One record: what is changed in the configuration, mean wind (m/s, None: fixed speed and load), noise (dB)."""

    number: int
    kind: str
    values: dict[str, Any]
    wind: float | None
    noise: float | None


def cases() -> list[Case]:
    """Return the records, drawn with a fixed seed."""
    rng = np.random.default_rng(2026)
    drawn: list[tuple[str, dict[str, Any], float | None]] = []
    for load in np.linspace(0.03, 1.0, 12).tolist():
        drawn.append(
            ("default teeth", {"operation.load": load, "operation.ring_speed": rng.uniform(8, 20) * RPM}, None)
        )
    for _ in range(16):
        errors = {f"mesh.{s}.error_amplitude": rng.uniform(30, 60) * 1e-6 for s in names.STAGES}
        point = {"operation.load": rng.uniform(0.02, 0.09), "operation.ring_speed": rng.uniform(13, 19) * RPM}
        drawn.append(("large errors, idling", errors | point, None))
    for _ in range(12):
        errors = {f"mesh.{s}.error_amplitude": rng.uniform(1, 40) * 1e-6 for s in names.STAGES}
        point = {"operation.load": rng.uniform(0.15, 1.0), "operation.ring_speed": rng.uniform(8, 19) * RPM}
        drawn.append(("any errors, under load", errors | point, None))
    for amplitude in (62, 65, 68, 71, 74, 77):
        values = preset("period2") | {"mesh.II.error_amplitude": amplitude * 1e-6}
        drawn.append(("near period 2", values, None))
    for load in (0.098, 0.0993, 0.1, 0.1012):
        drawn.append(("near period 4", preset("period4") | {"operation.load": load}, None))
    for mean in (4.0, 5.0, 6.0, 7.0, 7.5, 8.0, 8.5, 9.0, 9.5, 10.0, 11.0, 12.0, 13.0, 14.0):
        drawn.append(("wind", {}, mean))
    return [Case(k, *parts, NOISE[k % len(NOISE)]) for k, parts in enumerate(drawn)]


def preset(name: str) -> dict[str, Any]:
    """Return what a preset lays over the default configuration, by key."""
    whole, base = config.load(name), config.load(None)
    found: dict[str, Any] = {}
    for section in ("operation", "excitation"):
        for key in getattr(base, section).__dataclass_fields__:
            value = getattr(getattr(whole, section), key)
            if value != getattr(getattr(base, section), key):
                found[f"{section}.{key}"] = value
    for stage in names.STAGES:
        for key in getattr(base.mesh, stage).__dataclass_fields__:
            value = getattr(getattr(whole.mesh, stage), key)
            if value != getattr(getattr(base.mesh, stage), key):
                found[f"mesh.{stage}.{key}"] = value
    return found


def record(case: Case) -> dict[str, Any]:
    """Simulate one record with its twin, and let the monitor label it."""
    configuration = config.with_values(case.values, config.load(None))
    simulation, drives = _prepare(case, configuration)
    blocks: list[Block] = []
    found = largest_exponent(simulation, drives, seen=blocks.append)
    data = _waveform(blocks)
    truth = truths(found.rate, found.error, data, configuration)
    shown = _labels(configuration, _with_noise(data, case))
    return {
        "number": case.number, "kind": case.kind, "values": case.values, "wind": case.wind, "noise": case.noise,
        "exponent": found.rate, "error": found.error, "truth": truth, "shown": shown,
    }  # fmt: skip


def truths(rate: float, error: float, data: Array, configuration: Configuration) -> dict[str, str]:
    """Return the true class of each stage: strong, weak, or period-n."""
    if rate > STRONG and rate > 3.0 * error:
        return dict.fromkeys(names.STAGES, "strongly chaotic")
    if rate > -3.0 * error:
        return dict.fromkeys(names.STAGES, "weak or undecided")
    return {stage: names.PERIODS[_period(stage, data) - 1] for stage in names.STAGES}


def _period(stage: str, data: Array) -> int:
    """Return 4, 2 or 1 by the lines at odd multiples of f/4 and f/2 over the stage's own mesh phase."""
    columns = COLUMNS
    phase = data[:, columns.index(f"phase_{stage}")]
    x = data[:, columns.index(f"x_{names.MESHES_OF_STAGE[stage][0]}")]
    grid = np.arange(phase[0], phase[-1], 2.0 * np.pi / 32.0)
    even = np.interp(grid, phase, x)
    even = (even - even.mean()) * np.hanning(len(even))
    power = np.abs(np.fft.rfft(even)) ** 2
    order = np.fft.rfftfreq(len(even), 1.0 / 32.0)
    for n in (4, 2):
        odd = [k / n for k in range(1, 4 * n, 2)]
        width = 2.5 / (len(even) / 32.0)
        lines = np.any([np.abs(order - q) < width for q in odd], axis=0)
        if np.sqrt(power[lines].sum() / power.sum()) > SUBHARMONIC:
            return n
    return 1


def _prepare(case: Case, configuration: Configuration) -> tuple[Simulation, list[tuple[int, Drive]]]:
    ticks, settling = round(SECONDS / TICK), round(SETTLING.get(case.kind, USUAL_SETTLING) / TICK)
    if case.wind is None:
        kinematics = derive(configuration)
        drive = Drive(kinematics.ring_speed, kinematics.ring_speed, kinematics.input_torque, kinematics.input_torque)
        every = [drive] * (ticks + settling)
    else:
        wind = configuration.wind
        process = WeibullWind(12.0, 1.04 * case.wind, wind.sampling_interval, wind.correlation_time, 500 + case.number)
        rotor = Rotor(configuration.turbine, process.at(0.0))
        drive = Drive(rotor.speed, rotor.speed, rotor.torque, rotor.torque)
        every = [rotor.advance(process.at(TICK * (k + 1)), TICK) for k in range(ticks + settling)]
    simulation = Simulation(configuration, drive)
    samples = round(TICK * simulation.sample_rate)
    for settled in every[:settling]:
        simulation.advance(samples, settled)
    return simulation, [(samples, later) for later in every[settling:]]


def _waveform(blocks: Sequence[Block]) -> Array:
    rows = []
    for block in blocks:
        rows.append(np.column_stack([block.time, block.phase, block.x, block.v]))
    return np.concatenate(rows)


def _with_noise(data: Array, case: Case) -> Array:
    if case.noise is None:
        return data
    noisy = data.copy()
    rng = np.random.default_rng(500 + case.number)
    first = 1 + len(names.STAGES)
    for column in range(first, data.shape[1]):
        noisy[:, column] += rng.standard_normal(len(data)) * data[:, column].std() * 10.0 ** (-case.noise / 20.0)
    return noisy


def _labels(configuration: Configuration, data: Array) -> dict[str, str]:
    pipeline = Pipeline(gearing(configuration))
    seen: dict[str, Counter[str]] = {stage: Counter() for stage in names.STAGES}
    rows = 1024
    begin = data[0, 0]
    for k in range(0, len(data), rows):
        for hop in pipeline.feed(Table(names.ROW_SAMPLE, COLUMNS, data[k : k + rows])):
            if hop.time >= begin + WINDOW + 2:
                for stage, report in hop.stages.items():
                    seen[stage][report.state.label] += 1
    return {stage: counts.most_common(1)[0][0] if counts else names.UNKNOWN for stage, counts in seen.items()}


def confusion(results: Sequence[Mapping[str, Any]]) -> str:
    """Return the table of truths against labels, all stages together, and what was promised of it."""
    pairs = Counter((r["truth"][stage], r["shown"][stage]) for r in results for stage in names.STAGES)
    rows = sorted({truth for truth, _ in pairs})
    columns = sorted({label for _, label in pairs})
    lines = ["| truth | " + " | ".join(f"`{c}`" for c in columns) + " |", "|---|" + "---|" * len(columns)]
    lines += [f"| {row} | " + " | ".join(str(pairs[row, c]) for c in columns) + " |" for row in rows]
    regular = [r for r in results if all(t in names.PERIODS for t in r["truth"].values())]
    false = sum(names.CHAOTIC in r["shown"].values() for r in regular)
    strong = [r for r in results if r["truth"]["II"] == "strongly chaotic"]
    found = sum(names.CHAOTIC in r["shown"].values() for r in strong)
    weak = [r for r in results if r["truth"]["II"] == "weak or undecided"]
    heard = sum(names.CHAOTIC in r["shown"].values() for r in weak)
    words = (
        f"{len(results)} records: {len(regular)} regular, {false} of them called `chaotic` in some stage; "
        f"{len(strong)} strongly chaotic, {found} of them found in some stage; {len(weak)} weak or undecided, "
        f"{heard} of them called `chaotic`."
    )
    return "\n".join([words, "", *lines])


def main() -> None:
    """Run the study, or write its table again."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--table", action="store_true", help="write the table from the last results alone")
    if not parser.parse_args().table:
        results = []
        with ProcessPoolExecutor(len(os.sched_getaffinity(0))) as pool:
            for result in pool.map(record, cases()):
                results.append(result)
                print(json.dumps(result), file=sys.stderr, flush=True)
        RESULT.write_text(json.dumps(results, indent=1), encoding="utf-8")
    write_between(PAGE, "stages", confusion(json.loads(RESULT.read_text(encoding="utf-8"))))


if __name__ == "__main__":
    main()
