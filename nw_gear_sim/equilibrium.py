"""Static equilibrium: where the gearbox rests under its load, with the speed only setting phases and friction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from nw_gear_common.errors import NwGearError
from nw_gear_common.tables import Array
from nw_gear_sim.gearbox import Gearbox

TOLERANCE = 1e-3
"""Largest residual force accepted, N."""
MOST_ITERATIONS = 200
DIFFERENCE = 1e-9
"""Step of the difference quotients, m."""
STIFFNESS_ADDED = 1e8
"""Stiffness to the last position with which the search begins, N/m; it fades as the residual falls."""


class NoEquilibrium(NwGearError):
    """The search for the static equilibrium didn't get there."""


@dataclass(frozen=True)
class Equilibrium:
    """What `find_equilibrium` found: displacements q (m), largest residual (N), Newton iterations."""

    q: Array
    residual: float
    iterations: int


def stiffness_matrix(forces: Callable[[Array], Array], q: Array, step: float = DIFFERENCE) -> Array:
    """Return -d(forces)/dq (N/m) by central differences, shape (dof, dof)."""
    matrix = np.empty((len(q), len(q)))
    shifted = q.copy()
    for k in range(len(q)):
        shifted[k] = q[k] + step
        above = forces(shifted)
        shifted[k] = q[k] - step
        matrix[:, k] = (forces(shifted) - above) / (2 * step)
        shifted[k] = q[k]
    return matrix


def find_equilibrium(gearbox: Gearbox, torque: float, *, speed: float = 0.0, angle: float = 0.0) -> Equilibrium:
    """Find q with no force left on any motion.

    Args:
        gearbox: its laws.
        torque: input torque, N m.
        speed: of the ring, rad/s; it sets the friction, inertia and damping don't act.
        angle: of the ring, rad.

    Newton's method with a fading stiffness to the last position, since gaps and unloaded rollers leave the stiffness
    matrix singular; a step that makes the residual worse is repeated with more of it.

    Raises:
        NoEquilibrium: the largest residual stays above TOLERANCE.
    """
    gearbox.set_instant(torque, speed, angle, static=True)
    rest = np.zeros(gearbox.layout.size)

    def forces(q: Array) -> Array:
        return gearbox.forces(q, rest)

    q = rest.copy()
    residual = forces(q)
    added = STIFFNESS_ADDED
    size = float(np.max(np.abs(residual)))
    iteration = 0
    best = size
    while best > TOLERANCE and iteration < MOST_ITERATIONS:
        iteration += 1
        matrix = stiffness_matrix(forces, q)
        for _ in range(12):
            step = scipy.linalg.solve(matrix + added * np.eye(len(q)), residual, assume_a="gen")
            trial = forces(q + step)
            size = float(np.max(np.abs(trial)))
            if size < 2 * best:
                break
            added *= 10
        q = q + step
        residual = trial
        best = size
        added = max(added / 10, 1e-3)
    if best > TOLERANCE:
        raise NoEquilibrium(f"no static equilibrium found: {best:.3g} N left after {iteration} iterations")
    return Equilibrium(q, best, iteration)
