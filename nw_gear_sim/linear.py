"""The gearbox linearised about a state at rest: stiffness, damping, eigenvalues, shapes, bound of the time step.

M x'' + C x' + K x = 0 is solved as a first-order system of twice the size, by the dense QR algorithm: K isn't
symmetric where the flanks rub, and C isn't proportional to M and K. `lowest_modes` solves it in the space of the lowest
undamped modes instead, which is much faster and exact up to what the damping couples to the modes left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.linalg

from nw_gear_common.tables import Array
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.integrator.rk4 import largest_stable_step

BASIS = 160
"""Least number of undamped modes in which the lowest modes are sought; the generator's damping couples so many."""

Complex = npt.NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Linearised:
    """Small motions about a state at rest.

    Attributes:
        mass: kg, shape (dof,); stiffness: N/m, damping: N s/m, shape (dof, dof).
    """

    mass: Array
    stiffness: Array
    damping: Array


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of the linearised gearbox.

    Attributes:
        eigenvalues: all of them, 1/s, shape (2 dof,).
        frequencies_hz: |lambda| / 2 pi of the oscillatory pairs, ascending.
        damping_ratio: -Re lambda / |lambda| of the same pairs.
        largest_eigenvalue: the largest |lambda|, rad/s.
        largest_stable_step: of the classical Runge-Kutta method, s.
    """

    eigenvalues: Complex
    frequencies_hz: Array
    damping_ratio: Array
    largest_eigenvalue: float
    largest_stable_step: float


@dataclass(frozen=True, eq=False)
class Shapes:
    """Oscillatory pairs with their shapes, ascending by frequency.

    Attributes:
        eigenvalues: those with positive imaginary part, 1/s, (pairs,).
        vectors: displacements, (dof, pairs), 1/sqrt(kg); x(t) = Re(vector exp(lambda t)). Each has modal mass 1 kg,
            sum m |vector|^2 = 1, and the phase at which its imaginary part is smallest, the largest entry positive.
    """

    eigenvalues: Complex
    vectors: Complex

    @property
    def frequencies_hz(self) -> Array:
        """|lambda| / 2 pi."""
        return np.abs(self.eigenvalues) / (2 * math.pi)

    @property
    def damping_ratio(self) -> Array:
        """-Re lambda / |lambda|."""
        return -self.eigenvalues.real / np.abs(self.eigenvalues)

    def first(self, count: int) -> Shapes:
        """Return the lowest pairs alone."""
        return Shapes(self.eigenvalues[:count], self.vectors[:, :count])


def linearise(gearbox: Gearbox, q: Array) -> Linearised:
    """Linearise at displacements q (m) at rest, at the instant set in the gearbox.

    The gaps of meshes and bearings are taken as they are at q: contacts that close or open in a motion aren't seen.
    """
    return Linearised(gearbox.mass, gearbox.stiffness(q), gearbox.damping(q))


def find_modes(gearbox: Gearbox, q: Array) -> Modes:
    """Find all eigenvalues of the gearbox linearised at displacements q (m); see `linearise`."""
    return _modes(scipy.linalg.eigvals(_system(linearise(gearbox, q)), check_finite=False, overwrite_a=True))


def find_shapes(linear: Linearised) -> tuple[Modes, Shapes]:
    """Find all eigenvalues and the shapes of all oscillatory pairs."""
    eigenvalues, vectors = scipy.linalg.eig(_system(linear), check_finite=False, overwrite_a=True)
    pairs = _pairs(eigenvalues)
    shapes = vectors[: len(linear.mass), pairs] / np.sqrt(linear.mass)[:, None]
    return _modes(eigenvalues), Shapes(eigenvalues[pairs], _normalised(shapes, linear.mass))


def lowest_modes(linear: Linearised, count: int, basis: int | None = None) -> Shapes:
    """Find the lowest `count` oscillatory pairs in the space of the lowest undamped modes.

    Args:
        linear: the linearised gearbox; the undamped modes are those of the symmetric part of its stiffness.
        count: pairs wanted.
        basis: undamped modes taken, at least BASIS if not given; with all of them the result is exact. With 160 the
            lowest 40 are good to about 1e-5 (measured at rated torque, a quarter and a fortieth of it).
    """
    size = len(linear.mass)
    taken = min(max(BASIS, 3 * count) if basis is None else basis, size)
    scale = 1 / np.sqrt(linear.mass)
    stiffness, damping = (matrix * np.outer(scale, scale) for matrix in (linear.stiffness, linear.damping))
    symmetric = 0.5 * (stiffness + stiffness.T)
    _, space = scipy.linalg.eigh(symmetric, subset_by_index=(0, taken - 1), check_finite=False, driver="evr")
    reduced = _first_order(space.T @ stiffness @ space, space.T @ damping @ space)
    eigenvalues, vectors = scipy.linalg.eig(reduced, check_finite=False, overwrite_a=True)
    pairs = _pairs(eigenvalues)[:count]
    shapes = scale[:, None] * (space @ vectors[:taken, pairs])
    return Shapes(eigenvalues[pairs], _normalised(shapes, linear.mass))


def _system(linear: Linearised) -> Array:
    scale = 1 / np.sqrt(linear.mass)
    return _first_order(linear.stiffness * np.outer(scale, scale), linear.damping * np.outer(scale, scale))


def _first_order(stiffness: Array, damping: Array) -> Array:
    size = len(stiffness)
    system = np.zeros((2 * size, 2 * size), order="F")
    system[:size, size:] = np.eye(size)
    system[size:, :size] = -stiffness
    system[size:, size:] = -damping
    return system


def _pairs(eigenvalues: Complex) -> npt.NDArray[np.int64]:
    """Indices of the oscillatory pairs, ascending by |lambda|."""
    found = np.flatnonzero(eigenvalues.imag > 0)
    return found[np.argsort(np.abs(eigenvalues[found]), kind="stable")]


def _modes(eigenvalues: Complex) -> Modes:
    pairs = eigenvalues[_pairs(eigenvalues)]
    return Modes(
        eigenvalues=eigenvalues,
        frequencies_hz=np.abs(pairs) / (2 * math.pi),
        damping_ratio=-pairs.real / np.abs(pairs),
        largest_eigenvalue=float(np.max(np.abs(eigenvalues))),
        largest_stable_step=largest_stable_step(eigenvalues),
    )


def _normalised(vectors: Complex, mass: Array) -> Complex:
    """Turn each column so that sum m x^2 is real and positive, and scale it to sum m |x|^2 = 1."""
    square = np.sum(mass[:, None] * vectors**2, axis=0)
    turned = vectors * np.exp(-0.5j * np.angle(square))
    turned /= np.sqrt(np.sum(mass[:, None] * np.abs(turned) ** 2, axis=0))
    largest = np.argmax(np.abs(turned), axis=0)
    return np.asarray(turned * np.where(turned[largest, np.arange(turned.shape[1])].real < 0, -1.0, 1.0))
