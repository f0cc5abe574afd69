"""FM0: how far the peaks of a gear's mean turn stand above its mesh lines."""

from __future__ import annotations

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals.average import mesh_amplitudes

HARMONICS = 5
LEAST_MESH = 1e-9
"""Mesh lines weaker than this share of the peak-to-peak value are rounding."""


def fm0(average: Array, teeth: int, harmonics: int = HARMONICS) -> float:
    """Peak-to-peak value of the average over the sum of its mesh amplitudes.

    FM0 = (max a - min a) / sum_k A_k, k = 1..harmonics, with A_k the amplitude (not rms) of the k-th mesh harmonic: 2
    for a single mesh line. Source: Stewart, "Some useful data analysis techniques for gearbox diagnostics", Machine
    Health Monitoring Group, ISVR, University of Southampton, MHM/R/10/77 (1977), from memory. Broken teeth raise it;
    wear of all teeth alike, which raises the mesh lines too, doesn't.

    Args:
        average: (per_turn,) time-synchronous average of the gear's shaft, any unit.
        teeth: of the gear.
        harmonics: mesh harmonics that are summed.

    Raises:
        InputError: an average that can't be used, too coarse for the harmonics, or without mesh lines.
    """
    mesh = float(np.sum(mesh_amplitudes(average, teeth, harmonics)))
    height = float(np.ptp(average))
    if mesh <= LEAST_MESH * height:
        raise InputError("average", f"a line at {teeth} orders or its multiples", f"{mesh:.3g} of {height:.3g}")
    return height / mesh
