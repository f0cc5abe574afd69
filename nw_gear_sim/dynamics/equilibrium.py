"""Static equilibrium at a given torque and ring angle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nw_gear_common.errors import NwGearError
from nw_gear_common.tables import Array
from nw_gear_sim.dynamics.constants import Constants
from nw_gear_sim.dynamics.model import OBSERVED, accelerations, work_size

TOLERANCE = 1e-2
"""Largest force (N) that may be left on any motion."""
MAX_STEPS = 200
_PERTURBATION = 1e-9


@dataclass(frozen=True)
class Equilibrium:
    """A state of rest.

    Attributes:
        q: displacements (m), shape (n,).
        observed: mesh and bearing observations there.
        residual: largest force left over (N).
    """

    q: Array
    observed: Array
    residual: float


class NoEquilibrium(NwGearError):
    """Newton's method did not come to rest."""


def forces(c: Constants, tables: Array, q: Array, angle: float, torque: float) -> tuple[Array, Array]:
    """Force on every motion (N) at rest, and the observations."""
    observed, result = np.empty(OBSERVED), np.empty(len(q))
    work = np.empty(work_size(int(c.ring[0]["segments"])))
    accelerations(c, tables, q, np.zeros_like(q), angle, 0.0, torque, work, observed, result)
    return result * c.mass, observed


def stiffness(c: Constants, tables: Array, q: Array, angle: float, torque: float) -> Array:
    """Tangent stiffness -dF/dq by central differences, shape (n, n), N/m."""
    matrix = np.empty((len(q), len(q)))
    for i in range(len(q)):
        ends = []
        for sign in (1.0, -1.0):
            moved = q.copy()
            moved[i] += sign * _PERTURBATION
            ends.append(forces(c, tables, moved, angle, torque)[0])
        matrix[:, i] = (ends[1] - ends[0]) / (2 * _PERTURBATION)
    return matrix


def find(c: Constants, tables: Array, angle: float, torque: float, start: Array | None = None) -> Equilibrium:
    """Find the equilibrium by Newton's method, regularised by inertia (pseudo-transient continuation).

    The stiffness is singular while gaps and bearings are open; adding mass / tau^2 keeps every motion bounded, and tau
    grows as the residual falls. Friction enters with the tables' speed although nothing moves: the state about which
    the running gearbox vibrates.

    Raises:
        NoEquilibrium: the residual did not come under TOLERANCE.
    """
    q = np.zeros(len(c.mass)) if start is None else start.copy()
    inertia, shift = np.diag(c.mass), 1e6
    force, observed = forces(c, tables, q, angle, torque)
    for _ in range(MAX_STEPS):
        residual = float(np.abs(force).max())
        if residual < TOLERANCE:
            return Equilibrium(q, observed, residual)
        change = np.linalg.solve(stiffness(c, tables, q, angle, torque) + shift * inertia, force)
        trial_force, trial_observed = forces(c, tables, q + change, angle, torque)
        if np.linalg.norm(trial_force) < 2.0 * np.linalg.norm(force):
            q = q + change
            force, observed = trial_force, trial_observed
            shift *= 0.3
        else:
            shift *= 10.0
    raise NoEquilibrium(f"no static equilibrium: {residual:.3g} N left after {MAX_STEPS} steps, torque {torque:.6g} N m")
