"""Forces don't jump: when a planet passes from one ring segment to the next, when teeth and rollers take up load."""

import math

import numpy as np
import pytest

from nw_gear_common.tables import Array
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from test.sim.gearboxes import RATED_SPEED, RATED_TORQUE, make

BORDERS = [0.0, 1.0, 33.0, 77.0, -250.0]


def at(gearbox: Gearbox, q: Array, angle: float) -> tuple[Array, Array, Array]:
    """Elastic force, whole force and rate of the elongation of planet 1's mesh with the ring, at rated speed; (3,)."""
    gearbox.set_instant(RATED_TORQUE, RATED_SPEED, angle)
    gearbox.forces(q, np.zeros_like(q))
    contact = gearbox.contact
    return contact.elastic[:3].copy(), contact.force[:3].copy(), contact.rate[:3].copy()


@pytest.mark.parametrize("border", BORDERS)
def test_across_the_border_of_segments(border: float, figure) -> None:
    """Planet 1 passes from a segment to the next where the ring's angle is a multiple of the pitch.

    The elastic force, and what each body feels of it, is continuous. The blend has a kink, so that the rate of the
    elongation steps there, and with it the damping force: by a ten-thousandth of the mesh force at rated torque.
    """
    gearbox = make(("friction.enabled", False))
    angle = border * gearbox.kinematics.ring.pitch
    q = find_equilibrium(gearbox, RATED_TORQUE, speed=RATED_SPEED, angle=angle).q
    before, after = (at(gearbox, q, angle + step) for step in (-1e-12, 1e-12))
    elastic, whole = (float(np.max(np.abs(b - a) / np.abs(a))) for a, b in zip(before[:2], after[:2], strict=True))
    assert figure("jump of the elastic force across a segment's border", elastic) < 1e-9
    assert figure("jump of the mesh force (damping) across a segment's border", whole) < 2e-4
    damping = gearbox.kinematics.stages[0].stiffness.damping
    assert after[1] - before[1] == pytest.approx(damping * (after[2] - before[2]), abs=1e-3)


def test_generalised_forces_across_the_border(figure) -> None:
    """With the mesh's damping off, no force on any motion jumps: the shares of the segments go to 0 and 1."""
    gearbox = make(("mesh.I.damping_ratio", 0.0))
    angle = 33 * gearbox.kinematics.ring.pitch
    q = find_equilibrium(gearbox, RATED_TORQUE, speed=RATED_SPEED, angle=angle).q
    sides = []
    for step in (-1e-12, 1e-12):
        gearbox.set_instant(RATED_TORQUE, RATED_SPEED, angle + step)
        sides.append(gearbox.forces(q, np.zeros_like(q)))
    jump = float(np.max(np.abs(sides[1] - sides[0])) / np.max(gearbox.contact.elastic))
    assert figure("jump of a segment's force across the border", jump) < 1e-9


def test_rigid_motion_has_a_smooth_rate(figure) -> None:
    """The rate steps by what neighbouring segments differ in; where the ring moves as a whole it doesn't."""
    gearbox = make()
    rigid = np.zeros(gearbox.layout.size)
    rigid[gearbox.layout.ring("v")] = 1e-4 * gearbox.kinematics.ring.radius
    rigid[gearbox.layout.ring("p")] = 1e-4 * gearbox.kinematics.bodies.ring.base_radius
    x_before, _, before = at(gearbox, rigid, -1e-12)
    x_after, _, after = at(gearbox, rigid, 1e-12)
    assert x_after == pytest.approx(x_before, rel=1e-9)
    assert figure("step of the rate in a rigid motion, m/s", float(np.max(np.abs(after - before)))) < 1e-9


def test_shares_of_the_segments_follow_the_contact() -> None:
    """Midway between two centroids both carry half; at a centroid one carries all."""
    gearbox = make()
    pitch = gearbox.kinematics.ring.pitch
    for place, shares in ((0.0, (1.0, 0.0)), (0.25, (0.75, 0.25)), (0.5, (0.5, 0.5)), (0.75, (0.25, 0.75))):
        gearbox.set_instant(0.0, RATED_SPEED, -(10 + place) * pitch)
        rows = gearbox.instants.rows[0]
        z = rows.normal[0, [3, 7]] / rows.normal[0, [3, 7]].sum()
        assert z == pytest.approx(shares, abs=1e-9)
        assert rows.place[0, [0, 4]].tolist() == [10, 11]


def test_forces_are_continuous_in_the_displacement() -> None:
    """Across the edges of the backlash and where rollers take up load there are kinks, but no jumps."""
    gearbox = make()
    gearbox.set_instant(RATED_TORQUE, RATED_SPEED, 0.3)
    direction = np.random.default_rng(1).standard_normal(gearbox.layout.size)
    forces = [gearbox.forces(s * 1e-7 * direction, 0 * direction) for s in range(4000)]
    steps = np.max(np.abs(np.diff(forces, axis=0)), axis=1)
    assert np.count_nonzero(gearbox.contact.elastic) >= 3  # the far end is in contact
    assert np.max(steps) < 20 * np.median(steps)


def test_damping_only_in_contact_jumps_by_what_it_is() -> None:
    """`damping_in_gap: false` lets C x' set in at contact: the only jump there is, and off by default."""
    jumps = []
    for inside in (True, False):
        gearbox = make(("mesh.damping_in_gap", inside), ("friction.enabled", False))
        gearbox.set_instant(0.0, 0.0)
        q, v = np.zeros((2, gearbox.layout.size))
        v[gearbox.layout.nodes["h1"].u] = 1e-3
        cos = math.cos(gearbox.kinematics.stages[2].pair.base_helix)
        edge = (50e-6 - gearbox.instants.excitation[0, 6, 1]) / cos
        sides = []
        for displacement in (edge * (1 - 1e-12), edge * (1 + 1e-12)):
            q[gearbox.layout.nodes["h1"].u] = displacement
            gearbox.forces(q, v)
            sides.append(gearbox.contact.force[6])
        jumps.append(sides[1] - sides[0])
    damping = make().kinematics.stages[2].stiffness.damping
    assert jumps[0] == pytest.approx(0, abs=1e-3)
    assert jumps[1] == pytest.approx(damping * cos * 1e-3, rel=1e-6)
