"""Linear springs between two motions, with damping in proportion to their stiffness (paper Eqs 39-62)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import kernel

Indices = npt.NDArray[np.int64]


class Spring(NamedTuple):
    """One spring: elongation d = a q_first - b q_second, force k (d + beta d').

    Attributes:
        first, second: entries of q; a, b: factors (1 for translations, 1 / base radius for torsion springs).
        stiffness: k, N/m or N m/rad; damping_time: beta, s.
    """

    first: int
    second: int
    a: float
    b: float
    stiffness: float
    damping_time: float


class SpringLaw(NamedTuple):
    """All springs as arrays of shape (springs,), multiplied out: force on the first is -(aa q_1 - ab q_2 + ...)."""

    first: Indices
    second: Indices
    aa: Array
    ab: Array
    bb: Array
    damping_time: Array


def spring_law(springs: Sequence[Spring]) -> SpringLaw:
    """Turn springs into the arrays that the kernel works on."""

    def column(values: Sequence[float]) -> Array:
        return np.array(values, dtype=np.float64)

    return SpringLaw(
        first=np.array([s.first for s in springs], dtype=np.int64),
        second=np.array([s.second for s in springs], dtype=np.int64),
        aa=column([s.stiffness * s.a * s.a for s in springs]),
        ab=column([s.stiffness * s.a * s.b for s in springs]),
        bb=column([s.stiffness * s.b * s.b for s in springs]),
        damping_time=column([s.damping_time for s in springs]),
    )


@kernel
def add_springs(law: SpringLaw, q: Array, v: Array, force: Array) -> None:
    """Add the forces of all springs to `force`, displacements q (m) and velocities v (m/s), all of shape (dof,)."""
    first, second, aa, ab, bb, beta = law
    for k in range(len(first)):
        i, j = np.uint64(first[k]), np.uint64(second[k])  # unsigned: no check for negative indices
        qi = q[i] + beta[k] * v[i]
        qj = q[j] + beta[k] * v[j]
        force[i] -= aa[k] * qi - ab[k] * qj
        force[j] += ab[k] * qi - bb[k] * qj
