"""Amplitudes at fractions of the mesh frequency: they appear with period doubling, tripling and quadrupling."""

from __future__ import annotations

from nw_gear_monitor.indicators.mesh_harmonics import line_amplitudes
from nw_gear_monitor.indicators.window import Column, Indicator, MeshWindow

DIVISORS = (2, 3, 4)


def _compute(window: MeshWindow) -> tuple[float, ...]:
    return line_amplitudes(window.phase, window.x, [1.0 / n for n in DIVISORS])


INDICATOR = Indicator(
    tuple(Column(f"subharmonic_{n}", "m", f"amplitude at mesh frequency / {n}") for n in DIVISORS), _compute
)
