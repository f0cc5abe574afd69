"""Slow change of a motion that is periodic otherwise: polynomials of time through every k-th cycle."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array

DEGREE = 3
LEAST_SHARE = 0.03
"""Of the rest's variance, below which a trend isn't taken out."""


def trend(rest: Array, period: int) -> Array:
    """The part of cycles that changes slowly, zero where it is no more than noise has.

    Through the cycles k mod period polynomials of degree DEGREE without constant are laid; they swing at most once
    and a half in the window, so that a torus, whose slowest beat turns, isn't followed.

    Args:
        rest: (cycles, points) less the waveform of `period` cycles.
        period: recurrence period in cycles.
    """
    size = len(rest)
    time = np.linspace(-1.0, 1.0, size)
    out = np.zeros_like(rest)
    for group in range(period):
        basis = np.polynomial.legendre.legvander(time[group::period], DEGREE)
        out[group::period] = basis @ np.linalg.lstsq(basis, rest[group::period], rcond=None)[0]
    total = float(np.sum(rest**2))
    by_chance = (DEGREE + 1) * period / size
    share = (float(np.sum(out**2)) / total - by_chance) / (1.0 - by_chance) if total > 0.0 else 0.0
    return out if share > LEAST_SHARE else np.zeros_like(rest)
