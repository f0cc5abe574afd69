"""Periodic orbits of the delay equation by harmonic balance, followed by pseudo-arclength continuation.

x(t) = a_0 + sum over k <= H of a_k cos(k theta) + b_k sin(k theta), theta = nu t. The linear part with its delays is
exact in each harmonic, the restoring force is evaluated in time (alternating frequency and time, Cameron and Griffin
1989). Nothing is assumed small: what is left out is harmonics above H.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nw_gear_common.errors import NwGearError
from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.pair import GearPair
from nw_gear_sim.superharmonic.restoring import Cubic, Restoring

Complex = npt.NDArray[np.complex128]
HARMONICS = 9
SAMPLES = 128
"""Points of time per period; products of three harmonics of order H fold back only above H."""
MOST_ITERATIONS = 25
TOLERANCE = 1e-11
LONGEST_TURN = 0.3
"""Largest angle between tangents of consecutive points (rad)."""


class NoOrbit(NwGearError):
    """Newton's method found no periodic orbit."""

    def __init__(self, omega: float, residual: float) -> None:
        super().__init__(f"no periodic orbit found near omega = {omega:g}: residual {residual:.3g}")


@dataclass(frozen=True, eq=False)
class Orbit:
    """A periodic orbit.

    Attributes:
        omega: excitation frequency nu.
        coefficients: (2 H + 1,) a_0, then a_k, then b_k.
    """

    omega: float
    coefficients: Array

    @property
    def order(self) -> int:
        """H, the highest harmonic."""
        return (len(self.coefficients) - 1) // 2

    def amplitude(self, harmonic: int) -> float:
        """Return sqrt(a_k^2 + b_k^2); of harmonic 3 it is the amplitude alpha of the superharmonic."""
        k = harmonic
        return float(np.hypot(self.coefficients[k], self.coefficients[self.order + k]))

    def at(self, time: Array) -> Array:
        """Return the displacement at times (s of the dimensionless time)."""
        return basis(self.order, self.omega * np.asarray(time)) @ self.coefficients


def basis(order: int, angles: Array) -> Array:
    """Return 1, cos(k theta), sin(k theta) at angles (n,), as (n, 2 order + 1)."""
    k = np.arange(1, order + 1)
    turned = np.multiply.outer(angles, k)
    return np.concatenate([np.ones((len(angles), 1)), np.cos(turned), np.sin(turned)], axis=1)


