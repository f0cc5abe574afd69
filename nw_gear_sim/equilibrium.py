"""Static equilibrium: where the gearbox rests under its load, with the speed only setting phases and friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from nw_gear_common.errors import NwGearError
from nw_gear_common.tables import Array
from nw_gear_sim.elements import closed_stiffness
from nw_gear_sim.gearbox import Gearbox

TOLERANCE = 1e-5
"""Largest residual force accepted, N."""
MOST_ITERATIONS = 300
DOUBTFUL = 80
"""Iterations after which it is asked whether anything holds the gearbox at all; at any load it took fewer."""
BACK = 0.9
"""A step is too long where this share of the driving force points back at its end."""
STIFFNESS_ADDED = 1e8
"""Stiffness to the last position with which the search begins, N/m; it fades."""
LEAST_ADDED, MOST_ADDED = 1e4, 1e14
"""Where it starts to grow again, and where growing is given up, N/m."""
ROUNDING = 1e-9
"""Share of the largest stiffness within which an eigenvalue counts as zero."""
FARTHEST = 0.1
"""A displacement beyond this (m) is none of the small motions that the equations are for."""


class NoEquilibrium(NwGearError):
    """The search for the static equilibrium didn't get there, or it isn't one that anything could rest in."""

    exit_code = 2


@dataclass(frozen=True)
class Equilibrium:
    """What `find_equilibrium` found: displacements q (m), largest residual (N), Newton iterations."""

    q: Array
    residual: float
    iterations: int


def find_equilibrium(
    gearbox: Gearbox, torque: float, *, speed: float = 0.0, angle: float = 0.0, guess: Array | None = None
) -> Equilibrium:
    """Find q with no force left on any motion.

    Args:
        gearbox: its laws.
        torque: input torque, N m.
        speed: of the ring, rad/s; it sets the friction, inertia and damping don't act.
        angle: of the ring, rad.
        guess: displacements near the ones wanted, m; none: zero.

    Newton's method on the potential energy, which is convex (gaps, rollers and springs only ever stiffen), up to the
    friction. Gaps and unloaded rollers leave the stiffness matrix singular, so that a stiffness to the last position is
    added. It fades, unless a step goes so far that the force at its end points back: then it is taken again with more.
    Once within TOLERANCE, one last step without it takes the residual down to rounding.

    Raises:
        NoEquilibrium: the largest residual stays above TOLERANCE, the displacements leave +-FARTHEST, or the stiffness
            there isn't definite; the motion that nothing holds, or that ran away, is named.
    """
    gearbox.set_instant(torque, speed, angle, static=True)
    rest = np.zeros(gearbox.layout.size)
    q = rest.copy() if guess is None else guess.copy()
    added, iterations = STIFFNESS_ADDED if guess is None else LEAST_ADDED, 0
    force = gearbox.forces(q, rest)
    while not _largest(force) <= TOLERANCE:
        hopeless = not np.all(np.isfinite(force)) or _largest(q) > 100 * FARTHEST
        if hopeless or iterations == MOST_ITERATIONS or (iterations == DOUBTFUL and free_motions(gearbox)):
            raise _not_found(gearbox, q, force, torque)
        iterations += 1
        stiffness = gearbox.stiffness(q)
        while True:
            step = _solve(stiffness + added * np.eye(len(q)), force)
            after = gearbox.forces(q + step, rest)
            if after @ step > -BACK * (force @ step) or added > MOST_ADDED:
                break
            added = 10 * max(added, LEAST_ADDED)
        q, force, added = q + step, after, added / 10
    better = q + _solve(gearbox.stiffness(q) + added * np.eye(len(q)), force)
    after = gearbox.forces(better, rest)
    if _largest(after) < _largest(force):
        q, force = better, after
    if _largest(q) > FARTHEST:
        raise _not_found(gearbox, q, force, torque)
    check_stiffness(gearbox, q)
    return Equilibrium(q, _largest(force), iterations)


def check_stiffness(gearbox: Gearbox, q: Array) -> None:
    """Make sure that the gearbox can rest at displacements q (m), at the instant set in it.

    K is definite where all eigenvalues of M^-1 K lie right of zero. Those at zero are free motions: gaps at no load,
    or a ring that turns freely. Friction makes K asymmetric; as long as its symmetric part is definite, so is K.

    Raises:
        NoEquilibrium: an eigenvalue has a negative real part; the motion that would run away is named.
    """
    scale = 1 / np.sqrt(gearbox.mass)
    stiffness = gearbox.stiffness(q) * np.outer(scale, scale)
    symmetric = 0.5 * (stiffness + stiffness.T)
    zero = ROUNDING * float(np.max(np.abs(np.diag(symmetric))))
    try:
        scipy.linalg.cholesky(symmetric + zero * np.eye(len(q)), check_finite=False, overwrite_a=True)
    except scipy.linalg.LinAlgError:
        values, vectors = scipy.linalg.eig(stiffness, check_finite=False)
        worst = int(np.argmin(values.real))
        if values.real[worst] < -zero:
            motion = _leading(gearbox, vectors[:, worst] * scale)
            growth = f"{np.sqrt(-values.real[worst]):.3g} 1/s"
            raise NoEquilibrium(
                f"the stiffness at the equilibrium isn't positive definite: {motion} would run away at {growth}"
            ) from None


def free_motions(gearbox: Gearbox) -> list[str]:
    """Name the motions that nothing holds, even with all flanks and rollers in contact."""
    scale = 1 / np.sqrt(gearbox.mass)
    values, vectors = scipy.linalg.eigh(closed_stiffness(gearbox) * np.outer(scale, scale), check_finite=False)
    loose = np.flatnonzero(values < ROUNDING * float(values[-1]))
    return list(dict.fromkeys(_leading(gearbox, vectors[:, k] * scale) for k in loose))


def _leading(gearbox: Gearbox, vector: Array) -> str:
    """Name the motion with most of the kinetic energy."""
    return gearbox.layout.name(int(np.argmax(gearbox.mass * np.abs(vector) ** 2)))


def _solve(matrix: Array, force: Array) -> Array:
    return np.asarray(scipy.linalg.solve(matrix, force, check_finite=False))


def _not_found(gearbox: Gearbox, q: Array, force: Array, torque: float) -> NoEquilibrium:
    text = f"no static equilibrium at {torque:g} N m: "
    loose = free_motions(gearbox)
    if loose:
        more = f" and {len(loose) - 3} more" if len(loose) > 3 else ""
        return NoEquilibrium(f"{text}nothing holds the motion {', '.join(loose[:3])}{more}")
    far = int(np.argmax(np.abs(q)))
    if abs(q[far]) > FARTHEST:
        return NoEquilibrium(
            f"{text}{gearbox.layout.name(far)} gives way to {q[far]:.3g} m, {FARTHEST:g} m is the most"
        )
    return NoEquilibrium(f"{text}{_largest(force):.3g} N left on {gearbox.layout.name(int(np.argmax(np.abs(force))))}")


def _largest(force: Array) -> float:
    return float(np.max(np.abs(force)))
