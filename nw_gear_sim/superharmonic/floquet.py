"""Characteristic exponents of a periodic orbit of the delay equation, by Hill's method.

A disturbance y = exp(lambda t) sum of Y_k exp(i k nu t) obeys T(lambda) Y = 0 with

    T_kj = delta_kj [s^2 + eps (2 c zeta s - g_d exp(-s tau_d) - g_v s exp(-s tau_v))] + K_(k-j),   s = lambda + i k nu,

K_n the Fourier coefficients of the stiffness along the orbit. Without the delays this is a quadratic eigenvalue
problem; its two exponents of the oscillator start Newton's method on the whole. A delay adds infinitely many more
exponents; with a feedback of order eps they lie far to the left.

With the true backlash K(t) jumps where flanks touch or part. The force itself is continuous, so a disturbance crosses
these instants without a jump (its saltation matrix is 1), and T holds as it stands; but its series converges slowly,
and `variation` is the better way there. The exponents say nothing where the orbit grazes: where it touches a flank, x
= +-1, with no speed.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.linalg

from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.contact import contacts
from nw_gear_sim.superharmonic.harmonics import Balance, Orbit, basis
from nw_gear_sim.superharmonic.restoring import Backlash
from nw_gear_sim.superharmonic.variation import exponents_in_time

Complex = npt.NDArray[np.complex128]

MARGIN = 6
"""Harmonics of the disturbance beyond those of the orbit."""
SAMPLES = 256
MOST_ITERATIONS = 30
CONVERGED = 1e-12


def exponents(balance: Balance, orbit: Orbit) -> Complex:
    """Return the two characteristic exponents of the oscillator, imaginary parts within +-omega/2, largest real first.

    Args:
        balance: the equation that the orbit belongs to; orbit: of it.

    Returns:
        (2,) exponents per unit of the dimensionless time; a pair of complex conjugates or two real ones.
    """
    order = orbit.order + MARGIN
    stiffness = _stiffness(balance, orbit, order)
    starts = _frozen(balance, orbit, stiffness, order)
    found = np.array([_refine(balance, orbit.omega, stiffness, order, *start) for start in starts])
    folded = found.real + 1j * (np.mod(found.imag + 0.5 * orbit.omega, orbit.omega) - 0.5 * orbit.omega)
    ordered: Complex = folded[np.argsort(-folded.real)]
    return ordered


def is_stable(balance: Balance, orbit: Orbit) -> bool:
    """Return whether both exponents have negative real parts; with a backlash they are integrated (`variation`)."""
    found = exponents_in_time if isinstance(balance.restoring, Backlash) else exponents
    return bool(found(balance, orbit)[0].real < 0.0)


def _stiffness(balance: Balance, orbit: Orbit, order: int) -> Complex:
    """Return the Toeplitz matrix of the Fourier coefficients of the stiffness, (2 order + 1, 2 order + 1)."""
    k = np.arange(2 * order + 1)
    if isinstance(balance.restoring, Backlash):
        spectrum = _of_contact(orbit, 2 * order) * balance.restoring.slope
        return np.asarray(spectrum[(k[:, None] - k[None, :]) % len(spectrum)], dtype=complex)
    angles = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    along: Array = balance.restoring.stiffness(basis(orbit.order, angles) @ orbit.coefficients)
    spectrum = np.fft.fft(along) / SAMPLES
    return np.asarray(spectrum[(k[:, None] - k[None, :]) % SAMPLES], dtype=complex)


def _of_contact(orbit: Orbit, most: int) -> Complex:
    """Return the Fourier coefficients 0..most, -most..-1 of what is 1 where the flanks touch, |x| > 1, and 0 elsewhere.

    It jumps where x = +-1; the coefficients follow from these angles in closed form. Sampling would leave errors of the
    order of one sample in each jump.
    """
    angles, touching = contacts(orbit)
    n = np.concatenate([np.arange(most + 1), np.arange(-most, 0)])
    if len(angles) == 0:
        return np.where(n == 0, float(touching), 0.0).astype(complex)
    ends = np.append(angles[1:], angles[0] + 2.0 * np.pi)
    begins, ends = angles[0 if touching else 1 :: 2], ends[0 if touching else 1 :: 2]
    whole = np.where(n == 0, 1, n)[:, None]
    turned = (np.exp(-1j * whole * ends) - np.exp(-1j * whole * begins)) / (-2j * np.pi * whole)
    found: Complex = np.where(n == 0, np.sum(ends - begins) / (2.0 * np.pi), turned.sum(axis=1))
    return found


def _frozen(balance: Balance, orbit: Orbit, stiffness: Complex, order: int) -> list[tuple[complex, Complex]]:
    """Return exponents and disturbances with the delayed terms taken at lambda = 0.

    Every exponent appears once per harmonic, shifted by i nu; those whose disturbance is centred on harmonic 0 are
    computed best.
    """
    p, n = balance.pair, 2 * order + 1
    k = np.arange(-order, order + 1)
    s = 1j * k * orbit.omega
    delayed = p.eps * (p.g_d * np.exp(-s * p.tau_d) + p.g_v * s * np.exp(-s * p.tau_v))
    damping = np.diag(2.0 * s + 2.0 * p.eps * p.c * p.zeta)
    rest = np.diag(s**2 + 2.0 * p.eps * p.c * p.zeta * s - delayed) + stiffness
    companion = np.block([[np.zeros((n, n)), np.eye(n)], [-rest, -damping]])
    values, vectors = scipy.linalg.eig(companion)
    shapes = vectors[:n] / np.linalg.norm(vectors[:n], axis=0)
    centre = np.abs(np.sum(k[:, None] * np.abs(shapes) ** 2, axis=0))
    best = np.argsort(centre)
    first = int(best[0])
    for other in best[1:]:
        apart = values[other] - values[first]
        turns = round(apart.imag / orbit.omega)
        if abs(apart - 1j * turns * orbit.omega) > 1e-9:
            return [(complex(values[m]), shapes[:, m]) for m in (first, int(other))]
    return [(complex(values[first]), shapes[:, first])] * 2


def _refine(balance: Balance, omega: float, stiffness: Complex, order: int, value: complex, shape: Complex) -> complex:
    """Return the exponent near `value` with the delays in, by Newton's method on T(lambda) Y = 0, Y0^H Y = 1."""
    p, k = balance.pair, np.arange(-order, order + 1)
    kept = shape.conj()
    y = shape / (kept @ shape)
    n = len(k)
    for _ in range(MOST_ITERATIONS):
        s = value + 1j * k * omega
        feed_d, feed_v = p.g_d * np.exp(-s * p.tau_d), p.g_v * np.exp(-s * p.tau_v)
        matrix = np.diag(s**2 + p.eps * (2.0 * p.c * p.zeta * s - feed_d - s * feed_v)) + stiffness
        slope = 2.0 * s + p.eps * (2.0 * p.c * p.zeta + p.tau_d * feed_d - (1.0 - s * p.tau_v) * feed_v)
        system = np.zeros((n + 1, n + 1), dtype=complex)
        system[:n, :n], system[:n, n], system[n, :n] = matrix, slope * y, kept
        step = np.linalg.solve(system, np.append(-matrix @ y, 1.0 - kept @ y))
        y, value = y + step[:n], value + complex(step[n])
        if abs(step[n]) < CONVERGED:
            break
    return value