class Balance:
    """Harmonic balance of one gear pair.

    Args:
        pair: its numbers.
        restoring: force per mass; the pair's own cubic by default.
        order: highest harmonic; samples: points of time per period, at least 4 order + 2.
    """

    def __init__(
        self, pair: GearPair, restoring: Restoring | None = None, order: int = HARMONICS, samples: int = SAMPLES
    ) -> None:
        self.pair = pair
        self.order = order
        self.restoring = restoring or Cubic(pair.w0**2, pair.eps * pair.q * pair.w0)
        self._samples = samples
        self._load = np.zeros(2 * order + 1)
        self._load[0], self._load[1] = pair.mean_force, pair.force

    def residual(self, coefficients: Array, omega: float) -> Array:
        """Return what the equation leaves in each harmonic, (2 H + 1,)."""
        spectrum = np.fft.rfft(self.restoring.force(self._in_time(coefficients)))[: self.order + 1] / self._samples
        force = np.concatenate([spectrum.real[:1], 2.0 * spectrum.real[1:], -2.0 * spectrum.imag[1:]])
        residual: Array = self._linear(omega) @ coefficients + force - self._load
        return residual

    def jacobian(self, coefficients: Array, omega: float) -> tuple[Array, Array]:
        """Return the derivatives of the residual by the coefficients, (2 H + 1, 2 H + 1), and by omega, (2 H + 1,)."""
        slope = self.restoring.stiffness(self._in_time(coefficients))
        by_coefficients = self._linear(omega) + self._of_stiffness(np.fft.rfft(slope) / self._samples)
        return by_coefficients, self._linear(omega, derivative=True) @ coefficients

    def solve(self, omega: float, start: Array | None = None) -> Orbit:
        """Find the orbit at one frequency by Newton's method.

        Args:
            omega: excitation frequency.
            start: coefficients to begin with; those of the linear motion by default.

        Raises:
            NoOrbit: the iteration doesn't converge.
        """
        if start is None:
            start = np.asarray(np.linalg.solve(self.jacobian(0.0 * self._load, omega)[0], self._load), dtype=float)
        z = np.array(start, dtype=float)
        for _ in range(MOST_ITERATIONS):
            residual = self.residual(z, omega)
            if np.max(np.abs(residual)) < TOLERANCE:
                return Orbit(omega, z)
            z = z - np.linalg.solve(self.jacobian(z, omega)[0], residual)
        raise NoOrbit(omega, float(np.max(np.abs(self.residual(z, omega)))))

    def follow(self, first: Orbit, until: float, step: float, most: int = 5000) -> Iterator[Orbit]:
        """Follow the branch by arclength from an orbit on, through folds, until a frequency is passed.

        Lengths are measured with the frequency in units of eps, in which the resonance is as wide as it is high.

        Args:
            first: where to begin; it comes out first.
            until: frequency at which the branch ends; it lies in the direction to go.
            step: longest step along the branch.
            most: points at most.

        Yields:
            orbits along the branch.
        """
        scale = self.pair.eps
        z = np.append(first.coefficients, first.omega / scale)
        direction = np.zeros_like(z)
        direction[-1] = np.sign(until - first.omega)
        tangent = self._tangent(z, scale, direction)
        length = step
        yield first
        for _ in range(most):
            found = self._correct(z + length * tangent, tangent, scale)
            turn = self._tangent(found, scale, tangent) if found is not None else None
            if found is None or turn is None or float(turn @ tangent) < np.cos(LONGEST_TURN):
                length *= 0.5
                if length < 1e-9 * step:
                    raise NoOrbit(float(z[-1] * scale), float("nan"))
                continue
            z, tangent = found, turn
            length = min(step, 1.5 * length)
            omega = float(z[-1] * scale)
            if (omega - until) * (first.omega - until) <= 0.0:
                return
            yield Orbit(omega, z[:-1])

    def _in_time(self, coefficients: Array) -> Array:
        """Return the displacement at the points of time of a period."""
        spectrum = np.zeros(self._samples // 2 + 1, dtype=complex)
        n = self.order
        spectrum[0] = self._samples * coefficients[0]
        spectrum[1 : n + 1] = 0.5 * self._samples * (coefficients[1 : n + 1] - 1j * coefficients[n + 1 :])
        return np.fft.irfft(spectrum, self._samples)

    def _of_stiffness(self, spectrum: Complex) -> Array:
        """Return the derivative of the force by the coefficients, from the Fourier coefficients S_m of the stiffness.

        The product of K(t) and cos(j theta) has in harmonic k the parts S_(k-j) and S_(k+j), and so on.
        """
        k = np.arange(self.order + 1)
        apart, together = k[:, None] - k[None, :], spectrum[k[:, None] + k[None, :]]
        difference = np.where(apart < 0, np.conj(spectrum[np.abs(apart)]), spectrum[np.abs(apart)])
        cosines = np.hstack([(together + difference).real, (difference - together).imag[:, 1:]])
        cosines[0] *= 0.5
        sines = np.hstack([-(together + difference).imag, (difference - together).real[:, 1:]])
        return np.vstack([cosines, sines[1:]])

    def _linear(self, omega: float, *, derivative: bool = False) -> Array:
        """Return the matrix of inertia, damping and feedback on the coefficients, or its derivative by omega."""
        p = self.pair
        k = np.arange(self.order + 1)
        s = 1j * k * omega
        delayed = p.g_d * np.exp(-s * p.tau_d), p.g_v * np.exp(-s * p.tau_v)
        if derivative:
            by_s = 2.0 * s + p.eps * (2.0 * p.c * p.zeta + p.tau_d * delayed[0] - (1.0 - s * p.tau_v) * delayed[1])
            entry = 1j * k * by_s
        else:
            entry = s**2 + p.eps * (2.0 * p.c * p.zeta * s - delayed[0] - s * delayed[1])
        n = self.order
        matrix = np.zeros((2 * n + 1, 2 * n + 1))
        matrix[: n + 1, : n + 1] = np.diag(entry.real)
        matrix[n + 1 :, n + 1 :] = np.diag(entry.real[1:])
        matrix[1 : n + 1, n + 1 :] = np.diag(entry.imag[1:])
        matrix[n + 1 :, 1 : n + 1] = -np.diag(entry.imag[1:])
        return matrix

    def _tangent(self, z: Array, scale: float, before: Array) -> Array:
        by_coefficients, by_omega = self.jacobian(z[:-1], float(z[-1] * scale))
        system = np.vstack([np.column_stack([by_coefficients, scale * by_omega]), before])
        right = np.zeros(len(z))
        right[-1] = 1.0
        tangent = np.linalg.solve(system, right)
        return tangent / float(np.linalg.norm(tangent))

    def _correct(self, guess: Array, tangent: Array, scale: float) -> Array | None:
        """Return the point of the branch in the plane across the tangent through the guess, or None."""
        z = guess.copy()
        for _ in range(8):
            omega = float(z[-1] * scale)
            residual = np.append(self.residual(z[:-1], omega), tangent @ (z - guess))
            if np.max(np.abs(residual)) < TOLERANCE:
                return z
            by_coefficients, by_omega = self.jacobian(z[:-1], omega)
            z -= np.linalg.solve(np.vstack([np.column_stack([by_coefficients, scale * by_omega]), tangent]), residual)
            if not np.isfinite(z).all():
                return None
        return None
