"""Units of the columns of every exported table, by the column's name."""

from __future__ import annotations

from nw_gear_common import names
from nw_gear_monitor.indicators import bearing_registry, registry

FIXED = {
    "time": "s",
    "log_time": "s",
    "frequency": "Hz",
    "order": "1",
    "speed": "m/s",
    "angle": "rad",
    "angular_velocity": "rad/s",
    "torque": "N m",
    "displacement": "m",
    "velocity": "m/s",
    "force": "N",
    "fx": "N",
    "fy": "N",
    "fz": "N",
    "mx": "N m",
    "my": "N m",
    "mz": "N m",
}
OF_TABLE = {
    "section": {"x": "m", "v": "m/s", "planet": ""},
    names.SPECTRUM: dict.fromkeys(names.MESHES, "m"),
    names.ORDERS: dict.fromkeys(names.MESHES, "m"),
}
PREFIXES = {"phase_": "rad", "x_": "m", "v_": "m/s", "fx_": "N", "fy_": "N", "ax_": "m/s^2", "ay_": "m/s^2"}
_INDICATORS = {
    "indicators": {c.name: c.unit for c in registry.COLUMNS},
    "bearing_indicators": {c.name: c.unit for c in bearing_registry.COLUMNS},
}


def unit(table: str, column: str) -> str:
    """Unit of a column, empty for texts, counts and what isn't known.

    Args:
        table: name of the exported table.
        column: its column.
    """
    if column in _INDICATORS.get(table, {}):
        return _INDICATORS[table][column]
    if column in OF_TABLE.get(table, {}):
        return OF_TABLE[table][column]
    if column in FIXED:
        return FIXED[column]
    return next((found for prefix, found in PREFIXES.items() if column.startswith(prefix)), "")
