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
from nw_gear_sim.compiled import fused, inlined, kernel, summing

EXPONENTS = 64
"""Binary exponents of a compression that have a table entry: 2^-60 .. 2^3 m."""
MARKS = 4
"""Most race defects at once."""
DEGREE, QUICK_DEGREE = 11, 6
"""Degrees of the polynomials for the mantissa's power; relative error below 1e-9 and 1e-7 for exponents from 1 to 2."""

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


class RaceMarks(NamedTuple):
    """Defects of races: arrays of shape (MARKS,), changed in place, of which `used`, shape (1,), are in use.

    A roller at a distance d (rad) from a defect sinks into it by depth (1 + cos(pi d / width)) / 2 where d < width, and
    loses that much of its compression: an impulse each time a loaded roller passes (McFadden and Smith 1984; shape of a
    shallow spall with soft edges).

    Attributes:
        bearing: which; angle: of the defect at the ring's angle 0, rad; ratio: of its turning over the ring's, 0 on the
            housing's race.
        width: half the extent, rad; depth: m.
        rollers: of the bearings, (bearings,); exponent: of the roller load.
    """

    used: Indices
    bearing: Indices
    angle: Array
    ratio: Array
    width: Array
    depth: Array
    rollers: Indices
    exponent: float


class BearingLaw(NamedTuple):
    """All bearings as arrays: places (bearings, 3), data (bearings,), roller patterns one after the other.

    Rollers of a bearing with an even number of them are taken in opposite pairs: unless the bearing is pressed together
    axially by more than its clearance, only one of the two is loaded, so that one power serves both.

    Attributes:
        start: first entry of each bearing in the pattern, and the total at the end, shape (bearings + 1,).
        paired: whether an entry stands for two opposite rollers.
        cos, sin: of 2 pi i / Z, shape (entries,).
        scale: 2^(e n) for the binary exponents e.
        polynomial, quick: of m^n over the mantissa m in [1, 2), highest first, of DEGREE and of QUICK_DEGREE.
        marks: defects of the races.
    """

    place: Indices
    start: Indices
    paired: npt.NDArray[np.bool_]
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
    quick: Array
    marks: RaceMarks


