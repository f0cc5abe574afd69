"""The line fit's numbers for one mesh: residual ratio rho, tonal share tau and 0-1 test K of the residual."""

from __future__ import annotations

from nw_gear_monitor.indicators.window import Column, Indicator, MeshWindow


def _compute(window: MeshWindow) -> tuple[float, ...]:
    lines = window.lines
    return (lines.rho, lines.tau, lines.k) if lines is not None else (float("nan"),) * 3


INDICATOR = Indicator(
    (
        Column("residual_ratio", "", "variance outside the known lines over all (rho)"),
        Column("tonal_share", "", "share of that residual in unlisted sharp lines (tau)"),
        Column("zero_one_k", "", "0-1 test for chaos on the strobed residual (K); only where rho is not small"),
    ),
    _compute,
)
