"""Generalised forces as forces and moments on bodies in space, and gearboxes with a single element left."""

import math

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.kinematics import PLANET_ANGLES

CLOCKWISE = ("s", "h1")
BASE = {"p1": "planet_1", "p2": "planet_2", "s": "sun", "h1": "herringbone_1", "h2": "herringbone_2"}


def place_of(gearbox: Gearbox, node: str) -> Array:
    """Where the axis of a gear or bearing stands, (2,)."""
    stages = gearbox.kinematics.stages
    if node[:2] in ("p1", "p2", "pb"):
        angle = PLANET_ANGLES[int(node[-1]) - 1]
        return stages[1].pair.centre_distance * np.array([math.cos(angle), math.sin(angle)])
    return np.array([stages[2].pair.centre_distance if node in ("h2", "b21", "b22") else 0.0, 0.0])


def wrench(gearbox: Gearbox, force: Array, angle: float) -> tuple[Array, float]:
    """Sum of all generalised forces as a force (3,), N, and a moment about the gearbox axis, N m.

    The moment on a gear is its force on u times the base radius in its own sense; that on a ring segment is the force
    on p times the base radius, and its forces act at its centroid.
    """
    layout, kinematics = gearbox.layout, gearbox.kinematics
    bodies = kinematics.bodies
    total, moment = np.zeros(3), 0.0
    for name, node in layout.nodes.items():
        here = np.array([force[k] if k >= 0 else 0.0 for k in (node.x, node.y, node.z)])
        x, y = place_of(gearbox, name)
        total += here
        moment += x * here[1] - y * here[0]
        if node.u >= 0:
            base = getattr(bodies, BASE[name.split("_")[0]]).base_radius
            moment += force[node.u] * base * (-1 if name in CLOCKWISE else 1)
    at = angle + kinematics.ring.pitch * np.arange(layout.segments)
    w, v, p, z = (force[layout.ring(motion)] for motion in "wvpz")
    total += [np.sum(w * np.cos(at) - v * np.sin(at)), np.sum(w * np.sin(at) + v * np.cos(at)), np.sum(z)]
    return total, float(moment + np.sum(v) * kinematics.ring.radius + np.sum(p) * bodies.ring.base_radius)


def with_nothing_but(gearbox: Gearbox, **laws: object) -> None:
    """Take all laws out of a gearbox besides those given (mesh, springs, ring, bearings, weight)."""
    own = gearbox.laws
    ring, springs, bearings, mesh = own.ring, own.springs, own.bearings, own.mesh
    nothing = {
        "ring": ring._replace(
            own=0 * ring.own, next=0 * ring.next, axial=0.0, radial_support=0.0, axial_support=0.0,
            radial_damping=0.0, axial_damping=0.0, weight=0.0,
        ),
        "springs": springs._replace(aa=0 * springs.aa, ab=0 * springs.ab, bb=0 * springs.bb),
        "bearings": bearings._replace(stiffness=0 * bearings.stiffness, damping=0 * bearings.damping),
        "mesh": mesh._replace(
            stiffness=0 * mesh.stiffness, stiffness_cos=0 * mesh.stiffness, stiffness_sin=0 * mesh.stiffness,
            damping=0 * mesh.damping,
        ),
        "weight": 0 * own.weight,
    }  # fmt: skip
    gearbox.laws = own._replace(**(nothing | laws))


def only(values: Array, k: int) -> Array:
    """An array with all entries but one set to zero."""
    return np.where(np.arange(len(values)) == k, values, 0.0)
