"""The flexible ring against rigid-body motions, closed forms and its loads."""

import math

import numpy as np
import pytest
import scipy.linalg

from nw_gear_common.tables import Array
from nw_gear_sim.config import load
from nw_gear_sim.kinematics import derive
from nw_gear_sim.physics.ring import RingLaw, joint_rows, ring_forces, ring_law
from nw_gear_sim.physics.spring import Spring, add_springs, spring_law

KINEMATICS = derive(load())
RING = KINEMATICS.ring
BASE = KINEMATICS.bodies.ring.base_radius
M = RING.count


def law(support: float = 0.0, weight: float = 0.0, damping_time: float = 0.0) -> RingLaw:
    return ring_law(
        segments=M,
        radius=RING.radius,
        base_radius=BASE,
        joint=(RING.radial, RING.tangential, RING.rotational, RING.axial),
        damping_time=damping_time,
        support=(support, support),
        support_damping=(0.0, 0.0),
        weight=weight,
        gravity_direction=-math.pi / 2,
    )


def forces(ring: RingLaw, q: Array, angle: float = 0.0, torque: float = 0.0, v: Array | None = None) -> Array:
    out = np.empty(4 * M)
    turn = np.array([math.cos(angle), math.sin(angle)])
    ring_forces(ring, turn, torque, q, np.zeros(4 * M) if v is None else v, np.zeros((4, M + 2)), out)
    return out


def rigid_motions() -> list[Array]:
    angles = 2 * math.pi * np.arange(M) / M
    zero, one = np.zeros(M), np.ones(M)
    return [
        np.concatenate([np.cos(angles), -np.sin(angles), zero, zero]),
        np.concatenate([np.sin(angles), np.cos(angles), zero, zero]),
        np.concatenate([zero, RING.radius * one, BASE * one, zero]),
        np.concatenate([zero, zero, zero, one]),
    ]


@pytest.mark.parametrize("k", range(4))
def test_rigid_motions_cost_nothing(k: int) -> None:
    assert np.max(np.abs(forces(law(), rigid_motions()[k]))) < 1e-14 * RING.tangential


def test_deformed_ring_pushes_back_without_net_force() -> None:
    """The joints' forces do no work on rigid motions."""
    q = 1e-4 * np.random.default_rng(1).standard_normal(4 * M)
    force = forces(law(), q)
    assert q @ force < 0
    for motion in rigid_motions():
        assert abs(motion @ force) < 1e-12 * np.abs(motion) @ np.abs(force)


def test_forces_are_those_of_the_joint_elongations() -> None:
    """Energy of the joints one by one, from their elongations, differentiated."""
    here, beyond = joint_rows(M, RING.radius, BASE)
    q = 1e-4 * np.random.default_rng(2).standard_normal(4 * M)
    plane = q[: 3 * M].reshape(3, M)
    tension = np.diag([RING.radial, RING.tangential, RING.rotational]) @ (here @ plane + beyond @ np.roll(plane, -1, 1))
    expected = -(here.T @ tension + np.roll(beyond.T @ tension, 1, 1))
    assert forces(law(), q)[: 3 * M] == pytest.approx(expected.ravel(), rel=1e-9, abs=1e-3)


def test_free_ring_bends_at_the_closed_form_frequency() -> None:
    """Thin ring in plane, n = 2: w^2 = E I n^2 (n^2 - 1)^2 / (rho A r^4 (n^2 + 1)); shear lowers it a bit."""
    stiffness = -np.stack([forces(law(), column) for column in np.eye(4 * M)], axis=1)[: 3 * M, : 3 * M]
    mass = np.repeat([RING.mass, RING.mass, RING.inertia / BASE**2], M)
    squares = scipy.linalg.eigvalsh(stiffness / np.sqrt(np.outer(mass, mass)), subset_by_index=[0, 4])
    frequencies = np.sqrt(np.abs(squares)) / (2 * math.pi)
    assert np.all(frequencies[:3] < 0.1)
    bending = RING.rotational * RING.length
    closed = math.sqrt(bending * RING.length / RING.mass * 36 / 5) / RING.radius**2 / (2 * math.pi)
    assert closed == pytest.approx(35.5, abs=0.1)
    assert frequencies[3:] == pytest.approx([35.3, 35.3], abs=0.05)
    assert frequencies[3] < closed


@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_weight_points_down_and_torque_turns(angle: float) -> None:
    """Resolved along fixed axes the weight is -y whatever the ring's angle; the torque is that about the axis."""
    force = forces(law(weight=RING.mass * 9.81), np.zeros(4 * M), angle=angle, torque=1e6)
    x, y, turn, _ = rigid_motions()
    along_x = math.cos(angle) * x - math.sin(angle) * y
    along_y = math.sin(angle) * x + math.cos(angle) * y
    assert along_x @ force == pytest.approx(0, abs=1e-6)
    assert along_y @ force == pytest.approx(-5690 * 9.81, rel=1e-12)
    assert turn @ force == pytest.approx(1e6, rel=1e-12)


def test_joint_damping_takes_energy_out() -> None:
    v = np.random.default_rng(3).standard_normal(4 * M)
    assert v @ forces(law(damping_time=2e-6), np.zeros(4 * M), v=v) < 0
    damped = forces(law(damping_time=2e-6), np.zeros(4 * M), v=v)
    assert damped == pytest.approx(2e-6 * forces(law(), v), rel=1e-9, abs=1e-3)


def test_supports_hold_the_ring() -> None:
    """M springs of 2 k / M hold the ring radially with k in any direction, axially with M times one."""
    x, _, turn, z = rigid_motions()
    ring = law(support=2 * 5e9 / M)
    assert -x @ forces(ring, x) == pytest.approx(5e9, rel=1e-9)
    assert -z @ forces(ring, z) == pytest.approx(2 * 5e9, rel=1e-9)
    assert np.max(np.abs(forces(ring, turn))) < 1e-3


def test_springs_pull_both_ends_alike() -> None:
    springs = spring_law(
        [Spring(0, 1, 1.0, 1.0, 100.0, 0.0), Spring(1, 2, 2.0, 4.0, 10.0, 0.5), Spring(2, 2, 3.0, 0.0, 1.0, 0.0)]
    )
    force = np.zeros(3)
    add_springs(springs, np.array([3.0, 1.0, 0.25]), np.array([0.0, 4.0, 0.0]), force)
    second = 10.0 * (2 * 1.0 - 4 * 0.25 + 0.5 * 2 * 4.0)
    assert force == pytest.approx([-200.0, 200.0 - 2 * second, 4 * second - 9 * 0.25])
