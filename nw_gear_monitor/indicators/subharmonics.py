"""Amplitudes at fractions of the mesh frequency: they appear with period doubling, tripling and quadrupling."""

from __future__ import annotations

from nw_gear_monitor.indicators.mesh_harmonics import DIVISORS, mesh_lines
from nw_gear_monitor.indicators.window import Column, Indicator, MeshWindow


def _compute(window: MeshWindow) -> tuple[float, ...]:
    return window.once(mesh_lines)[: len(DIVISORS)]


INDICATOR = Indicator(
    tuple(Column(f"subharmonic_{n}", "m", f"amplitude at mesh frequency / {n}") for n in DIVISORS), _compute
)
