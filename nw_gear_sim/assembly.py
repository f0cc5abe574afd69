"""From a configuration to the constants of the right-hand side."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.contacts import contact_rows
from nw_gear_sim.kinematics import PLANET_ANGLES, SHAFT_OF_BEARING, Kinematics, Stage, bearing_kind, derive
from nw_gear_sim.layout import Layout, Node
from nw_gear_sim.model import Laws
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.bearing import Bearing, BearingLaw, bearing_law
from nw_gear_sim.physics.engagement import EngagementLaw
from nw_gear_sim.physics.friction import FADE_RATIO, FrictionLaw
from nw_gear_sim.physics.mesh import MeshLaw
from nw_gear_sim.physics.ring import RingLaw, ring_law
from nw_gear_sim.physics.spring import Spring, SpringLaw, spring_law
from nw_gear_sim.physics.tooth import sound_teeth

GEARS = {"p1": "planet_1", "p2": "planet_2", "s": "sun", "h1": "herringbone_1", "h2": "herringbone_2"}
"""The gear of each node of the layout; the digit of a planet is left out."""
SENSE = {"planet": 1, "sun": -1, "output": 1}
"""Sense of rotation of the shafts about z; the ring's is positive."""
PROBES = ("p1_1", "p2_1", "s", "h1", "h2")
"""Gears whose rotation is recorded, besides the ring."""


def assemble(configuration: Configuration, excitation: str) -> tuple[Laws, Layout]:
    """Prepare all constants; `excitation` is `kinematic` or `tied` (all meshes at the phase of stage II)."""
    kinematics = derive(configuration)
    layout = Layout(kinematics.ring.count)
    mesh_ratio = [stage.mesh_ratio for stage in kinematics.stages]
    law, rows = _mesh_law(configuration, kinematics), contact_rows(kinematics, layout)
    laws = Laws(
        ring=_ring(configuration, kinematics),
        springs=_springs(configuration, kinematics, layout),
        bearings=_bearings(configuration, kinematics, layout),
        mesh=law,
        engagement=_engagement(kinematics),
        friction=_friction(configuration, kinematics),
        teeth=sound_teeth(),
        rows=rows,
        weight=_weight(configuration, kinematics, layout),
        inverse_mass=1 / masses(configuration, kinematics, layout),
        phase_ratio=np.array([mesh_ratio[1]] * 3 if excitation == "tied" else mesh_ratio),
        output=layout.nodes["h2"].u,
        output_push=-1 / (kinematics.total_ratio * kinematics.bodies.herringbone_2.base_radius),
        probes=np.array([layout.nodes[probe].u for probe in PROBES]),
    )
    return laws, layout


def masses(configuration: Configuration, kinematics: Kinematics, layout: Layout) -> Array:
    """Mass (kg) that each motion moves, shape (dof,); rotations have inertia over base radius squared."""
    mass = np.zeros(layout.size)
    ring = kinematics.ring
    for motion in ("w", "v", "z"):
        mass[layout.ring(motion)] = ring.mass
    mass[layout.ring("p")] = ring.inertia / kinematics.bodies.ring.base_radius**2
    for node in layout.nodes.values():
        for k in (node.x, node.y, node.z):
            if k >= 0:
                mass[k] = _mass(configuration, kinematics, node)
        if node.u >= 0:
            mass[node.u] = getattr(kinematics.bodies, GEARS[bearing_kind(node.name)]).base_mass
    return mass


def _mass(configuration: Configuration, kinematics: Kinematics, node: Node) -> float:
    kind = bearing_kind(node.name)
    body: Any = getattr(kinematics.bodies, GEARS[kind]) if kind in GEARS else getattr(configuration.bearings, kind)
    return float(body.mass)


def _weight(configuration: Configuration, kinematics: Kinematics, layout: Layout) -> Array:
    gravity = configuration.gravity
    weight = np.zeros(layout.size)
    for node in layout.nodes.values():
        pull = gravity.acceleration * _mass(configuration, kinematics, node)
        weight[node.x] = pull * math.cos(gravity.direction)
        weight[node.y] = pull * math.sin(gravity.direction)
    return weight


def _ring(configuration: Configuration, kinematics: Kinematics) -> RingLaw:
    ring = kinematics.ring
    return ring_law(
        segments=ring.count,
        radius=ring.radius,
        base_radius=kinematics.bodies.ring.base_radius,
        joint=(ring.radial, ring.tangential, ring.rotational, ring.axial),
        damping_time=ring.damping_time,
        support=(ring.radial_support, ring.axial_support),
        support_damping=(ring.radial_support_damping, ring.axial_support_damping),
        weight=ring.mass * configuration.gravity.acceleration,
        gravity_direction=configuration.gravity.direction,
    )


