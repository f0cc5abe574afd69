"""A made-up run in the shape of the contract: tables and messages as a recording gives them, in order of time.

The signals are sums of lines at known frequencies and amplitudes, so that every number of a report has a closed form.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array, Table

RATE = 5120.0
BLOCK = 256
FREQUENCY = {"I": 26.24, "II": 98.99, "III": 324.2}
AMPLITUDE = {"I": 1.5e-6, "II": 2.5e-6, "III": 1.2e-6}
OFFSET = {"I": 220e-6, "II": 140e-6, "III": 90e-6}
RING_SPEED = 17.3 * math.pi / 30.0
TORQUE = 2.7e6
WIND = 11.0
PROVENANCE = {
    "nw_gear.run": {"command_line": "nw_gear demo --duration 10", "versions": '{"nw_gear": "0.1.0", "python": "3.11"}'},
    "nw_gear.node.wind_node": {"source": "weibull", "seed": "7"},
    "nw_gear.node.gear_sim_node": {"config": "", "excitation": "kinematic", "resolved_config": "gear:\n  teeth: 91\n"},
}


def phase_shift(mesh: str) -> float:
    """Phase of a planet's mesh against the first one (rad)."""
    return 2.0 * math.pi * (int(mesh[-1]) - 1) / 3.0 if mesh[-1] in "123" and mesh != "III" else 0.0


def displacement(mesh: str, time: Array) -> tuple[Array, Array]:
    """x (m) and v (m/s) of one mesh."""
    stage = names.STAGE_OF_MESH[mesh]
    w = 2.0 * math.pi * FREQUENCY[stage]
    angle = w * time + phase_shift(mesh)
    return OFFSET[stage] + AMPLITUDE[stage] * np.sin(angle), AMPLITUDE[stage] * w * np.cos(angle)


def waveform(start: float, rows: int = BLOCK, origin: float = 0.0) -> Table:
    """A block of samples that begins `start` s after the origin of time."""
    time = start + np.arange(rows) / RATE
    columns = [origin + time, *(2.0 * math.pi * FREQUENCY[s] * time for s in names.STAGES)]
    pairs = [displacement(m, time) for m in names.MESHES]
    columns += [x for x, _ in pairs] + [v for _, v in pairs]
    for i, _bearing in enumerate(names.WAVEFORM_BEARINGS):
        columns += [3e3 * (i + 1) + 200.0 * np.sin(50.0 * time), 4e3 * (i + 1) + 0.0 * time]
    return Table(names.ROW_SAMPLE, names.waveform_columns(), np.column_stack(columns))


def spectrum(axis_name: str) -> Table:
    """Lines of the right amplitude at the bins nearest to their frequency or order, over a small floor."""
    if axis_name == "frequency":
        axis = np.arange(0.0, 2560.25, 0.25)
        at = {m: FREQUENCY[names.STAGE_OF_MESH[m]] for m in names.MESHES}
    else:
        axis = np.arange(0.0, 8.0, 1.0 / 64.0)
        at = dict.fromkeys(names.MESHES, 1.0)
    data = np.full((len(axis), 1 + len(names.MESHES)), 2e-11)
    data[:, 0] = axis
    for i, mesh in enumerate(names.MESHES):
        data[np.argmin(np.abs(axis - at[mesh])), 1 + i] = AMPLITUDE[names.STAGE_OF_MESH[mesh]]
    row = names.ROW_BIN if axis_name == "frequency" else names.ROW_ORDER
    return Table(row, (axis_name, *names.MESHES), data)


def section(stage: str, begin: float, end: float, origin: float = 0.0) -> Table:
    """Points of a period-1 motion between two times."""
    rows = []
    for mesh in names.MESHES_OF_STAGE[stage]:
        period = 1.0 / FREQUENCY[stage]
        times = period * np.arange(math.ceil(begin / period), math.ceil(end / period))
        x, v = displacement(mesh, times)
        planet = int(mesh[-1]) if "_" in mesh else 1
        rows += [(origin + t, planet, a, b) for t, a, b in zip(times, x, v, strict=True)]
    return Table(names.ROW_POINT, names.SECTION_COLUMNS, np.array(sorted(rows)).reshape(-1, 4))


