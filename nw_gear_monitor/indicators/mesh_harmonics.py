"""Amplitudes at whole multiples of the mesh frequency, measured over mesh phase."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.window import Column, Indicator, MeshWindow
from nw_gear_monitor.signals.spectrum import hann

HARMONICS = (1, 2, 3, 4, 5)
LEAST_CYCLES = 8.0
"""Cycles of the slowest line that the window must hold, so that neighbours don't leak in."""


def line_amplitudes(phase: Array, x: Array, orders: Sequence[float]) -> tuple[float, ...]:
    """Amplitudes |2 sum w x exp(-i q phi)| / sum w of lines at given orders.

    Following the phase keeps a line sharp while the speed changes. The Hann window w keeps lines two or more over the
    window's length away from leaking in.

    Args:
        phase: (samples,) unwrapped mesh phase, rad.
        x: (samples,) any unit.
        orders: multiples q of the mesh frequency.

    Returns:
        one amplitude per order, in the unit of x; NaN where the window holds fewer than LEAST_CYCLES of its cycles.
    """
    window = hann(x.size)
    weighted = window * (x - np.mean(x))
    turned = abs(float(phase[-1] - phase[0])) / (2.0 * np.pi)
    scale = 2.0 / float(window.sum())
    sums = [abs(complex(np.dot(weighted, np.exp(-1j * q * phase)))) for q in orders]
    return tuple(scale * s if q * turned >= LEAST_CYCLES else float("nan") for q, s in zip(orders, sums, strict=True))


def harmonic_amplitudes(phase: Array, x: Array) -> tuple[float, ...]:
    """`line_amplitudes` at HARMONICS, by powers of exp(-i phi)."""
    window = hann(x.size)
    turning = np.exp(-1j * phase)
    term = window * (x - np.mean(x))
    enough = abs(float(phase[-1] - phase[0])) >= 2.0 * np.pi * LEAST_CYCLES
    amplitudes = []
    for _ in HARMONICS:
        term = term * turning
        amplitudes.append(2.0 * abs(complex(np.sum(term))) / float(window.sum()) if enough else float("nan"))
    return tuple(amplitudes)


def _compute(window: MeshWindow) -> tuple[float, ...]:
    return window.once(harmonic_amplitudes)


INDICATOR = Indicator(
    tuple(Column(f"harmonic_{k}", "m", f"amplitude at {k} x mesh frequency") for k in HARMONICS), _compute
)
