"""The compiled loop: steps of RK4 with varying speed and torque, one sample of observations every few steps."""

from __future__ import annotations

import math

import numba
import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.dynamics.rk4 import combine, trial
from nw_gear_sim.dynamics.constants import Constants
from nw_gear_sim.dynamics.model import FORCE, MESHES, OBSERVED, X, accelerations

FINISHED = -1


@numba.njit(cache=True, nogil=True, error_model="numpy")  # without fastmath, under which isfinite is always true
def run(
    c: Constants,
    tables: Array,
    q: Array,
    rate: Array,
    drive: Array,
    step: float,
    per_sample: int,
    samples: Array,
    angles: Array,
    contact: Array,
) -> int:
    """Integrate len(samples) * per_sample steps in place.

    Args:
        c, tables: constants and friction tables.
        q, rate: state, changed in place.
        drive: ring angle (rad), speed (rad/s), acceleration (rad/s^2), torque (N m), its rate (N m/s) at the start.
        step: s.
        per_sample: steps between samples.
        samples: (n, OBSERVED), filled with the observations at the start of every sample interval.
        angles: (n,) ring angle there.
        contact: (2, MESHES), incremented for every step in which a mesh is open, or on its back flank.

    Returns:
        FINISHED, or the index of the first sample with a number that isn't finite (the state is then lost).
    """
    n = len(q)
    work = np.empty(8 * (c.ring[0].segments + 1))
    unseen = np.empty(OBSERVED)
    v2, v3, v4, place = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    a1, a2, a3, a4 = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    half = 0.5 * step
    for k in range(len(samples)):
        for j in range(per_sample):
            now = (k * per_sample + j) * step
            mid, end = now + half, now + step
            seen = samples[k] if j == 0 else unseen
            angle0 = drive[0] + now * (drive[1] + 0.5 * drive[2] * now)
            angle1 = drive[0] + mid * (drive[1] + 0.5 * drive[2] * mid)
            angle2 = drive[0] + end * (drive[1] + 0.5 * drive[2] * end)
            speed1, torque1 = drive[1] + drive[2] * mid, drive[3] + drive[4] * mid
            accelerations(c, tables, q, rate, angle0, drive[1] + drive[2] * now, drive[3] + drive[4] * now, work, seen, a1)
            if j == 0:
                angles[k] = angle0
            for i in range(MESHES):
                contact[0, i] += abs(seen[X + i]) <= c.mesh[i].half_backlash
                contact[1, i] += seen[X + i] < -c.mesh[i].half_backlash
            trial(q, rate, rate, a1, half, place, v2)
            accelerations(c, tables, place, v2, angle1, speed1, torque1, work, unseen, a2)
            trial(q, rate, v2, a2, half, place, v3)
            accelerations(c, tables, place, v3, angle1, speed1, torque1, work, unseen, a3)
            trial(q, rate, v3, a3, step, place, v4)
            speed2, torque2 = drive[1] + drive[2] * end, drive[3] + drive[4] * end
            accelerations(c, tables, place, v4, angle2, speed2, torque2, work, unseen, a4)
            combine(q, rate, v2, v3, v4, step)
            combine(rate, a1, a2, a3, a4, step)
        total = 0.0
        for i in range(FORCE + MESHES):
            total += samples[k, i]
        if not math.isfinite(total):
            return k
    return FINISHED
