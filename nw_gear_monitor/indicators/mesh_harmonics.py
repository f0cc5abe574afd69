"""Amplitudes at whole multiples of the mesh frequency, measured over mesh phase."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.window import Column, Indicator, MeshWindow
from nw_gear_monitor.signals.linesums import line_sums, power_sums
from nw_gear_monitor.signals.spectrum import hann

HARMONICS = (1, 2, 3, 4, 5)
DIVISORS = (2, 3, 4)
"""Of the mesh frequency: subharmonics."""
PARTS = 12
POWERS = np.array([*sorted(PARTS // n for n in DIVISORS), *(PARTS * k for k in HARMONICS)], dtype=np.int64)
"""All these lines, in twelfths of the mesh frequency."""
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
    weighted, scale, turned = _weighted(phase, x)
    sums = np.abs(line_sums(phase, weighted, np.array(orders, dtype=np.float64)))
    return tuple(
        float(scale * s) if q * turned >= LEAST_CYCLES else float("nan") for q, s in zip(orders, sums, strict=True)
    )


def line_amplitude(phase: Array, x: Array, order: float) -> float:
    """The same of one line, without a condition: the caller sees to it that the window holds enough of its cycles."""
    weighted, scale, _ = _weighted(phase, x)
    return float(scale * np.abs(line_sums(phase, weighted, np.array([order]))[0]))


def mesh_lines(phase: Array, x: Array) -> tuple[float, ...]:
    """`line_amplitudes` at 1 / DIVISORS, then at HARMONICS, by powers of exp(-i phi / PARTS)."""
    weighted, scale, turned = _weighted(phase, x)
    sums = scale * np.abs(power_sums(phase, weighted, PARTS, POWERS))
    found = [
        float(s) if p * turned >= PARTS * LEAST_CYCLES else float("nan") for p, s in zip(POWERS, sums, strict=True)
    ]
    return (*found[len(DIVISORS) - 1 :: -1], *found[len(DIVISORS) :])


def harmonic_amplitudes(phase: Array, x: Array) -> tuple[float, ...]:
    """`line_amplitudes` at HARMONICS."""
    return mesh_lines(phase, x)[len(DIVISORS) :]


def _weighted(phase: Array, x: Array) -> tuple[Array, float, float]:
    """The signal without its mean under a Hann window, two over the window's sum, and the cycles that it holds."""
    window = hann(x.size)
    turned = abs(float(phase[-1] - phase[0])) / (2.0 * np.pi)
    return window * (x - np.mean(x)), 2.0 / float(window.sum()), turned


def _compute(window: MeshWindow) -> tuple[float, ...]:
    return window.once(mesh_lines)[len(DIVISORS) :]


INDICATOR = Indicator(
    tuple(Column(f"harmonic_{k}", "m", f"amplitude at {k} x mesh frequency") for k in HARMONICS), _compute
)