def _springs(configuration: Configuration, kinematics: Kinematics, layout: Layout) -> SpringLaw:
    """Springs along each shaft: pb1 - p1 - pb2 - p2, sb - s - h1 - b1, b21 - h2 - b22, and the torsion springs."""
    shafts, torsion, generator = configuration.shafts, configuration.torsion, configuration.generator
    chains: list[tuple[list[str], float, float]] = [
        ([f"{part}_{j}" for part in ("pb1", "p1", "pb2", "p2")], shafts.planet_radial, shafts.planet_axial)
        for j in (1, 2, 3)
    ]
    chains.append((["sb", "s", "h1", "b1"], shafts.sun_radial, shafts.sun_axial))
    chains.append((["b21", "h2", "b22"], shafts.output_radial, 0.0))
    springs = []
    for chain, radial, axial in chains:
        for first, second in itertools.pairwise(chain):
            a, b = layout.nodes[first], layout.nodes[second]
            for i, k, stiffness in ((a.x, b.x, radial), (a.y, b.y, radial), (a.z, b.z, axial)):
                if i >= 0 and k >= 0:
                    springs.append(Spring(i, k, 1.0, 1.0, stiffness, shafts.damping_time))
    bodies = kinematics.bodies
    twists = [(f"p1_{j}", f"p2_{j}", bodies.planet_1, bodies.planet_2, torsion.planet) for j in (1, 2, 3)]
    twists.append(("s", "h1", bodies.sun, bodies.herringbone_1, torsion.sun))
    for first, second, one, other, stiffness in twists:
        i, k = layout.nodes[first].u, layout.nodes[second].u
        springs.append(Spring(i, k, 1 / one.base_radius, 1 / other.base_radius, stiffness, torsion.damping_time))
    output = layout.nodes["h2"].u
    lever = 1 / bodies.herringbone_2.base_radius
    springs.append(Spring(output, output, lever, 0.0, generator.stiffness, generator.damping_time))
    return spring_law(springs)


def _bearings(configuration: Configuration, kinematics: Kinematics, layout: Layout) -> BearingLaw:
    def bearing(name: str, node: Node) -> Bearing:
        kind = bearing_kind(name)
        data = getattr(configuration.bearings, kind)
        return Bearing(
            x=node.x,
            y=node.y,
            z=node.z,
            rollers=data.rollers,
            stiffness=kinematics.roller_stiffness[kind],
            contact_angle=data.contact_angle,
            clearance=data.clearance,
            damping=data.damping,
            cage_ratio=SENSE[SHAFT_OF_BEARING[kind]] * kinematics.cage_ratio[kind],
        )

    pairs = zip(names.BEARINGS, layout.bearings(), strict=True)
    return bearing_law([bearing(name, node) for name, node in pairs], configuration.bearings.exponent)


def _mesh_law(configuration: Configuration, kinematics: Kinematics) -> MeshLaw:
    starts = start_phases(kinematics)
    meshes: list[tuple[int, Stage, float]] = [
        (k, stage, phase) for k, stage in enumerate(kinematics.stages) for phase in stage.planet_phases
    ]

    def column(values: list[float]) -> Array:
        return np.array(values, dtype=np.float64)

    return MeshLaw(
        stage=np.array([k for k, _, _ in meshes]),
        phase_offset=column([starts[k] + phase for k, _, phase in meshes]),
        stiffness=column([s.stiffness.normal for _, s, _ in meshes]),
        stiffness_cos=column([_swing(s) * math.cos(phase) for _, s, phase in meshes]),
        stiffness_sin=column([-_swing(s) * math.sin(phase) for _, s, phase in meshes]),
        error_mean=column([s.mesh.error_mean for _, s, _ in meshes]),
        error_cos=column([s.mesh.error_amplitude * math.sin(phase) for _, s, phase in meshes]),
        error_sin=column([s.mesh.error_amplitude * math.cos(phase) for _, s, phase in meshes]),
        damping=column([s.stiffness.damping for _, s, _ in meshes]),
        backlash=column([s.mesh.backlash for _, s, _ in meshes]),
        entries=np.array([(12, 8, 6)[k] for k, _, _ in meshes]),
        damping_in_gap=configuration.mesh.damping_in_gap,
    )


def start_phases(kinematics: Kinematics) -> tuple[float, ...]:
    """Mesh phase (rad) of planet 1 in each stage where the ring's angle is 0: that of the largest stiffness.

    Tooth entry is at phase 0, and K = K_m (1 + variation cos(phase - stiffness.phase)), where the variation may be
    negative; the position of the teeth at t = 0 is free. The transmission error rises through its mean there.
    """
    stiffness = [stage.stiffness for stage in kinematics.stages]
    return tuple(math.remainder(s.phase + (math.pi if s.variation < 0 else 0.0), 2 * math.pi) for s in stiffness)


def _swing(stage: Stage) -> float:
    return stage.stiffness.normal * abs(stage.stiffness.variation)


def _engagement(kinematics: Kinematics) -> EngagementLaw:
    pair, ring = kinematics.stages[0].pair, kinematics.ring
    return EngagementLaw(
        planet_angle=np.array(PLANET_ANGLES),
        segments=ring.count,
        pitch=ring.pitch,
        radius=ring.radius,
        base_radius=pair.driver.base_radius,
        working_angle=pair.working_angle,
        cos_helix=math.cos(pair.base_helix),
        sin_helix=math.sin(pair.base_helix),
    )


def _friction(configuration: Configuration, kinematics: Kinematics) -> FrictionLaw:
    friction = configuration.friction
    on = 1.0 if friction.enabled else 0.0
    pairs = [stage.pair for stage in kinematics.stages]
    ratio = [kinematics.shaft_ratio[shaft] for shaft in names.SHAFTS]
    sliding = [abs(ratio[k + 1] + (-ratio[k] if pair.internal else ratio[k])) for k, pair in enumerate(pairs)]
    return FrictionLaw(
        approach=np.array([pair.approach for pair in pairs]),
        recess=np.array([pair.recess for pair in pairs]),
        pitch=np.array([pair.base_pitch for pair in pairs]),
        overlap=np.array([pair.overlap_ratio for pair in pairs]),
        sliding=np.array(sliding),
        fade_speed=FADE_RATIO * configuration.turbine.rated_speed,
        base=on * friction.base,
        decay=friction.decay,
        growth=on * friction.growth,
    )
