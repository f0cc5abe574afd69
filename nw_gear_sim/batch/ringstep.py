"""The ring of many points at once, in pairs of modes in the frame of the meshes (see `pairs`)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.batch.lanes import LANES, exact, of
from nw_gear_sim.compiled import apart

Indices = npt.NDArray[np.int64]

_COS, _SIN = math.cos(2.0 * math.pi / 3.0), math.sin(2.0 * math.pi / 3.0)


class RingLaw(NamedTuple):
    """Constants of the pairs, those of class 0 first; tables (pairs) read by `lanes.of`.

    Attributes:
        straight: number of pairs of class 0.
        harmonic: entry of each pair in turn, (pairs,).
        turn: cosine and sine of a harmonic's rotation in one step, flat (harmonics, 2, lanes).
        square, decay, gain: omega^2 and the factors of d' = decay d + gain (f - omega^2 z).
        normal_re, normal_im, slide_re, slide_im, roll: rows of the contact; roll is imaginary.
        loaded: pairs with constant forces; kick: gain / decay times these, flat (loaded, 2, lanes).
    """

    straight: int
    harmonic: Indices
    turn: Array
    square: Array
    decay: Array
    gain: Array
    normal_re: Array
    normal_im: Array
    slide_re: Array
    slide_im: Array
    roll: Array
    loaded: Indices
    kick: Array


@apart
def share_out(pushed: Array, slid: Array, rolled: Array, out: Array) -> None:
    """Sum the forces of the planets, flat (7, lanes), by class: flat (9, lanes), for each class 0, then 1 (re, im)."""
    for lane in range(LANES):
        a, b, c = pushed[lane], pushed[LANES + lane], pushed[2 * LANES + lane]
        out[lane] = a + b + c
        out[LANES + lane] = a + _COS * (b + c)
        out[2 * LANES + lane] = _SIN * (b - c)
        a, b, c = slid[lane], slid[LANES + lane], slid[2 * LANES + lane]
        out[3 * LANES + lane] = a + b + c
        out[4 * LANES + lane] = a + _COS * (b + c)
        out[5 * LANES + lane] = _SIN * (b - c)
        a, b, c = rolled[lane], rolled[LANES + lane], rolled[2 * LANES + lane]
        out[6 * LANES + lane] = a + b + c
        out[7 * LANES + lane] = a + _COS * (b + c)
        out[8 * LANES + lane] = _SIN * (b - c)


@apart
def step_ring(law: RingLaw, shares: Array, z: Array, sums: Array) -> None:
    """Move all pairs by one step and turn them with the ring.

    Args:
        law: constants.
        shares: of `share_out`.
        z: Z and its displacement in the last step (re, im, re, im), flat (pairs, 4, lanes), changed in place.
        sums: what the contacts need of the new Z, flat (3, lanes): class 0, and real and imaginary part of class 1.
    """
    for i in range(3 * LANES):
        sums[i] = 0.0
    _kick(law, z)
    for p in range(law.straight):
        at, first = p * 4 * LANES, law.harmonic[p] * 2 * LANES
        turn, here = law.turn[first : first + 2 * LANES], z[at : at + 4 * LANES]
        for lane in range(LANES):
            nr, ni = of(law.normal_re, p, lane), of(law.normal_im, p, lane)
            pushed, slid = shares[lane], shares[3 * LANES + lane]
            fr = exact(of(law.slide_re, p, lane), slid) - nr * pushed
            fi = exact(of(law.slide_im, p, lane), slid) - ni * pushed + of(law.roll, p, lane) * shares[6 * LANES + lane]
            zr, zi, dr, di = here[lane], here[LANES + lane], here[2 * LANES + lane], here[3 * LANES + lane]
            square, decay, gain = of(law.square, p, lane), of(law.decay, p, lane), of(law.gain, p, lane)
            dr = exact(decay, dr) + gain * (fr - square * zr)
            di = exact(decay, di) + gain * (fi - square * zi)
            zr += dr
            zi += di
            cos, sin = turn[lane], turn[LANES + lane]
            turned, turned_i = exact(cos, zr) - sin * zi, exact(cos, zi) + sin * zr
            here[lane], here[LANES + lane] = turned, turned_i
            here[2 * LANES + lane], here[3 * LANES + lane] = exact(cos, dr) - sin * di, exact(cos, di) + sin * dr
            sums[lane] = sums[lane] + nr * turned + ni * turned_i
    for p in range(law.straight, len(law.harmonic)):
        at, first = p * 4 * LANES, law.harmonic[p] * 2 * LANES
        turn, here = law.turn[first : first + 2 * LANES], z[at : at + 4 * LANES]
        for lane in range(LANES):
            nr, ni = of(law.normal_re, p, lane), of(law.normal_im, p, lane)
            sr, si, roll = of(law.slide_re, p, lane), of(law.slide_im, p, lane), of(law.roll, p, lane)
            pushed, pushed_i = shares[LANES + lane], shares[2 * LANES + lane]
            slid, slid_i = shares[4 * LANES + lane], shares[5 * LANES + lane]
            fr = exact(ni, pushed_i) - nr * pushed + sr * slid - si * slid_i - roll * shares[8 * LANES + lane]
            fi = exact(sr, slid_i) + si * slid - nr * pushed_i - ni * pushed + roll * shares[7 * LANES + lane]
            zr, zi, dr, di = here[lane], here[LANES + lane], here[2 * LANES + lane], here[3 * LANES + lane]
            square, decay, gain = of(law.square, p, lane), of(law.decay, p, lane), of(law.gain, p, lane)
            dr = exact(decay, dr) + gain * (fr - square * zr)
            di = exact(decay, di) + gain * (fi - square * zi)
            zr += dr
            zi += di
            cos, sin = turn[lane], turn[LANES + lane]
            turned, turned_i = exact(cos, zr) - sin * zi, exact(cos, zi) + sin * zr
            here[lane], here[LANES + lane] = turned, turned_i
            here[2 * LANES + lane], here[3 * LANES + lane] = exact(cos, dr) - sin * di, exact(cos, di) + sin * dr
            sums[LANES + lane] = sums[LANES + lane] + nr * turned + ni * turned_i
            sums[2 * LANES + lane] = sums[2 * LANES + lane] + ni * turned - nr * turned_i


@apart
def _kick(law: RingLaw, z: Array) -> None:
    """Add the constant forces to the displacements of the last step."""
    for k in range(len(law.loaded)):
        at = (law.loaded[k] * 4 + 2) * LANES
        moved = z[at : at + 2 * LANES]
        for i in range(2 * LANES):
            moved[i] += law.kick[2 * k * LANES + i]


@apart
def contact_sums(law: RingLaw, zr: Array, zi: Array, sums: Array) -> None:
    """Set the sums that `step_ring` leaves, for a Z of its own: real and imaginary part, (pairs, lanes)."""
    for i in range(3 * LANES):
        sums[i] = 0.0
    for p in range(len(law.harmonic)):
        for lane in range(LANES):
            nr, ni = of(law.normal_re, p, lane), of(law.normal_im, p, lane)
            along = exact(nr, zr[p, lane]) + ni * zi[p, lane]
            across = exact(ni, zr[p, lane]) - nr * zi[p, lane]
            if p < law.straight:
                sums[lane] += along
            else:
                sums[LANES + lane] += along
                sums[2 * LANES + lane] += across
