"""The ring of many points at once, in pairs of modes in the frame of the meshes (see `pairs`)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import fused

Indices = npt.NDArray[np.int64]


class RingLaw(NamedTuple):
    """Constants of the pairs, those of class 0 first; arrays of shape (pairs, lanes) if not said otherwise.

    Attributes:
        straight: number of pairs of class 0.
        harmonic: row of each pair in turn_cos and turn_sin, (pairs,).
        turn_cos, turn_sin: rotation of a harmonic in one step, (harmonics, lanes).
        square, decay, gain: omega^2 and the factors of d' = decay d + gain (f - omega^2 z).
        normal, slide: rows, real and imaginary part, (pairs, 2, lanes); roll: imaginary row.
        load: constant modal forces, real and imaginary part, (pairs, 2, lanes).
    """

    straight: int
    harmonic: Indices
    turn_cos: Array
    turn_sin: Array
    square: Array
    decay: Array
    gain: Array
    normal: Array
    slide: Array
    roll: Array
    load: Array


@fused
def share_out(pushed: Array, slid: Array, rolled: Array, out: Array) -> None:
    """Sum the forces of the planets (7, lanes) by class: (9, lanes), for each force class 0, then 1 (real, imaginary)."""
    cos, sin = math.cos(2.0 * math.pi / 3.0), math.sin(2.0 * math.pi / 3.0)
    for part in range(3):
        force = pushed if part == 0 else (slid if part == 1 else rolled)
        row = 3 * part
        for lane in range(out.shape[1]):
            a, b, c = force[0, lane], force[1, lane], force[2, lane]
            out[row, lane] = a + b + c
            out[row + 1, lane] = a + cos * (b + c)
            out[row + 2, lane] = sin * (b - c)


@fused
def step_ring(law: RingLaw, shares: Array, z: Array, moved: Array, sums: Array) -> None:
    """Move all pairs by one step and turn them with the ring.

    Args:
        law: constants.
        shares: of `share_out`.
        z, moved: Z and its displacement in the last step, (pairs, 2, lanes), changed in place.
        sums: what the contacts need of the new Z, (3, lanes); see `meshes.elongate`.
    """
    lanes = z.shape[2]
    for lane in range(lanes):
        sums[0, lane], sums[1, lane], sums[2, lane] = 0.0, 0.0, 0.0
    for p in range(law.straight):
        n = law.harmonic[p]
        for lane in range(lanes):
            pushed, slid, rolled = shares[0, lane], shares[3, lane], shares[6, lane]
            nr, ni = law.normal[p, 0, lane], law.normal[p, 1, lane]
            zr, zi = z[p, 0, lane], z[p, 1, lane]
            fr = law.load[p, 0, lane] - nr * pushed + law.slide[p, 0, lane] * slid
            fi = law.load[p, 1, lane] - ni * pushed + law.slide[p, 1, lane] * slid + law.roll[p, lane] * rolled
            square, decay, gain = law.square[p, lane], law.decay[p, lane], law.gain[p, lane]
            dr = decay * moved[p, 0, lane] + gain * (fr - square * zr)
            di = decay * moved[p, 1, lane] + gain * (fi - square * zi)
            zr += dr
            zi += di
            cos, sin = law.turn_cos[n, lane], law.turn_sin[n, lane]
            moved[p, 0, lane] = cos * dr - sin * di
            moved[p, 1, lane] = cos * di + sin * dr
            turned = cos * zr - sin * zi
            zi = cos * zi + sin * zr
            z[p, 0, lane] = turned
            z[p, 1, lane] = zi
            sums[0, lane] += nr * turned + ni * zi
    for p in range(law.straight, len(law.square)):
        n = law.harmonic[p]
        for lane in range(lanes):
            pushed, pushed_i = shares[1, lane], shares[2, lane]
            slid, slid_i = shares[4, lane], shares[5, lane]
            nr, ni = law.normal[p, 0, lane], law.normal[p, 1, lane]
            sr, si, roll = law.slide[p, 0, lane], law.slide[p, 1, lane], law.roll[p, lane]
            zr, zi = z[p, 0, lane], z[p, 1, lane]
            fr = law.load[p, 0, lane] - nr * pushed + ni * pushed_i + sr * slid - si * slid_i - roll * shares[8, lane]
            fi = law.load[p, 1, lane] - nr * pushed_i - ni * pushed + sr * slid_i + si * slid + roll * shares[7, lane]
            square, decay, gain = law.square[p, lane], law.decay[p, lane], law.gain[p, lane]
            dr = decay * moved[p, 0, lane] + gain * (fr - square * zr)
            di = decay * moved[p, 1, lane] + gain * (fi - square * zi)
            zr += dr
            zi += di
            cos, sin = law.turn_cos[n, lane], law.turn_sin[n, lane]
            moved[p, 0, lane] = cos * dr - sin * di
            moved[p, 1, lane] = cos * di + sin * dr
            turned = cos * zr - sin * zi
            zi = cos * zi + sin * zr
            z[p, 0, lane] = turned
            z[p, 1, lane] = zi
            sums[1, lane] += nr * turned + ni * zi
            sums[2, lane] += ni * turned - nr * zi


@fused
def contact_sums(law: RingLaw, z: Array, sums: Array) -> None:
    """Set the sums that `step_ring` leaves, for a Z of its own."""
    for lane in range(z.shape[2]):
        sums[0, lane], sums[1, lane], sums[2, lane] = 0.0, 0.0, 0.0
        for p in range(len(law.square)):
            nr, ni = law.normal[p, 0, lane], law.normal[p, 1, lane]
            zr, zi = z[p, 0, lane], z[p, 1, lane]
            if p < law.straight:
                sums[0, lane] += nr * zr + ni * zi
            else:
                sums[1, lane] += nr * zr + ni * zi
                sums[2, lane] += ni * zr - nr * zi
