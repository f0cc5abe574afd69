"""A finished bifurcation study as rows and columns: one row for every point, sweep and mesh."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.batch.lanes import LANES
from nw_gear_sim.studies.bifurcation import label
from nw_gear_sim.studies.store import Store


@dataclass(frozen=True, eq=False)
class Row:
    """What was found at one point in one mesh.

    Attributes:
        values: of the axes; sweep: `up`, `down`, or "" for a point of its own; mesh: its name.
        state: label; period: 0 for none; settled: whether both halves of the record agree.
        rate, error: largest exponent of the whole gearbox and its standard error, 1/s, NaN where not asked for.
        deviation: standard deviation of the displacement, m; open, back: shares of the time.
        x, v: (n,) Poincare section, m and m/s.
    """

    values: tuple[float, ...]
    sweep: str
    mesh: str
    state: str
    period: int
    settled: bool
    rate: float
    error: float
    deviation: float
    open: float
    back: float
    x: Array
    v: Array

    def as_object(self, axes: Sequence[str]) -> dict[str, Any]:
        """Return everything but the section, for JSON; None for what isn't there."""
        numbers = {"rate": self.rate, "error": self.error, "deviation": self.deviation}
        return {
            **dict(zip(axes, self.values, strict=True)),
            "sweep": self.sweep,
            "mesh": self.mesh,
            "state": self.state,
            "period": self.period or None,
            "settled": self.settled,
            **{name: value if np.isfinite(value) else None for name, value in numbers.items()},
            "open": self.open,
            "back": self.back,
        }


def rows(store: Store, points: Sequence[tuple[float, ...]], carries: bool) -> list[Row]:
    """Return the rows of all finished pieces.

    Args:
        store: of the study; points: values of its axes, in the order of its points; carries: whether it is a sweep.
    """
    found: list[Row] = []
    for key in sorted(store.done()):
        number = int(key.split("-")[1])
        arrays = store.get(key)
        if carries:
            places = [("up", number), ("down", len(points) - 1 - number)]
        else:
            places = [("", number + k) for k in range(min(LANES, len(points) - number))]
        for k, (sweep, point) in enumerate(places):
            found += _of_point(arrays, k, points[point], sweep)
    return found


def points_table(found: Sequence[Row], axes: Sequence[str]) -> dict[str, list[Any]]:
    """Return name -> values of everything but the sections, one row for every point, sweep and mesh."""
    objects = [row.as_object(axes) for row in found]
    return {name: [o[name] for o in objects] for name in (objects[0] if objects else axes)}


def sections_table(found: Sequence[Row], axes: Sequence[str]) -> dict[str, Any]:
    """Return name -> values of the sections, one row for every Poincare point: x in m, v in m/s."""
    lengths = [len(row.x) for row in found]
    table: dict[str, Any] = {name: np.repeat([row.values[k] for row in found], lengths) for k, name in enumerate(axes)}
    table["sweep"] = [row.sweep for row in found for _ in row.x]
    table["mesh"] = [row.mesh for row in found for _ in row.x]
    table["number"] = np.concatenate([np.arange(n) for n in lengths]) if lengths else []
    table["x_m"] = np.concatenate([row.x for row in found]) if lengths else []
    table["v_m_per_s"] = np.concatenate([row.v for row in found]) if lengths else []
    return table


def _of_point(arrays: dict[str, Array], k: int, values: tuple[float, ...], sweep: str) -> Iterator[Row]:
    rate, error, diverged = (float(arrays[name][k]) for name in ("rate", "error", "diverged"))
    for m, mesh in enumerate(names.MESHES):
        x, v = arrays["x"][k, m], arrays["v"][k, m]
        there = np.isfinite(x)
        period = int(arrays["period"][k, m])
        state = label(period, rate, error, diverged)
        yield Row(
            values=values,
            sweep=sweep,
            mesh=mesh,
            state=state,
            period=period if state in names.PERIODS else 0,
            settled=bool(arrays["settled"][k, m]),
            rate=rate,
            error=error,
            deviation=float(arrays["deviation"][k, m]),
            open=float(arrays["open"][k, m]),
            back=float(arrays["back"][k, m]),
            x=x[there],
            v=v[there],
        )