def bearing_law(bearings: Sequence[Bearing], exponent: float) -> BearingLaw:
    """Prepare the arrays of all bearings; `exponent` is n of the roller load (1 to 2)."""
    counts = [b.rollers // 2 if b.rollers % 2 == 0 else b.rollers for b in bearings]
    angles = [2 * math.pi * np.arange(count) / b.rollers for count, b in zip(counts, bearings, strict=True)]

    def column(values: Sequence[float]) -> Array:
        return np.array(values, dtype=np.float64)

    return BearingLaw(
        place=np.array([[b.x, b.y, b.z] for b in bearings], dtype=np.int64),
        start=np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        paired=np.array([b.rollers % 2 == 0 for b in bearings]),
        cos=np.cos(np.concatenate(angles)),
        sin=np.sin(np.concatenate(angles)),
        stiffness=column([b.stiffness for b in bearings]),
        radial=column([math.cos(b.contact_angle) for b in bearings]),
        axial=column([math.sin(b.contact_angle) if b.z >= 0 else 0.0 for b in bearings]),
        clearance=column([b.clearance for b in bearings]),
        damping=column([b.damping for b in bearings]),
        cage_ratio=column([b.cage_ratio for b in bearings]),
        scale=np.array([2.0 ** ((e - EXPONENTS + 4) * exponent) for e in range(EXPONENTS)]),
        polynomial=_mantissa_polynomial(exponent, DEGREE),
        quick=_mantissa_polynomial(exponent, QUICK_DEGREE),
        marks=_no_marks(bearings, exponent),
    )


def _no_marks(bearings: Sequence[Bearing], exponent: float) -> RaceMarks:
    angle, ratio, width, depth = np.zeros((4, MARKS))
    rollers = np.array([b.rollers for b in bearings], dtype=np.int64)
    none = np.zeros(MARKS, np.int64)
    return RaceMarks(np.zeros(1, np.int64), none, angle, ratio, width, depth, rollers, exponent)


def _mantissa_polynomial(exponent: float, degree: int) -> Array:
    """Chebyshev interpolant of m^n on [1, 2], as coefficients in t = 2 m - 3, highest first."""
    fit = np.polynomial.Chebyshev.interpolate(lambda m: m**exponent, degree, domain=[1, 2])
    return np.ascontiguousarray(np.polynomial.chebyshev.cheb2poly(fit.coef)[::-1])


def _bearing_forces(
    law: BearingLaw, quick: bool, cage: Array, q: Array, lean: Array, load: Array, housing: Array
) -> None:
    """Set the forces on the housings.

    Args:
        law: the bearings' arrays.
        quick: take powers by the quick polynomial.
        cage: cosine and sine of each cage's angle, shape (bearings, 2).
        q: displacements, m.
        lean, load: scratch, one entry for each entry of the pattern.
        housing: force on the housing, shape (bearings, 3), set here (N).
    """
    cos, sin, start = law.cos, law.sin, law.start
    for b in range(len(law.stiffness)):
        x, y = q[np.uint64(law.place[b, 0])], q[np.uint64(law.place[b, 1])]  # unsigned: no check for negative indices
        offset = law.axial[b] * q[max(law.place[b, 2], 0)] - law.clearance[b]
        along = law.radial[b] * (x * cage[b, 0] + y * cage[b, 1])
        across = law.radial[b] * (y * cage[b, 0] - x * cage[b, 1])
        if law.paired[b]:
            for i in range(np.uint64(start[b]), np.uint64(start[b + 1])):
                approach = along * cos[i] + across * sin[i]
                reached = abs(approach) + offset
                lean[i] = approach
                load[i] = reached if reached > 0.0 else 0.0
        else:
            for i in range(np.uint64(start[b]), np.uint64(start[b + 1])):
                reached = along * cos[i] + across * sin[i] + offset
                lean[i] = 1.0
                load[i] = reached if reached > 0.0 else 0.0
    _raise(law, quick, load)
    for b in range(len(law.stiffness)):
        total, along, across = 0.0, 0.0, 0.0
        for i in range(np.uint64(start[b]), np.uint64(start[b + 1])):
            signed = load[i] if lean[i] > 0.0 else -load[i]
            total += load[i]
            along += signed * cos[i]
            across += signed * sin[i]
        offset = law.axial[b] * q[max(law.place[b, 2], 0)] - law.clearance[b]
        if law.paired[b] and offset > 0.0:  # the opposite rollers carry too
            for i in range(np.uint64(start[b]), np.uint64(start[b + 1])):
                reached = offset - abs(lean[i])
                load[i] = reached if reached > 0.0 else 0.0
            _raise(law, quick, load[start[b] : start[b + 1]])
            for i in range(np.uint64(start[b]), np.uint64(start[b + 1])):
                signed = load[i] if lean[i] > 0.0 else -load[i]
                total += load[i]
                along -= signed * cos[i]
                across -= signed * sin[i]
        radial = law.stiffness[b] * law.radial[b]
        housing[b, 0] = radial * (cage[b, 0] * along - cage[b, 1] * across)
        housing[b, 1] = radial * (cage[b, 1] * along + cage[b, 0] * across)
        housing[b, 2] = law.stiffness[b] * law.axial[b] * total


bearing_forces = summing(_bearing_forces)
bearing_forces_here = inlined(_bearing_forces)
"""The same, put into its caller."""


@kernel
def turn_marks(marks: RaceMarks, angle: float, mark: Array) -> None:
    """Set cosine and sine of where the defects are, (MARKS, 2), at an angle of the ring, rad."""
    for k in range(marks.used[0]):
        turned = marks.angle[k] + marks.ratio[k] * angle
        mark[k, 0], mark[k, 1] = math.cos(turned), math.sin(turned)


@kernel
def add_marks(law: BearingLaw, mark: Array, cage: Array, q: Array, housing: Array) -> None:
    """Take from the forces on the housings what rollers lose that sink into defects; arguments as in bearing_forces."""
    marks = law.marks
    for k in range(marks.used[0]):
        b = marks.bearing[k]
        x, y = q[law.place[b, 0]], q[law.place[b, 1]]
        offset = law.axial[b] * q[max(law.place[b, 2], 0)] - law.clearance[b]
        least = math.cos(marks.width[k])
        for i in range(marks.rollers[b]):
            turned = 2.0 * math.pi * i / marks.rollers[b]
            c = cage[b, 0] * math.cos(turned) - cage[b, 1] * math.sin(turned)
            s = cage[b, 1] * math.cos(turned) + cage[b, 0] * math.sin(turned)
            near = c * mark[k, 0] + s * mark[k, 1]
            if near <= least:
                continue
            distance = math.acos(min(near, 1.0))
            sunk = 0.5 * marks.depth[k] * (1.0 + math.cos(math.pi * distance / marks.width[k]))
            reached = law.radial[b] * (x * c + y * s) + offset
            if reached > 0.0:
                lost = reached**marks.exponent - max(reached - sunk, 0.0) ** marks.exponent
                housing[b, 0] -= law.stiffness[b] * lost * law.radial[b] * c
                housing[b, 1] -= law.stiffness[b] * lost * law.radial[b] * s
                housing[b, 2] -= law.stiffness[b] * lost * law.axial[b]


@kernel
def add_bearings(law: BearingLaw, housing: Array, v: Array, force: Array) -> None:
    """Add the housings' reactions and the damping to ground to the generalised forces (N)."""
    for b in range(len(law.stiffness)):
        for axis in range(3):
            k = law.place[b, axis]
            if k >= 0:
                force[k] -= housing[b, axis] + law.damping[b] * v[k]


@inlined
def _raise(law: BearingLaw, quick: bool, load: Array) -> None:
    if quick:
        quick_power(law.scale, law.quick, load)
    else:
        power(law.scale, law.polynomial, load)


@fused
def quick_power(scale: Array, polynomial: Array, values: Array) -> None:
    """Do the same as `power` with a polynomial of QUICK_DEGREE."""
    bits = values.view(np.int64)
    c0, c1, c2, c3 = polynomial[0], polynomial[1], polynomial[2], polynomial[3]
    c4, c5, c6 = polynomial[4], polynomial[5], polynomial[6]
    for i in range(len(values)):
        word = bits[i]
        exponent = (word >> 52) - 1023 + 60
        mantissa = np.int64((word & 0xFFFFFFFFFFFFF) | 0x3FF0000000000000).view(np.float64)
        t = 2.0 * mantissa - 3.0
        result = (((((c0 * t + c1) * t + c2) * t + c3) * t + c4) * t + c5) * t + c6
        values[i] = result * scale[min(max(exponent, 0), 63)] if exponent >= 0 else 0.0


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
