"""How each topic of a recording becomes rows of a tidy table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.records.stamped import JOINTS, WRENCH, Rows
from nw_gear_monitor.review.export.sinks import Column

Add = Callable[[str, Mapping[str, Column]], None]

_MESHES = {names.indicators_topic(mesh): mesh for mesh in names.MESHES}
_BEARINGS = {names.indicators_topic(bearing): bearing for bearing in names.BEARINGS}
_STAGES = {names.section_topic(stage): stage for stage in names.STAGES}
_FORCES = {names.bearing_topic(bearing): bearing for bearing in names.BEARINGS}
_OF_JOINTS = {
    names.SHAFTS_TOPIC: ("shafts", "shaft", ("angle", "angular_velocity", "torque")),
    names.MESH_TOPIC: ("mesh", "mesh", ("displacement", "velocity", "force")),
}


def file_name(topic: str) -> str:
    """Name of the table of a topic that has none of its own."""
    return topic.strip("/").replace("/", "_") or "topic"


def add_table(add: Add, topic: str, log_time: float, table: Table) -> None:
    """Rows of a message that is a table; one without a time of its own gets the time at which it was recorded.

    Args:
        add: takes the name of an exported table, and columns.
        topic: relative to the namespace.
        log_time: s.
        table: the message.
    """
    columns: dict[str, Column] = {}
    name = file_name(topic)
    for places, kind, label in (
        (_MESHES, "indicators", "mesh"),
        (_BEARINGS, "bearing_indicators", "bearing"),
        (_STAGES, "section", "stage"),
    ):
        if topic in places:
            name = kind
            columns[label] = [places[topic]] * len(table)
    if "time" not in table.columns:
        columns["log_time"] = np.full(len(table), log_time)
    columns |= {column: np.ascontiguousarray(table.data[:, i]) for i, column in enumerate(table.columns)}
    add(name, columns)


def add_rows(add: Add, topic: str, kind: str, rows: Rows) -> None:
    """Rows of stamped messages: one per joint and time, one per force or vector and time."""
    if kind == JOINTS:
        name, label, parts = _OF_JOINTS.get(topic, (file_name(topic), "name", ("position", "velocity", "effort")))
        count = len(rows.names)
        columns: dict[str, Column] = {"time": np.repeat(rows.time, count), label: list(rows.names) * len(rows.time)}
        columns |= {part: np.ascontiguousarray(rows.values[:, i]).ravel() for i, part in enumerate(parts)}
    elif kind == WRENCH:
        name, columns = "bearings", {"time": rows.time, "bearing": [_FORCES.get(topic, topic)] * len(rows.time)}
        columns |= _parts(("fx", "fy", "fz"), rows.values[:, 0]) | _parts(("mx", "my", "mz"), rows.values[:, 1])
    elif topic == names.WIND_SPEED:
        name, columns = topic, {"time": rows.time, "speed": np.ascontiguousarray(rows.values[:, 0, 0])}
    else:
        name, columns = file_name(topic), {"time": rows.time, **_parts(("x", "y", "z"), rows.values[:, 0])}
    add(name, columns)


def _parts(labels: tuple[str, ...], values: Array) -> dict[str, Column]:
    return {label: np.ascontiguousarray(values[:, i]) for i, label in enumerate(labels)}


def add_diagnostics(add: Add, message: Any) -> None:
    """Rows of a DiagnosticArray: what every status said, and its values, which are texts."""
    stamp = message.header.stamp
    time = float(stamp.sec) + 1e-9 * float(stamp.nanosec)
    statuses = message.status
    if not statuses:
        return
    levels = [s.level[0] if isinstance(s.level, bytes) else int(s.level) for s in statuses]
    said: dict[str, Column] = {
        "time": np.full(len(statuses), time),
        "name": [s.name for s in statuses],
        "level": np.array(levels, dtype=np.int64),
        "message": [s.message for s in statuses],
        "hardware_id": [s.hardware_id for s in statuses],
    }
    add("diagnostics", said)
    pairs = [(s.name, pair.key, pair.value) for s in statuses for pair in s.values]
    if pairs:
        statuses_of, keys, values = (list(part) for part in zip(*pairs, strict=True))
        add("diagnostic_values", {"time": np.full(len(pairs), time), "name": statuses_of, "key": keys, "value": values})


def add_truth(add: Add, log_time: float, message: Any) -> None:
    """Rows of the simulator's truth, whose values are texts."""
    keys, values = [pair.key for pair in message.values], [pair.value for pair in message.values]
    if keys:
        add("truth", {"log_time": np.full(len(keys), log_time), "key": keys, "value": values})
