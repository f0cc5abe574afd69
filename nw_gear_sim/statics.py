"""What the static equilibrium of a gearbox says: mesh forces, load shares, bearing forces, the chain of torques."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.equilibrium import Equilibrium, find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.params import Configuration


@dataclass(frozen=True, eq=False)
class Statics:
    """Forces and displacements at rest.

    Attributes:
        torque: on the ring, N m; speed: of the ring, rad/s, that sets friction; angle: of the ring, rad.
        found: displacements, residual and iterations.
        displacement, force: x_n (m) and mesh force (N) in the order of names.MESHES, (7,).
        bearing_force: on the housings in the order of names.BEARINGS, N, (10, 3).
        torque_ratio: torque carried by ring, sun, herringbone_1 and generator over the input torque, each times its
            speed over that of the ring, so that 1 is a closed chain; NaN without torque.
    """

    torque: float
    speed: float
    angle: float
    found: Equilibrium
    displacement: Array
    force: Array
    bearing_force: Array
    torque_ratio: dict[str, float]

    @property
    def load_share(self) -> dict[str, Array]:
        """Force of each planet's mesh over the mean of the three, stages I and II; NaN where none carries."""
        stages = {"I": self.force[:3], "II": self.force[3:6]}
        return {k: f / f.mean() if f.mean() != 0 else np.full(3, math.nan) for k, f in stages.items()}


def find_statics(
    configuration: Configuration, gearbox: Gearbox, *, torque: float, speed: float = 0.0, angle: float = 0.0
) -> Statics:
    """Find the static equilibrium and leave the gearbox's instant set there.

    Args:
        configuration, gearbox: the same gearbox.
        torque: on the ring, N m; speed: of the ring, rad/s; angle: of the ring, rad.

    Raises:
        NoEquilibrium: as `find_equilibrium`.
    """
    found = find_equilibrium(gearbox, torque, speed=speed, angle=angle)
    gearbox.forces(found.q, np.zeros_like(found.q))
    force = gearbox.contact.force.copy()
    return Statics(
        torque=torque,
        speed=speed,
        angle=angle,
        found=found,
        displacement=gearbox.contact.x.copy(),
        force=force,
        bearing_force=gearbox.housing.copy(),
        torque_ratio=_torque_ratio(configuration, gearbox, found.q, force, torque),
    )


def _torque_ratio(
    configuration: Configuration, gearbox: Gearbox, q: Array, force: Array, torque: float
) -> dict[str, float]:
    """Torque F cos(beta_b) r_b of the meshes; that of the generator is the constant reaction and its spring's."""
    if torque == 0:
        return dict.fromkeys(("ring", "sun", "herringbone_1", "generator"), math.nan)
    kinematics = gearbox.kinematics
    bodies, ratio = kinematics.bodies, kinematics.shaft_ratio
    first, second, third = (math.cos(stage.pair.base_helix) for stage in kinematics.stages)
    twist = q[gearbox.layout.nodes["h2"].u] / bodies.herringbone_2.base_radius
    generator = torque / ratio["output"] + configuration.generator.stiffness * twist
    carried = {
        "ring": force[:3].sum() * first * bodies.ring.base_radius,
        "sun": force[3:6].sum() * second * bodies.sun.base_radius * ratio["sun"],
        "herringbone_1": force[6] * third * bodies.herringbone_1.base_radius * ratio["sun"],
        "generator": generator * ratio["output"],
    }
    return {name: float(value) / torque for name, value in carried.items()}


def as_object(statics: Statics) -> dict[str, object]:
    """Return the JSON object of `nw_gear equilibrium`: SI units, NaN as null."""
    return {
        "residual": statics.found.residual,
        "iterations": statics.found.iterations,
        "torque": statics.torque,
        "speed": statics.speed,
        "angle": statics.angle,
        "torque_ratio": {name: _number(value) for name, value in statics.torque_ratio.items()},
        "mesh": {
            mesh: {"displacement": float(x), "force": float(f)}
            for mesh, x, f in zip(names.MESHES, statics.displacement, statics.force, strict=True)
        },
        "load_share": {stage: [_number(share) for share in shares] for stage, shares in statics.load_share.items()},
        "bearing": {
            bearing: dict(zip("xyz", map(float, force), strict=True))
            for bearing, force in zip(names.BEARINGS, statics.bearing_force, strict=True)
        },
    }


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
