"""The largest step at which an integrator stays stable, from the configuration's own eigenvalues.

The model is linearised at rest in its stiffest state: under the larger of the load at hand and rated load, with every
mesh at its largest stiffness. Contacts that open only make it softer.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import scipy.linalg
import scipy.sparse.linalg

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.integrator.rk4 import largest_stable_step
from nw_gear_sim.solvers import Modal, Solver

GROWTH = 1e-6
"""Growth in a step that still counts as none: friction may feed a motion slowly, and rounding splits double roots."""
FASTEST = 40
"""Eigenvalues of largest magnitude that decide about the classical Runge-Kutta method."""
HALVINGS = 8
"""Halvings of the interval in which the bound of a modal solver lies: it is found to 1/256 of the step."""


def check_step(solver: Solver, gearbox: Gearbox, step: float, torque: float, speed: float) -> None:
    """Refuse a step beyond the bound.

    Args:
        solver: what integrates, with steps of `step` s.
        gearbox: the whole model.
        torque, speed: the largest load, N m, and the ring's speed there, rad/s; they set the state looked at.

    Raises:
        InputError: the step is too long; the message says how long it may be.
        NoEquilibrium: there is no equilibrium under the load.
    """
    q = find_equilibrium(gearbox, torque, speed=speed).q
    if isinstance(solver, Modal):
        bound = _modal_bound(solver, q, step)
    else:
        bound = largest_stable_step(fastest_eigenvalues(gearbox, q))
    if step > bound:
        digits = 10.0 ** (math.floor(math.log10(bound)) - 2)
        expected = f"at most {math.floor(bound / digits) * digits:.3g} s, where {solver.name} gets unstable"
        raise InputError("numerics.step", expected, f"{step:g} s")


def fastest_eigenvalues(gearbox: Gearbox, q: Array) -> npt.NDArray[np.complex128]:
    """Return the eigenvalues (1/s) of largest magnitude at q (m) with the stiffest meshes, else at the instant set."""
    law = gearbox.laws.mesh
    gearbox.instants.excitation[0, :, 0] = law.stiffness + np.hypot(law.stiffness_cos, law.stiffness_sin)
    scale = 1 / np.sqrt(gearbox.mass)
    stiffness = gearbox.stiffness(q) * np.outer(scale, scale)
    damping = gearbox.damping(q) * np.outer(scale, scale)
    size = len(q)
    rate = math.sqrt(float(np.max(np.diag(stiffness))))  # makes both halves of the state alike in size

    def apply(z: Array) -> Array:
        return np.concatenate([rate * z[size:], -(stiffness @ z[:size]) / rate - damping @ z[size:]])

    system = scipy.sparse.linalg.LinearOperator((2 * size, 2 * size), matvec=apply, dtype=np.float64)
    start = np.random.default_rng(0).standard_normal(2 * size)
    found = scipy.sparse.linalg.eigs(system, k=FASTEST, which="LM", v0=start, return_eigenvectors=False)
    return np.asarray(found, dtype=np.complex128)


def _modal_bound(solver: Modal, q: Array, step: float) -> float:
    """Return `step` where that is stable, otherwise the largest stable one below.

    What grows at steps of any length is the gearbox's own motion, not the integrator's: then the step counts as stable.
    """
    stiffness, damping = solver.stiffest_tangent(q)
    laws, method = solver.laws, solver.method

    def stable(h: float) -> bool:
        matrix = method.step_matrix(method.coefficients(laws.square, laws.damping, h), stiffness, damping)
        return float(np.max(np.abs(scipy.linalg.eigvals(matrix, check_finite=False)))) <= 1.0 + GROWTH

    low, high = step / 2.0**HALVINGS, step
    if stable(high) or not stable(low):
        return step
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low
