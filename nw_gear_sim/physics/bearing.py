"""Rolling bearings: the sum of the rollers' forces, with clearance, contact angle and a turning cage (paper Eqs 19-27).

Roller i at th_i = cage angle + 2 pi i / Z is compressed by

    delta_i = (x cos th_i + y sin th_i) cos g + z sin g - c

and carries K delta_i^n where delta_i > 0; the housing takes the sum of K delta_i^n (cos g cos th_i, cos g sin th_i,
sin g). First order of the paper's Eqs 22-24; no centrifugal or gyroscopic load, no slip, no tilt. The stiffness
varies in time because the cage turns.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import fused, kernel, summing

EXPONENTS = 64
"""Binary exponents of a compression that have a table entry: 2^-60 .. 2^3 m."""
DEGREE = 11
"""Degree of the polynomial for the mantissa's power; relative error below 1e-9 for exponents from 1 to 2."""

Indices = npt.NDArray[np.int64]


class Bearing(NamedTuple):
    """One bearing: places of its x, y, z in the state (z: -1 where it holds nothing axially) and its data.

    Attributes:
        rollers: number Z; stiffness: K, N/m^n; contact_angle: g, rad; clearance: c, m; damping: to ground, N s/m;
        cage_ratio: angle of the cage over that of the ring, with the sign of the shaft's sense of rotation.
    """

    x: int
    y: int
    z: int
    rollers: int
    stiffness: float
    contact_angle: float
    clearance: float
    damping: float
    cage_ratio: float


class BearingLaw(NamedTuple):
    """All bearings as arrays: places (bearings, 3), data (bearings,), roller patterns one after the other.

    Attributes:
        start: first roller of each bearing in the pattern, and the total at the end, shape (bearings + 1,).
        cos, sin: of 2 pi i / Z, shape (rollers,).
        scale: 2^(e n) for the binary exponents e; polynomial: of m^n over the mantissa m in [1, 2), highest first.
    """

    place: Indices
    start: Indices
    cos: Array
    sin: Array
    stiffness: Array
    radial: Array
    axial: Array
    clearance: Array
    damping: Array
    cage_ratio: Array
    scale: Array
    polynomial: Array


def bearing_law(bearings: Sequence[Bearing], exponent: float) -> BearingLaw:
    """Prepare the arrays of all bearings; `exponent` is n of the roller load (1 to 2)."""
    angles = [2 * math.pi * np.arange(b.rollers) / b.rollers for b in bearings]

    def column(values: Sequence[float]) -> Array:
        return np.array(values, dtype=np.float64)

    return BearingLaw(
        place=np.array([[b.x, b.y, b.z] for b in bearings], dtype=np.int64),
        start=np.concatenate([[0], np.cumsum([b.rollers for b in bearings])]).astype(np.int64),
        cos=np.cos(np.concatenate(angles)),
        sin=np.sin(np.concatenate(angles)),
        stiffness=column([b.stiffness for b in bearings]),
        radial=column([math.cos(b.contact_angle) for b in bearings]),
        axial=column([math.sin(b.contact_angle) if b.z >= 0 else 0.0 for b in bearings]),
        clearance=column([b.clearance for b in bearings]),
        damping=column([b.damping for b in bearings]),
        cage_ratio=column([b.cage_ratio for b in bearings]),
        scale=np.array([2.0 ** ((e - EXPONENTS + 4) * exponent) for e in range(EXPONENTS)]),
        polynomial=_mantissa_polynomial(exponent),
    )


def _mantissa_polynomial(exponent: float) -> Array:
    """Chebyshev interpolant of m^n on [1, 2], as coefficients in t = 2 m - 3, highest first."""
    fit = np.polynomial.Chebyshev.interpolate(lambda m: m**exponent, DEGREE, domain=[1, 2])
    return np.ascontiguousarray(np.polynomial.chebyshev.cheb2poly(fit.coef)[::-1])


@summing
def bearing_forces(law: BearingLaw, cage: Array, q: Array, load: Array, housing: Array) -> None:
    """Set the forces on the housings.

    Args:
        law: the bearings' arrays.
        cage: cosine and sine of each cage's angle, shape (bearings, 2).
        q: displacements, m.
        load: scratch, one entry per roller.
        housing: force on the housing, shape (bearings, 3), set here (N).
    """
    _compress(law, cage, q, load)
    power(law.scale, law.polynomial, load)
    cos, sin, start = law.cos, law.sin, law.start
    for b in range(len(law.stiffness)):
        total, total_cos, total_sin = 0.0, 0.0, 0.0
        for i in range(np.uint64(start[b]), np.uint64(start[b + 1])):  # unsigned: no check for negative indices
            total += load[i]
            total_cos += load[i] * cos[i]
            total_sin += load[i] * sin[i]
        radial = law.stiffness[b] * law.radial[b]
        housing[b, 0] = radial * (cage[b, 0] * total_cos - cage[b, 1] * total_sin)
        housing[b, 1] = radial * (cage[b, 1] * total_cos + cage[b, 0] * total_sin)
        housing[b, 2] = law.stiffness[b] * law.axial[b] * total


@fused
def _compress(law: BearingLaw, cage: Array, q: Array, load: Array) -> None:
    """Compression of each roller, 0 where it carries nothing, in the cage's frame."""
    place, start, cos, sin = law.place, law.start, law.cos, law.sin
    for b in range(len(law.stiffness)):
        x, y = q[place[b, 0]], q[place[b, 1]]
        offset = law.axial[b] * q[max(place[b, 2], 0)] - law.clearance[b]
        along = law.radial[b] * (x * cage[b, 0] + y * cage[b, 1])
        across = law.radial[b] * (y * cage[b, 0] - x * cage[b, 1])
        for i in range(np.uint64(start[b]), np.uint64(start[b + 1])):
            compression = along * cos[i] + across * sin[i] + offset
            load[i] = compression if compression > 0.0 else 0.0


@kernel
def add_bearings(law: BearingLaw, housing: Array, v: Array, force: Array) -> None:
    """Add the housings' reactions and the damping to ground to the generalised forces (N)."""
    for b in range(len(law.stiffness)):
        for axis in range(3):
            k = law.place[b, axis]
            if k >= 0:
                force[k] -= housing[b, axis] + law.damping[b] * v[k]


@fused
def power(scale: Array, polynomial: Array, values: Array) -> None:
    """Raise values in [0, 16) to the law's exponent, in place; below 2^-60 the result is 0.

    The power of the binary exponent is looked up, that of the mantissa is a polynomial.
    """
    bits = values.view(np.int64)
    p = polynomial
    c0, c1, c2, c3, c4, c5 = p[0], p[1], p[2], p[3], p[4], p[5]
    c6, c7, c8, c9, c10, c11 = p[6], p[7], p[8], p[9], p[10], p[11]
    for i in range(len(values)):
        word = bits[i]
        exponent = (word >> 52) - 1023 + 60
        mantissa = np.int64((word & 0xFFFFFFFFFFFFF) | 0x3FF0000000000000).view(np.float64)
        t = 2.0 * mantissa - 3.0
        high = ((((c0 * t + c1) * t + c2) * t + c3) * t + c4) * t + c5
        result = (((((high * t + c6) * t + c7) * t + c8) * t + c9) * t + c10) * t + c11
        values[i] = result * scale[min(max(exponent, 0), 63)] if exponent >= 0 else 0.0
