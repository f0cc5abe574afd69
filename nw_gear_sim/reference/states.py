"""Gearboxes with some values changed, and states in which to look at them."""

import math

import numpy as np

from nw_gear_common import names
from nw_gear_sim.config import load, with_values
from nw_gear_sim.reference.model import Instant, ReferenceModel

CONFIGURATION = load()
SMOOTH = {f"mesh.{stage}.error_amplitude": 0.0 for stage in names.STAGES}
RATED = 4.3e6


def model(**values: object) -> ReferenceModel:
    """Return the default gearbox with some values changed; `__` stands for the dot of a key."""
    return ReferenceModel(with_values({key.replace("__", "."): value for key, value in values.items()}, CONFIGURATION))


def at_rest(reference: ReferenceModel) -> dict[str, float]:
    """Return all coordinates, zero."""
    return dict.fromkeys(reference.masses, 0.0)


def turned_together(reference: ReferenceModel, rotation: float) -> dict[str, float]:
    """The ring turned by an angle, and every gear by what its teeth demand."""
    q, bodies, ring = at_rest(reference), reference.kinematics.bodies, reference.ring
    for i in range(ring.count):
        q[f"ring.v.{i}"], q[f"ring.psi.{i}"] = ring.radius * rotation, rotation
    u = bodies.ring.base_radius * rotation
    q |= {f"p1_{j}.u": u for j in (1, 2, 3)}
    u *= bodies.planet_2.base_radius / bodies.planet_1.base_radius
    q |= {f"p2_{j}.u": u for j in (1, 2, 3)} | {"s.u": u}
    u *= bodies.herringbone_1.base_radius / bodies.sun.base_radius
    return q | {"h1.u": u, "h2.u": u}


def shifted_together(
    reference: ReferenceModel, shift: np.ndarray, now: Instant
) -> tuple[dict[str, float], dict[str, float]]:
    """The whole gearbox moved without turning, at rest there: coordinates, and rates in the ring's turning frame."""
    q, v = at_rest(reference), at_rest(reference)
    for name in q:
        if name.split(".")[1] in "xyz" and not name.startswith("ring"):
            q[name] = float(shift["xyz".index(name[-1])])
    for i in range(reference.ring.count):
        angle = now.angle.real + i * reference.ring.pitch
        outward = shift[0] * math.cos(angle) + shift[1] * math.sin(angle)
        along = shift[1] * math.cos(angle) - shift[0] * math.sin(angle)
        q[f"ring.w.{i}"], q[f"ring.v.{i}"], q[f"ring.z.{i}"] = outward, along, float(shift[2])
        v[f"ring.w.{i}"], v[f"ring.v.{i}"] = along * now.speed, -outward * now.speed
    return q, v


def random_state(reference: ReferenceModel, seed: int, size: float = 3e-4) -> tuple[dict[str, float], dict[str, float]]:
    """Displacements of a few backlashes and rates of vibration; both flanks and open bearings occur."""
    rng = np.random.default_rng(seed)
    q = {name: size * rng.standard_normal() for name in reference.masses}
    return q, {name: 30 * size * rng.standard_normal() for name in reference.masses}
