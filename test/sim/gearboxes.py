"""Gearboxes at rated torque and speed for tests, and an energy that is computed without the simulator's kernels."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.config import load, with_values
from nw_gear_sim.equilibrium import Equilibrium, find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.kinematics import bearing_kind

RATED_SPEED = 17.3 * 2 * math.pi / 60
RATED_TORQUE = 4.3e6
BEARINGS = load().bearings
WITHOUT_FRICTION = (("friction.enabled", False),)
WITHOUT_LOSSES = (
    *WITHOUT_FRICTION,
    *((f"mesh.{stage}.damping_ratio", 0.0) for stage in ("I", "II", "III")),
    *((f"bearings.{kind}.damping", 0.0) for kind in ("pb1", "pb2", "sb", "b1", "b21", "b22")),
    *((f"{part}.damping_time", 0.0) for part in ("shafts", "torsion", "generator")),
    ("ring.joint_damping_time", 0.0),
    ("ring.support_damping_ratio", 0.0),
)


def make(*values: tuple[str, object], excitation: str = "kinematic") -> Gearbox:
    """A gearbox with some values of the configuration replaced."""
    return Gearbox(with_values(dict(values), load()), excitation)


@cache
def _found(*values: tuple[str, object]) -> Equilibrium:
    return find_equilibrium(make(*values), RATED_TORQUE, speed=RATED_SPEED)


def at_rest(*values: tuple[str, object]) -> tuple[Gearbox, Equilibrium]:
    """A new gearbox in static equilibrium at rated torque and speed, its instant set there."""
    gearbox, found = make(*values), _found(*values)
    gearbox.set_instant(RATED_TORQUE, RATED_SPEED, static=True)
    gearbox.forces(found.q, np.zeros_like(found.q))
    return gearbox, found


def rigid_rotation(gearbox: Gearbox) -> Array:
    """Motions of all parts where the ring turns by 1 rad and nothing deforms."""
    kinematics, layout = gearbox.kinematics, gearbox.layout
    bodies, ratio = kinematics.bodies, kinematics.shaft_ratio
    q = np.zeros(layout.size)
    q[layout.ring("v")] = kinematics.ring.radius
    q[layout.ring("p")] = bodies.ring.base_radius
    for j in range(3):
        q[layout.planet("p1", j).u] = bodies.planet_1.base_radius * ratio["planet"]
        q[layout.planet("p2", j).u] = bodies.planet_2.base_radius * ratio["planet"]
    q[layout.nodes["s"].u] = bodies.sun.base_radius * ratio["sun"]
    q[layout.nodes["h1"].u] = bodies.herringbone_1.base_radius * ratio["sun"]
    q[layout.nodes["h2"].u] = bodies.herringbone_2.base_radius * ratio["output"]
    return q


def translation(gearbox: Gearbox, axis: str, angle: float) -> Array:
    """Motions of all parts where the gearbox moves by 1 m along an axis; the ring has turned by `angle` (rad)."""
    layout = gearbox.layout
    q = np.zeros(layout.size)
    for node in layout.nodes.values():
        place = getattr(node, axis)
        if place >= 0:
            q[place] = 1.0
    if axis == "z":
        q[layout.ring("z")] = 1.0
        return q
    towards = angle + 2 * math.pi * np.arange(layout.segments) / layout.segments
    turned = towards if axis == "x" else towards - math.pi / 2
    q[layout.ring("w")] = np.cos(turned)
    q[layout.ring("v")] = -np.sin(turned)
    return q


def potential(gearbox: Gearbox, q: Array, torque: float) -> float:
    """Potential energy (J) at the gearbox's instant, with the ring at angle 0 and without friction."""
    laws, layout = gearbox.laws, gearbox.layout
    ring, law = laws.ring, laws.bearings
    w, v, p, z = (q[layout.ring(motion)] for motion in ("w", "v", "p", "z"))
    plane = np.stack([w, v, p])
    energy = 0.5 * np.sum(plane * (ring.own @ plane)) + np.sum(plane * (ring.next @ np.roll(plane, -1, axis=1)))
    energy += 0.5 * ring.axial * np.sum((np.roll(z, -1) - z) ** 2)
    energy += 0.5 * (ring.radial_support * np.sum(w**2) + ring.axial_support * np.sum(z**2))
    energy -= ring.weight * (ring.cos @ w - ring.sin @ v) + torque * ring.lever * np.sum(v)
    energy -= laws.weight @ q + laws.output_push * torque * q[laws.output]
    spring = laws.springs
    first, second = q[spring.first], q[spring.second]
    energy += 0.5 * np.sum(spring.aa * first**2 - 2 * spring.ab * first * second + spring.bb * second**2)
    for b, (x, y, axial) in enumerate(law.place):
        rollers = getattr(BEARINGS, bearing_kind(names.BEARINGS[b])).rollers
        angle = 2 * math.pi * np.arange(rollers) / rollers
        squeeze = law.radial[b] * (q[x] * np.cos(angle) + q[y] * np.sin(angle)) + law.axial[b] * q[axial]
        power = 19 / 9
        energy += law.stiffness[b] / power * np.sum(np.maximum(squeeze - law.clearance[b], 0) ** power)
    rows, excitation = gearbox.instants.rows[0], gearbox.instants.excitation[0]
    x = np.sum(rows.normal * q[rows.place], axis=1) + excitation[:, 1]
    deflection = np.maximum(np.abs(x) - laws.mesh.backlash, 0)
    return float(energy + 0.5 * np.sum(excitation[:, 0] * deflection**2))