def _header(time: float) -> SimpleNamespace:
    return SimpleNamespace(stamp=SimpleNamespace(sec=int(time // 1), nanosec=round(time % 1 * 1e9)), frame_id="")


def _status(name: str, level: int, message: str, **values: str) -> SimpleNamespace:
    pairs = [SimpleNamespace(key=k, value=v) for k, v in values.items()]
    return SimpleNamespace(name=name, level=bytes([level]), message=message, hardware_id="/nw_gear", values=pairs)


def truth(share: float) -> SimpleNamespace:
    """The simulator's truth, with mesh II_2 open for a share of the time."""
    known = {"excitation": "kinematic"}
    for mesh in names.MESHES:
        known[f"open fraction {mesh} (1)"] = f"{share if mesh == 'II_2' else 0.0:.6f}"
        known[f"back-flank fraction {mesh} (1)"] = "0.000000"
    return _status("gear_sim_node: truth", 0, "no faults", **known)


def diagnostics(time: float, states: dict[str, tuple[int, str, str]]) -> SimpleNamespace:
    """One DiagnosticArray: stage to (level, state, reason)."""
    found = [
        _status(f"gear_monitor_node: stage {stage}", level, f"{state}: {reason}", state=state)
        for stage, (level, state, reason) in states.items()
    ]
    return SimpleNamespace(header=_header(time), status=found)


def stream(seconds: int, *, origin: float = 0.0, monitor: bool = True) -> Iterator[tuple[str, float, Any]]:
    """Messages of a run: (relative topic, log time, Table or message).

    Stage II is `chaotic` (with a warning) in the third quarter of the run and `period-1` otherwise.
    """
    yield names.TRUTH, origin, truth(0.2)
    yield names.TRUTH, origin + 0.5, truth(0.4)
    for tick in range(20 * seconds):
        now = tick / 20.0
        at = origin + now + 0.05
        if tick % 2 == 0:
            wind = SimpleNamespace(x=WIND + math.sin(now), y=0.0, z=0.0)
            yield names.WIND_SPEED, at, SimpleNamespace(header=_header(origin + now), vector=wind)
        yield names.SHAFTS_TOPIC, at, _joints(origin + now, names.SHAFTS, RING_SPEED, TORQUE)
        yield names.MESH_TOPIC, at, _joints(origin + now, names.MESHES, 0.0, 1e5)
        for bearing in names.BEARINGS:
            force = SimpleNamespace(x=3e3, y=4e3, z=-500.0)
            message = SimpleNamespace(header=_header(origin + now), wrench=SimpleNamespace(force=force))
            yield names.bearing_topic(bearing), at, message
        yield names.WAVEFORM, at, waveform(now, origin=origin)
        if monitor and tick % 20 == 19:
            yield from _monitor(tick // 20 + 1, seconds, origin)


def _monitor(second: int, seconds: int, origin: float) -> Iterator[tuple[str, float, Any]]:
    at = origin + second + 0.06
    yield names.SPECTRUM, at, spectrum("frequency")
    yield names.ORDERS, at, spectrum("order")
    for stage in names.STAGES:
        yield names.section_topic(stage), at, section(stage, second - 1.0, float(second), origin)
    columns = ("time", "rms", "crest_factor", "rho", "never_filled")
    for mesh in names.MESHES:
        rms = AMPLITUDE[names.STAGE_OF_MESH[mesh]] / math.sqrt(2.0)
        row = np.array([[origin + second, rms, math.sqrt(2.0), math.nan if second < 3 else 0.01, math.nan]])
        yield names.indicators_topic(mesh), at, Table(names.ROW_ROW, columns, row)
    for number, bearing in enumerate(names.WAVEFORM_BEARINGS):
        row = np.array([[origin + second, 5e3 * (number + 1), 100.0, 2.0 + number, math.nan]])
        columns = ("time", "mean", "rms", "bpfo_prominence", "bsf")
        yield names.indicators_topic(bearing), at, Table(names.ROW_ROW, columns, row)
    rough = 0.5 * seconds <= second < 0.75 * seconds
    worse = (1, names.CHAOTIC, "unexplained variance 0.31") if rough else (0, "period-1", "lines explain 99 %")
    states = {"I": (0, "period-1", "lines explain 99 %"), "II": worse, "III": (0, "period-1", "lines explain 99 %")}
    yield names.DIAGNOSTICS, at, diagnostics(origin + second, states)


def _joints(time: float, joints: tuple[str, ...], velocity: float, effort: float) -> SimpleNamespace:
    size = len(joints)
    return SimpleNamespace(
        header=_header(time),
        name=list(joints),
        position=[0.0] * size,
        velocity=[velocity] * size,
        effort=[effort] * size,
    )
