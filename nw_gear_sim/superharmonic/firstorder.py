"""Superharmonic resonance by the method of multiple scales: amplitudes, stability, folds (paper Eqs 70-80, corrected).

To first order in eps the motion is x = X0 + 2 Lam cos(nu t) + alpha cos(3 nu t - phi) with

    alpha'     = -mu alpha - W3 sin(phi)
    alpha phi' = alpha (S - Gam alpha^2) - W3 cos(phi)

so that steady amplitudes are the roots of alpha^2 [mu^2 + (S - Gam alpha^2)^2] = W3^2, a cubic in alpha^2, solved
exactly. The printed equations can't produce the paper's figures; the mode `paper_eq75` keeps the two differences that
change numbers without making them absurd: the sign of the velocity gain in Eq. (75), second line, and a stability
condition (80) that looks at the determinant alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.pair import PARAMETERS, GearPair

MODES = ("corrected", "paper_eq75")
TRUSTED = 0.005
"""Largest eps 3 q Lam^2 / w0 at which the peak amplitude is within 5 % of the delay equation's."""
OMEGA = "omega"
"""Name of the axis of excitation frequencies nu."""


@dataclass(frozen=True)
class Coefficients:
    """Coefficients of the modulation equations; numbers or arrays of one shape.

    Attributes:
        mu: effective damping, c zeta - [g_v cos(w0 tau_v) - (g_d/w0) sin(w0 tau_d)]/2.
        shift: S = sigma + G - N: detuning sigma = (3 nu - w0)/eps, feedback G, hardening by the forced motion N.
        bend: Gam = 3 q / 8.
        drive: W3 = q Lam^3.
        forced: Lam = f / (2 (w0^2 - nu^2)).
    """

    mu: Any
    shift: Any
    bend: Any
    drive: Any
    forced: Any


@dataclass(frozen=True, eq=False)
class Branches:
    """Steady amplitudes along a curve.

    Attributes:
        values: (n,) of what the curve runs over.
        alpha: (n, 3) amplitudes in ascending order; the second and third are NaN where there is one only.
        stable: (n, 3) whether each is stable; False where there is none.
        folds: values at which two amplitudes meet, ascending.
        trust: (n,) the measure that has to be under TRUSTED.
    """

    values: Array
    alpha: Array
    stable: npt.NDArray[np.bool_]
    folds: tuple[float, ...]
    trust: Array

    @property
    def multivalued(self) -> npt.NDArray[np.bool_]:
        """(n,) Where three amplitudes exist."""
        several: npt.NDArray[np.bool_] = np.isfinite(self.alpha[:, 1])
        return several


def coefficients(pair: GearPair, omega: Any, mode: str = "corrected", **changed: Any) -> Coefficients:
    """Return the coefficients at excitation frequencies `omega`.

    Args:
        pair: the gear pair.
        omega: nu, a number or an array.
        mode: of MODES.
        changed: arrays in the place of parameters of the pair, broadcast against `omega`.

    Raises:
        InputError: unknown mode or parameter.
    """
    if mode not in MODES:
        raise InputError("mode", " or ".join(MODES), mode)
    unknown = set(changed) - set(PARAMETERS)
    if unknown:
        raise InputError(f"parameter {min(unknown)}", "one of " + ", ".join(PARAMETERS), min(unknown))
    p = {name: changed.get(name, getattr(pair, name)) for name in PARAMETERS}
    w0, q, nu = pair.w0, pair.q, np.asarray(omega, dtype=float)
    sign = 1.0 if mode == "corrected" else -1.0
    sin_d, cos_d = np.sin(w0 * p["tau_d"]), np.cos(w0 * p["tau_d"])
    sin_v, cos_v = np.sin(w0 * p["tau_v"]), np.cos(w0 * p["tau_v"])
    forced = p["force"] / (2.0 * (w0**2 - nu**2))
    still = p["mean_force"] / w0**2
    mu = pair.c * p["zeta"] - 0.5 * (p["g_v"] * cos_v - p["g_d"] / w0 * sin_d)
    feedback = 0.5 * (p["g_d"] / w0 * cos_d + sign * p["g_v"] * sin_v)
    hardening = 3.0 * q * forced**2 + 1.5 * q * still**2
    shift = (3.0 * nu - w0) / pair.eps + feedback - hardening
    return Coefficients(*np.broadcast_arrays(mu, shift, 3.0 * q / 8.0, q * forced**3, forced))


