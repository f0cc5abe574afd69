"""Roller bearings of many points at once: one point in each SIMD lane, opposite rollers together.

The law is that of `physics.bearing`. Of two opposite rollers only one is loaded unless the bearing is pressed together
by more than its clearance, so that one power serves both; the second is computed where any point needs it.

The power d^n is computed in single precision from the bits of d: with d = 2^e m and u = e (n - 1) = k + f

    d^n = d 2^k 2^f m^(n-1),        2^f and m^(n-1) polynomials

Relative error below 1e-6 for n from 1 to 2 and d from 1e-12 m to 1 m (a test holds it); `physics.bearing` has 1e-9.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import fused

Indices = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

_F32, _I32 = np.float32, np.int32


class Power(NamedTuple):
    """Coefficients of d^n: of m^(n-1) over m - 1.5 (7) and of 2^f over 1 + f (6), highest first; slope 2^23 (n - 1)."""

    mantissa: Singles
    fraction: Singles
    slope: Singles


class RollerLaw(NamedTuple):
    """All bearings: arrays of shape (bearings, lanes) if not said otherwise.

    Attributes:
        place: rows of x, y, z among the motions, (bearings, 3).
        start: first entry of each bearing in the pattern, and the total at the end.
        opposed: whether an entry stands for two opposite rollers.
        cos, sin: of the entries' angles at cage angle 0.
        radial, axial: cosine and sine of the contact angle; clearance: m.
        radial_force, axial_force: K times these, N/m^n.
        turn_cos, turn_sin: rotation of the cage in one step.
        power: of the roller's law.
    """

    place: Indices
    start: Indices
    opposed: npt.NDArray[np.bool_]
    cos: Array
    sin: Array
    radial: Array
    axial: Array
    clearance: Array
    radial_force: Array
    axial_force: Array
    turn_cos: Array
    turn_sin: Array
    power: Power


def power_law(exponent: float) -> Power:
    """Prepare d^n for an exponent n from 1 to 2."""

    def fit(function: object, degree: int, low: float, high: float) -> Singles:
        found = np.polynomial.Chebyshev.interpolate(function, degree, domain=[low, high])
        return found.convert(kind=np.polynomial.Polynomial).coef[::-1].astype(np.float32)

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


@fused
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


@fused
def raise_all(power: Power, values: Array) -> None:
    """Raise compressions (m, >= 0) to the power n, in place."""
    p, q = power.mantissa, power.fraction
    for i in range(len(values)):
        values[i] = raised(values[i], power.slope[0], p, q)


@fused
def turn(cos: Array, sin: Array, turn_cos: Array, turn_sin: Array) -> None:
    """Turn unit vectors by one step, in place, arrays of one shape."""
    c, s = cos.reshape(cos.size), sin.reshape(sin.size)
    tc, ts = turn_cos.reshape(cos.size), turn_sin.reshape(cos.size)
    for i in range(len(c)):
        kept = c[i]
        c[i] = kept * tc[i] - s[i] * ts[i]
        s[i] = s[i] * tc[i] + kept * ts[i]


@fused
def add_rollers(law: RollerLaw, cos: Array, sin: Array, x: Array, work: Array, force: Array) -> None:
    """Add the forces of all bearings on the motions.

    Args:
        law: of the bearings.
        cos, sin: of the cages' angles, (bearings, lanes).
        x: displacements, m, (motions, lanes).
        work: scratch, (6, lanes).
        force: N, (motions, lanes).
    """
    lanes = x.shape[1]
    for b in range(len(law.opposed)):
        i, j, k = law.place[b]
        pressed = False
        for lane in range(lanes):
            c, s = cos[b, lane], sin[b, lane]
            work[0, lane] = law.radial[b, lane] * (x[i, lane] * c + x[j, lane] * s)
            work[1, lane] = law.radial[b, lane] * (x[j, lane] * c - x[i, lane] * s)
            offset = law.axial[b, lane] * x[k, lane] - law.clearance[b, lane]
            work[2, lane] = offset
            pressed |= offset > 0.0
            work[3, lane], work[4, lane], work[5, lane] = 0.0, 0.0, 0.0
        if law.opposed[b]:
            _pairs(law, law.start[b], law.start[b + 1], 1.0, work)
            if pressed:
                _pairs(law, law.start[b], law.start[b + 1], -1.0, work)
        else:
            _singles(law, law.start[b], law.start[b + 1], work)
        for lane in range(lanes):
            c, s = cos[b, lane], sin[b, lane]
            radial, along, across = law.radial_force[b, lane], work[4, lane], work[5, lane]
            force[i, lane] -= radial * (c * along - s * across)
            force[j, lane] -= radial * (s * along + c * across)
            force[k, lane] -= law.axial_force[b, lane] * work[3, lane]


@fused
def _pairs(law: RollerLaw, first: int, last: int, side: float, work: Array) -> None:
    """Add the more compressed (side 1) or the less compressed (-1) rollers of opposite ones."""
    slope, p, q = law.power.slope[0], law.power.mantissa, law.power.fraction
    ps, qs = (p[0], p[1], p[2], p[3], p[4], p[5], p[6]), (q[0], q[1], q[2], q[3], q[4], q[5])
    for i in range(first, last):
        cos, sin = law.cos[i], law.sin[i]
        for lane in range(work.shape[1]):
            reach = work[0, lane] * cos + work[1, lane] * sin
            load = raised(max(side * abs(reach) + work[2, lane], 0.0), slope, ps, qs)
            pointed = math.copysign(load, side * reach)
            work[3, lane] += load
            work[4, lane] += pointed * cos
            work[5, lane] += pointed * sin


@fused
def _singles(law: RollerLaw, first: int, last: int, work: Array) -> None:
    slope, p, q = law.power.slope[0], law.power.mantissa, law.power.fraction
    ps, qs = (p[0], p[1], p[2], p[3], p[4], p[5], p[6]), (q[0], q[1], q[2], q[3], q[4], q[5])
    for i in range(first, last):
        cos, sin = law.cos[i], law.sin[i]
        for lane in range(work.shape[1]):
            reach = work[0, lane] * cos + work[1, lane] * sin
            load = raised(max(reach + work[2, lane], 0.0), slope, ps, qs)
            work[3, lane] += load
            work[4, lane] += load * cos
            work[5, lane] += load * sin
