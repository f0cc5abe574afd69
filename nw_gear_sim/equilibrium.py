"""Static equilibrium: where the gearbox rests under its load, with the speed only setting phases and friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from nw_gear_common.errors import NwGearError
from nw_gear_common.tables import Array
from nw_gear_sim.gearbox import Gearbox

TOLERANCE = 1e-5
"""Largest residual force accepted, N."""
MOST_ITERATIONS = 300
BACK = 0.9
"""A step is too long where this share of the driving force points back at its end."""
STIFFNESS_ADDED = 1e8
"""Stiffness to the last position with which the search begins, N/m; it fades."""
LEAST_ADDED, MOST_ADDED = 1e4, 1e14
"""Where it starts to grow again, and where growing is given up, N/m."""


class NoEquilibrium(NwGearError):
    """The search for the static equilibrium didn't get there."""


@dataclass(frozen=True)
class Equilibrium:
    """What `find_equilibrium` found: displacements q (m), largest residual (N), Newton iterations."""

    q: Array
    residual: float
    iterations: int


def find_equilibrium(gearbox: Gearbox, torque: float, *, speed: float = 0.0, angle: float = 0.0) -> Equilibrium:
    """Find q with no force left on any motion.

    Args:
        gearbox: its laws.
        torque: input torque, N m.
        speed: of the ring, rad/s; it sets the friction, inertia and damping don't act.
        angle: of the ring, rad.

    Newton's method on the potential energy, which is convex (gaps, rollers and springs only ever stiffen), up to the
    friction. Gaps and unloaded rollers leave the stiffness matrix singular, so that a stiffness to the last position is
    added. It fades, unless a step goes so far that the force at its end points back: then it is taken again with more.

    Raises:
        NoEquilibrium: the largest residual stays above TOLERANCE.
    """
    gearbox.set_instant(torque, speed, angle, static=True)
    rest = np.zeros(gearbox.layout.size)
    q, added, iterations = rest.copy(), STIFFNESS_ADDED, 0
    force = gearbox.forces(q, rest)
    while _largest(force) > TOLERANCE:
        if iterations == MOST_ITERATIONS:
            left = f"{_largest(force):.3g} N left after {iterations} iterations"
            raise NoEquilibrium(f"no static equilibrium found at {torque:g} N m: {left}")
        iterations += 1
        stiffness = gearbox.stiffness(q)
        while True:
            step = scipy.linalg.solve(stiffness + added * np.eye(len(q)), force, check_finite=False)
            after = gearbox.forces(q + step, rest)
            if after @ step > -BACK * (force @ step) or added > MOST_ADDED:
                break
            added = 10 * max(added, LEAST_ADDED)
        q, force, added = q + step, after, added / 10
    return Equilibrium(q, _largest(force), iterations)


def _largest(force: Array) -> float:
    return float(np.max(np.abs(force)))