def discriminant(c: Coefficients) -> Any:
    """Return what is positive where three amplitudes exist, negative where one does.

    With s = S/Gam, m = mu/Gam, w = W3/Gam the cubic in a = alpha^2 is a^3 - 2 s a^2 + (s^2 + m^2) a - w^2.
    """
    s, m2, w2 = c.shift / c.bend, (c.mu / c.bend) ** 2, (c.drive / c.bend) ** 2
    a, b, d = -2.0 * s, s**2 + m2, -w2
    return 18.0 * a * b * d - 4.0 * a**3 * d + a**2 * b**2 - 4.0 * b**3 - 27.0 * d**2


def amplitudes(c: Coefficients, mode: str = "corrected") -> tuple[Array, npt.NDArray[np.bool_]]:
    """Return all steady amplitudes and whether they are stable.

    A steady motion is stable where mu > 0 and mu^2 + V (V - 2 Gam alpha^2) > 0, V = S - Gam alpha^2; `paper_eq75`
    looks at the second condition alone.

    Returns:
        alpha, stable: of shape (n, 3), as in `Branches`, for coefficients of shape (n,).
    """
    mu, s, bend, drive = (np.atleast_1d(np.asarray(v, dtype=float)) for v in (c.mu, c.shift, c.bend, c.drive))
    companion = np.zeros((mu.size, 3, 3))
    companion[:, 1, 0] = companion[:, 2, 1] = 1.0
    companion[:, 0, 2] = (drive / bend) ** 2
    companion[:, 1, 2] = -((s / bend) ** 2 + (mu / bend) ** 2)
    companion[:, 2, 2] = 2.0 * s / bend
    roots = np.linalg.eigvals(companion)
    three = np.atleast_1d(discriminant(c)) > 0.0
    squares = np.sort(np.where(three[:, None], roots.real, np.nan), axis=1)
    real = roots[np.arange(mu.size), np.argmin(np.abs(roots.imag), axis=1)].real
    squares[~three, 0] = real[~three]
    alpha = np.sqrt(np.maximum(squares, 0.0))
    v = s[:, None] - bend[:, None] * squares
    stable = mu[:, None] ** 2 + v * (v - 2.0 * bend[:, None] * squares) > 0.0
    if mode == "corrected":
        stable &= mu[:, None] > 0.0
    return alpha, stable & np.isfinite(alpha)


def trust(pair: GearPair, c: Coefficients) -> Any:
    """Return eps 3 q Lam^2 / w0: by how much the forced motion shifts the resonance, relative to w0."""
    return pair.eps * 3.0 * pair.q * c.forced**2 / pair.w0


def branches(pair: GearPair, over: str, values: Array, *, omega: float | None = None, mode: str = MODES[0]) -> Branches:
    """Return the steady amplitudes along an axis.

    Args:
        pair: the gear pair.
        over: `omega`, or a name of PARAMETERS.
        values: (n,) ascending.
        omega: excitation frequency where `over` is a parameter.
        mode: of MODES.

    Raises:
        InputError: unknown axis or mode, no values, or no frequency.
    """
    if over not in (OMEGA, *PARAMETERS):
        raise InputError("axis", "one of " + ", ".join((OMEGA, *PARAMETERS)), over)
    axis = np.asarray(values, dtype=float)
    if axis.ndim != 1 or axis.size == 0 or np.any(np.diff(axis) <= 0.0) or not np.isfinite(axis).all():
        raise InputError(f"values of {over}", "at least one finite number, in ascending order", f"shape {axis.shape}")
    if over != OMEGA and omega is None:
        raise InputError("omega", f"an excitation frequency for a curve over {over}", "nothing")

    def at(value: Any) -> Coefficients:
        return coefficients(pair, value, mode) if over == OMEGA else coefficients(pair, omega, mode, **{over: value})

    c = at(axis)
    alpha, stable = amplitudes(c, mode)
    sign = np.atleast_1d(discriminant(c)) > 0.0
    folds = tuple(
        float(brentq(lambda value: float(discriminant(at(value))), axis[k], axis[k + 1], xtol=1e-15))
        for k in np.flatnonzero(sign[1:] != sign[:-1])
    )
    return Branches(axis, alpha, stable, folds, np.atleast_1d(trust(pair, c)))


def critical_damping(c: Coefficients) -> Any:
    """Return mu_c, mu_c^3 = (3 sqrt(3)/8) Gam W3^2: with |mu| below it the resonance curve has folds."""
    return np.cbrt(3.0 * np.sqrt(3.0) / 8.0 * c.bend * c.drive**2)


def peak(c: Coefficients) -> Any:
    """Return the largest amplitude along the resonance curve, W3/|mu| (with Lam taken as constant)."""
    return np.abs(c.drive) / np.abs(c.mu)
