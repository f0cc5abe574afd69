"""Gears and bearings of many points at once: springs along the shafts, and the step of every motion.

Motions are those of `layout` from the ring's on, and one more that stays at rest, which fills gaps in the tables below.
The springs are those of `physics.spring`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import fused

Indices = npt.NDArray[np.int64]


class WheelLaw(NamedTuple):
    """Constants, with points in the last axis.

    Attributes:
        chain: rows of the motions of four neighbours on a shaft, (chains, 4).
        spring: between them, N/m, (chains, 3, lanes).
        twist: rows of both ends of the torsion springs, (torsions, 2); the last end of the last one is at rest.
        aa, ab, bb: of the torsion springs, as in `physics.spring`, (torsions, lanes).
        lag, twist_lag: damping time over 2 h of the springs, (lanes,) and (torsions, lanes).
        load: constant forces, N, (motions, lanes).
        decay, gain: of d' = decay d + gain F for displacements d of one step, (motions, lanes).
    """

    chain: Indices
    spring: Array
    twist: Indices
    aa: Array
    ab: Array
    bb: Array
    lag: Array
    twist_lag: Array
    load: Array
    decay: Array
    gain: Array


@fused
def set_spring_forces(law: WheelLaw, x: Array, moved: Array, before: Array, force: Array) -> None:
    """Set the forces of springs and constant loads on all motions.

    The rate of a displacement is extrapolated from its last two steps, (3 d - d') / (2 h).

    Args:
        law: constants.
        x: displacements, m; moved, before: in the last step and in the one before, m, (motions, lanes).
        force: N, set here.
    """
    lanes = x.shape[1]
    for c in range(len(law.chain)):
        i, j, k, m = law.chain[c]
        for lane in range(lanes):
            lag = law.lag[lane]
            first = x[i, lane] + lag * (3.0 * moved[i, lane] - before[i, lane])
            second = x[j, lane] + lag * (3.0 * moved[j, lane] - before[j, lane])
            third = x[k, lane] + lag * (3.0 * moved[k, lane] - before[k, lane])
            fourth = x[m, lane] + lag * (3.0 * moved[m, lane] - before[m, lane])
            a = law.spring[c, 0, lane] * (first - second)
            b = law.spring[c, 1, lane] * (second - third)
            d = law.spring[c, 2, lane] * (third - fourth)
            force[i, lane] = law.load[i, lane] - a
            force[j, lane] = law.load[j, lane] + a - b
            force[k, lane] = law.load[k, lane] + b - d
            force[m, lane] = law.load[m, lane] + d
    for t in range(len(law.twist)):
        i, j = law.twist[t]
        for lane in range(lanes):
            lag = law.twist_lag[t, lane]
            first = x[i, lane] + lag * (3.0 * moved[i, lane] - before[i, lane])
            second = x[j, lane] + lag * (3.0 * moved[j, lane] - before[j, lane])
            force[i, lane] = law.load[i, lane] - law.aa[t, lane] * first + law.ab[t, lane] * second
            force[j, lane] = law.load[j, lane] + law.ab[t, lane] * first - law.bb[t, lane] * second


@fused
def step_wheels(law: WheelLaw, force: Array, x: Array, moved: Array, before: Array) -> None:
    """Move all motions by one step, in place; arrays of shape (motions, lanes)."""
    size = x.size
    f, place, now, last = force.reshape(size), x.reshape(size), moved.reshape(size), before.reshape(size)
    decay, gain = law.decay.reshape(size), law.gain.reshape(size)
    for i in range(size):
        d = now[i]
        last[i] = d
        d = decay[i] * d + gain[i] * f[i]
        now[i] = d
        place[i] += d
