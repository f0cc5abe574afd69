"""Roller bearings of many points at once: one point in each SIMD lane, opposite rollers together.

The law is that of `physics.bearing`. Of two opposite rollers only one is loaded unless the bearing is pressed together
by more than its clearance, so that one power serves both; the second is computed where any point needs it.

The power d^n is computed in single precision from the bits of d: with d = 2^e m and u = e (n - 1) = k + f

    d^n = d 2^k 2^f m^(n-1),        2^f and m^(n-1) polynomials

Relative error below 1e-6 for n from 1 to 2 and d from 1e-12 m to 1 m (a test holds it); `physics.bearing` has 1e-9.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.batch.lanes import LANES, exact
from nw_gear_sim.compiled import apart

Indices = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

_F32, _I32 = np.float32, np.int32


class Power(NamedTuple):
    """Coefficients of d^n: of m^(n-1) over m - 1.5 (7) and of 2^f over 1 + f (6), highest first; slope 2^23 (n - 1)."""

    mantissa: Singles
    fraction: Singles
    slope: Singles


class RollerLaw(NamedTuple):
    """All bearings: flat arrays (bearings, lanes) if not said otherwise.

    Attributes:
        first: row of x among the motions, those of y and z follow, (bearings,). Where a bearing holds nothing axially,
            the third row is another motion's, and the axial parts below are 0.
        start: first entry of each bearing in the pattern, and the total at the end.
        opposed: whether an entry stands for two opposite rollers.
        cos, sin: of the entries' angles at cage angle 0.
        radial, axial: cosine and sine of the contact angle; clearance: m.
        radial_force, axial_force: K times these, N/m^n.
        power: of the roller's law.
    """

    first: Indices
    start: Indices
    opposed: npt.NDArray[np.bool_]
    cos: Array
    sin: Array
    radial: Array
    axial: Array
    clearance: Array
    radial_force: Array
    axial_force: Array
    power: Power


def power_law(exponent: float) -> Power:
    """Prepare d^n for an exponent n from 1 to 2."""

    def fit(function: Callable[[Array], Array], degree: int, low: float, high: float) -> Singles:
        found = np.polynomial.Chebyshev.interpolate(function, degree, domain=[low, high])
        powers = np.asarray(found.convert(kind=np.polynomial.Polynomial).coef, dtype=np.float32)
        return powers[::-1].copy()

    return Power(
        mantissa=fit(lambda m: (m + 1.5) ** (exponent - 1), 6, -0.5, 0.5),
        fraction=fit(lambda g: 2.0 ** (g - 1), 5, 1.0, 2.0),
        slope=np.array([2.0**23 * (exponent - 1)], dtype=np.float32),
    )


def pattern(counts: Indices) -> tuple[Indices, npt.NDArray[np.bool_], Array, Array]:
    """Return start, opposed, cos and sin of `RollerLaw` for bearings with these numbers of rollers."""
    opposed = counts % 2 == 0
    entries = np.where(opposed, counts // 2, counts)
    angle = np.concatenate([2 * math.pi * np.arange(n) / z for n, z in zip(entries, counts, strict=True)])
    return np.concatenate([[0], np.cumsum(entries)]).astype(np.int64), opposed, np.cos(angle), np.sin(angle)


@apart
def raised(d: float, slope: float, p: Singles, q: Singles) -> float:
    """Return d^n of a compression d >= 0."""
    word = _F32(d).view(np.int32)
    t = _I32((word & _I32(0x7FFFFF)) | _I32(0x3F800000)).view(np.float32) - _F32(1.5)
    exponent = _F32(_I32((word >> _I32(23)) - _I32(127)))
    scaled = _I32(_I32(_F32(exponent * slope)) + _I32(0x3F800000))
    g = _I32((scaled & _I32(0x7FFFFF)) | _I32(0x3F800000)).view(np.float32)
    whole = _I32(scaled & _I32(0x7F800000)).view(np.float32)
    a = p[0] * t + p[1]
    a = a * t + p[2]
    a = a * t + p[3]
    a = a * t + p[4]
    a = a * t + p[5]
    a = a * t + p[6]
    b = q[0] * g + q[1]
    b = b * g + q[2]
    b = b * g + q[3]
    b = b * g + q[4]
    b = b * g + q[5]
    return d * np.float64(a * (b * whole))


@apart
def raise_all(power: Power, values: Array) -> None:
    """Raise compressions (m, >= 0) to the power n, in place."""
    p, q = power.mantissa, power.fraction
    for i in range(len(values)):
        values[i] = raised(values[i], power.slope[0], p, q)


@apart
def add_rollers(law: RollerLaw, cage: Array, x: Array, work: Array, force: Array) -> None:
    """Add the forces of all bearings on the motions.

    Args:
        law: of the bearings.
        cage: cosine and sine of the cages' angles, flat (2, bearings, lanes).
        x: displacements, m, flat (motions, lanes).
        work: scratch, flat (6, lanes).
        force: N, flat (motions, lanes).
    """
    across_row = len(law.opposed) * LANES
    for b in range(len(law.opposed)):
        at, row = b * LANES, law.first[b] * LANES
        here, pushed = x[row : row + 3 * LANES], force[row : row + 3 * LANES]
        cos, sin = cage[at : at + LANES], cage[across_row + at : across_row + at + LANES]
        pressed = 0
        for lane in range(LANES):
            c, s = cos[lane], sin[lane]
            radial = law.radial[at + lane]
            work[lane] = radial * (exact(here[lane], c) + here[LANES + lane] * s)
            work[LANES + lane] = radial * (exact(here[LANES + lane], c) - here[lane] * s)
            offset = law.axial[at + lane] * here[2 * LANES + lane] - law.clearance[at + lane]
            work[2 * LANES + lane] = offset
            pressed |= offset > 0.0
        for lane in range(3 * LANES):
            work[3 * LANES + lane] = 0.0
        if law.opposed[b]:
            _add_pairs(law, law.start[b], law.start[b + 1], 1.0, work)
            if pressed:
                _add_pairs(law, law.start[b], law.start[b + 1], -1.0, work)
        else:
            _add_singles(law, law.start[b], law.start[b + 1], work)
        for lane in range(LANES):
            c, s = cos[lane], sin[lane]
            radial, along, across = law.radial_force[at + lane], work[4 * LANES + lane], work[5 * LANES + lane]
            pushed[lane] -= radial * (exact(c, along) - s * across)
            pushed[LANES + lane] -= radial * (exact(s, along) + c * across)
            pushed[2 * LANES + lane] -= law.axial_force[at + lane] * work[3 * LANES + lane]


@apart
def _add_pairs(law: RollerLaw, first: int, last: int, side: float, work: Array) -> None:
    """Add the more compressed (side 1) or the less compressed (-1) rollers of opposite ones."""
    slope, p, q = law.power.slope[0], law.power.mantissa, law.power.fraction
    ps, qs = (p[0], p[1], p[2], p[3], p[4], p[5], p[6]), (q[0], q[1], q[2], q[3], q[4], q[5])
    for i in range(first, last):
        cos, sin = law.cos[i], law.sin[i]
        for lane in range(LANES):
            reach = side * (exact(work[lane], cos) + work[LANES + lane] * sin)
            load = raised(max(side * abs(reach) + work[2 * LANES + lane], 0.0), slope, ps, qs)
            pointed = math.copysign(load, reach)
            work[3 * LANES + lane] += load
            work[4 * LANES + lane] += pointed * cos
            work[5 * LANES + lane] += pointed * sin


@apart
def _add_singles(law: RollerLaw, first: int, last: int, work: Array) -> None:
    slope, p, q = law.power.slope[0], law.power.mantissa, law.power.fraction
    ps, qs = (p[0], p[1], p[2], p[3], p[4], p[5], p[6]), (q[0], q[1], q[2], q[3], q[4], q[5])
    for i in range(first, last):
        cos, sin = law.cos[i], law.sin[i]
        for lane in range(LANES):
            reach = exact(work[lane], cos) + work[LANES + lane] * sin
            load = raised(max(reach + work[2 * LANES + lane], 0.0), slope, ps, qs)
            work[3 * LANES + lane] += load
            work[4 * LANES + lane] += load * cos
            work[5 * LANES + lane] += load * sin
