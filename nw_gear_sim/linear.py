"""The gearbox linearised about a state at rest: stiffness, damping, eigenvalues, bound of the time step."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.linalg

from nw_gear_common.tables import Array
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.integrator.rk4 import largest_stable_step


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

    eigenvalues: npt.NDArray[np.complex128]
    frequencies_hz: Array
    damping_ratio: Array
    largest_eigenvalue: float
    largest_stable_step: float


def find_modes(gearbox: Gearbox, q: Array) -> Modes:
    """Linearise at displacements q (m) at rest, at the instant set in the gearbox.

    M x'' + C x' + K x = 0 as a first-order system of twice the size. The gaps of meshes and bearings are taken as they
    are at q: contacts that close or open in a motion aren't seen.
    """
    dof = gearbox.layout.size
    scale = 1 / np.sqrt(gearbox.mass)
    stiffness = gearbox.stiffness(q) * np.outer(scale, scale)
    damping = gearbox.damping(q) * np.outer(scale, scale)
    system = np.block([[np.zeros((dof, dof)), np.eye(dof)], [-stiffness, -damping]])
    eigenvalues = scipy.linalg.eigvals(system, check_finite=False)
    pairs = eigenvalues[eigenvalues.imag > 0]
    pairs = pairs[np.argsort(np.abs(pairs))]
    return Modes(
        eigenvalues=eigenvalues,
        frequencies_hz=np.abs(pairs) / (2 * math.pi),
        damping_ratio=-pairs.real / np.abs(pairs),
        largest_eigenvalue=float(np.max(np.abs(eigenvalues))),
        largest_stable_step=largest_stable_step(eigenvalues),
    )
