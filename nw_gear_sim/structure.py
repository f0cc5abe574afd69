"""Masses and springs that follow from dimensions: gear inertias, and the segments of the flexible ring."""

from __future__ import annotations

import math
from dataclasses import dataclass

from nw_gear_common.errors import InputError
from nw_gear_sim.geometry import GearGeometry
from nw_gear_sim.params import Gear, Ring, Toothing, Wheel


@dataclass(frozen=True)
class Body:
    """One gear as a rigid body.

    Attributes:
        mass: kg.
        inertia: about its axis, kg m^2.
        base_radius: m.
        base_mass: inertia / base_radius^2, the mass that u = base_radius * rotation moves, kg.
    """

    mass: float
    inertia: float
    base_radius: float
    base_mass: float


@dataclass(frozen=True)
class RingSegments:
    """The ring cut into equal rigid segments with elastic joints on the circle `radius`; one segment's values.

    Attributes:
        count: number M of segments; pitch: angle between neighbours, rad.
        mass: kg; inertia: about its own centroid, J_s = m (L^2 + H^2) / 12, kg m^2.
        radius: r_c, midway between reference circle and outer radius, m.
        length: L = 2 pi r_c / M, m; rim: radial height of the joint between root and outer radius, m.
        tangential: k_t = E A / L; radial, axial: k_s = k_z = 5/6 G A / L, N/m.
        rotational: k_theta = E I / L, N m/rad.
        damping_time: damping of each joint spring over its stiffness, s.
        radial_support, axial_support: springs to ground, N/m.
        radial_support_damping, axial_support_damping: N s/m.
    """

    count: int
    pitch: float
    mass: float
    inertia: float
    radius: float
    length: float
    rim: float
    tangential: float
    radial: float
    axial: float
    rotational: float
    damping_time: float
    radial_support: float
    axial_support: float
    radial_support_damping: float
    axial_support_damping: float


def body(mass: float, outer_radius: float, inner_radius: float, base_radius: float) -> Body:
    """Return the body of a hollow cylinder: I = m (r_o^2 + r_i^2) / 2."""
    inertia = mass * (outer_radius**2 + inner_radius**2) / 2
    return Body(mass, inertia, base_radius, inertia / base_radius**2)


def wheel_body(place: str, gear: Wheel, geometry: GearGeometry) -> Body:
    """Return the body of a gear on a shaft, solid between its bore and its reference circle.

    Raises:
        InputError: the bore is as large as the reference circle.
    """
    if gear.bore_radius >= geometry.reference_radius:
        expected = f"less than the reference radius {geometry.reference_radius:.6g} m"
        raise InputError(f"{place}.bore_radius", expected, f"{gear.bore_radius:.6g} m")
    return body(gear.mass, geometry.reference_radius, gear.bore_radius, geometry.base_radius)


def ring_body(gear: Gear, ring: Ring, geometry: GearGeometry) -> Body:
    """Return the ring as one rigid body between its reference circle and its outer radius."""
    return body(gear.mass, ring.outer_radius, geometry.reference_radius, geometry.base_radius)


def ring_segments(gear: Gear, ring: Ring, toothing: Toothing, geometry: GearGeometry) -> RingSegments:
    """Cut the ring into segments.

    The joint has the section of the rim below the teeth of an unshifted ring (root at reference + dedendum), with the
    whole face width; Timoshenko's shear factor 5/6.

    Raises:
        InputError: the outer radius leaves no rim.
    """
    root = geometry.reference_radius + toothing.dedendum * toothing.normal_module
    rim = ring.outer_radius - root
    if rim <= 0:
        raise InputError("ring.outer_radius", f"more than the root radius {root:.6g} m", f"{ring.outer_radius:.6g} m")
    radius = (geometry.reference_radius + ring.outer_radius) / 2
    height = ring.outer_radius - geometry.reference_radius
    count = ring.segments
    length = 2 * math.pi * radius / count
    mass = gear.mass / count
    section = toothing.face_width * rim
    shear = 5 / 6 * ring.elastic_modulus / (2 * (1 + ring.poisson_ratio)) * section / length
    radial_support, axial_support = 2 * ring.radial_support / count, ring.axial_support / count
    return RingSegments(
        count=count,
        pitch=2 * math.pi / count,
        mass=mass,
        inertia=mass * (length**2 + height**2) / 12,
        radius=radius,
        length=length,
        rim=rim,
        tangential=ring.elastic_modulus * section / length,
        radial=shear,
        axial=shear,
        rotational=ring.elastic_modulus * section * rim**2 / 12 / length,
        damping_time=ring.joint_damping_time,
        radial_support=radial_support,
        axial_support=axial_support,
        radial_support_damping=2 * ring.support_damping_ratio * math.sqrt(radial_support * mass),
        axial_support_damping=2 * ring.support_damping_ratio * math.sqrt(axial_support * mass),
    )
