"""What a hop of the monitor costs: the signal of a gearbox that changes, and the time of every second of it."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.indicators import bearing_registry, contact, gear_turns, strobed_motion
from nw_gear_monitor.indicators.bearing_window import BearingWindow
from nw_gear_monitor.indicators.window import MeshWindow, TurnsWindow
from nw_gear_monitor.machine import Machine
from nw_gear_monitor.pipeline import Pipeline
from nw_gear_monitor.signals.cycles import whole_cycles
from nw_gear_monitor.signals.section import section

RATE = 5120
NOISE = 0.01
BEARING, BEARING_SECONDS = "sb", 8
TURN = 2.0 * np.pi


def hops(machine: Machine, seconds: int) -> list[float]:
    """Return the CPU time (s) of each second of a signal in a monitor that has been warmed up.

    From half of the time on stage II shows half its mesh frequency, so that the comb of lines is rebuilt while it runs.
    """
    table = signal(machine, seconds, doubled=True)
    rows = RATE // names.WAVEFORM_BLOCKS_PER_SECOND
    blocks = [Table(table.row, table.columns, table.data[k : k + rows]) for k in range(0, len(table.data), rows)]
    warm = Pipeline(machine)
    for block in blocks[: 10 * names.WAVEFORM_BLOCKS_PER_SECOND]:
        warm.feed(block)
    spent, pipeline, began = [], Pipeline(machine), time.thread_time()
    for block in blocks:
        if pipeline.feed(block):
            spent.append(time.thread_time() - began)
            began = time.thread_time()
    return spent


def signal(machine: Machine, seconds: float, *, doubled: bool = False) -> Table:
    """Return a waveform of lines at the mesh frequencies of all stages, forces of the bearings, and a little noise."""
    columns = names.waveform_columns()
    moments = np.arange(round(seconds * RATE) + 1) / RATE
    data = np.zeros((len(moments), len(columns)))
    data[:, 0] = moments
    data[:, 1:4] = TURN * np.outer(moments, machine.rated_frequency)
    omega, count = TURN * machine.rated_frequency, len(names.MESHES)
    wave, rate = np.sin(data[:, 1:4]).sum(axis=1), np.cos(data[:, 1:4]) @ omega
    if doubled:
        late = moments > 0.5 * seconds
        wave += late * 0.5 * np.sin(0.5 * data[:, 2])
        rate += late * 0.25 * omega[1] * np.cos(0.5 * data[:, 2])
    rng = np.random.default_rng(1)
    data[:, 4 : 4 + count] = 1e-6 * (wave[:, None] + NOISE * rng.standard_normal((len(moments), count)))
    data[:, 4 + count : 4 + 2 * count] = 1e-6 * rate[:, None]
    data[:, 4 + 2 * count :] = 1e4 + 100.0 * rng.standard_normal((len(moments), len(columns) - 4 - 2 * count))
    return Table(names.ROW_SAMPLE, columns, data)


def tasks(machine: Machine) -> dict[str, tuple[Callable[[], object], Array]]:
    """Return for the indicators of longer windows and of bearings a call, and the signal it is about."""
    table = signal(machine, BEARING_SECONDS)
    phase, x, v = (np.ascontiguousarray(table.column(c)) for c in ("phase_II", "x_II_1", "v_II_1"))
    stage = machine.stage("II")
    found: dict[str, tuple[Callable[[], object], Array]] = {}
    if stage.teeth is not None:
        cycles = whole_cycles(phase, x[:, None], v[:, None], 1.0 / RATE)[0]
        points = section(table.column("time"), phase, x, v, 0.0, 1.0, len(x) - 3.0)[:, 1:]
        turns = TurnsWindow(cycles, stage.teeth)
        mesh = MeshWindow("II_1", RATE, phase, x, v, None, turns, points, stage.half_gap)
        found |= {
            "whole_cycles": (lambda: whole_cycles(phase, x[:, None], v[:, None], 1.0 / RATE), x),
            "sidebands": (lambda: gear_turns.SIDEBANDS.compute(mesh), x),
            "fm0_fm4_na4": (lambda: gear_turns.AVERAGES.compute(mesh), x),
            "strobed_motion": (lambda: strobed_motion.INDICATOR.compute(mesh), x),
            "contact": (lambda: contact.INDICATOR.compute(mesh), x),
        }
    bearing = next(b for b in machine.bearings if b.name == BEARING)
    forces = np.column_stack([table.column(column) for column in bearing.columns])
    size, angle = np.hypot(forces[:, 0], forces[:, 1]), phase / machine.shaft(bearing.shaft).teeth
    window = BearingWindow(RATE, size, forces, angle, size, angle, bearing.orders, (500.0, 2000.0))
    for indicator in bearing_registry.ALL:
        found[f"bearing_{indicator.columns[0].name}"] = (lambda i=indicator: i.compute(window), size)  # type: ignore[misc]
    return found
