"""Static equilibrium at rated torque, its torque chain, and the modes there, against an independent implementation.

The numbers come from a throw-away model written from the same equations (stage I depends on the phase at t = 0, which
is that of the largest stiffness in both).
"""

import math

import numpy as np
import pytest

from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.linear import find_modes
from test.sim.gearboxes import RATED_SPEED, RATED_TORQUE, WITHOUT_FRICTION, at_rest, make

UNIT = 45e-6


def test_elongations_without_friction() -> None:
    gearbox, found = at_rest(*WITHOUT_FRICTION)
    assert found.residual < 0.01
    assert gearbox.contact.x / UNIT == pytest.approx([3.12, 3.95, 3.85, 2.377, 2.325, 2.277, 3.274], abs=6e-3)


def test_elongations_with_friction() -> None:
    """Friction shifts the loads by a per cent or two; how much depends on where the contact lines stand at t = 0."""
    gearbox, found = at_rest()
    assert found.residual < 0.01
    assert gearbox.contact.x / UNIT == pytest.approx([3.12, 3.96, 3.86, 2.37, 2.31, 2.27, 3.25], abs=0.02)


def test_load_shares() -> None:
    gearbox, _ = at_rest(*WITHOUT_FRICTION)
    force = gearbox.contact.force
    for stage in (force[:3], force[3:6]):
        assert stage / stage.mean() == pytest.approx([1.044, 0.996, 0.960], abs=5e-4)


def test_mesh_forces_follow_from_the_torque() -> None:
    """F_n = T / (r_b cos beta_b), the mean of the planets: hand calculation from the torque."""
    gearbox, _ = at_rest(*WITHOUT_FRICTION)
    force = gearbox.contact.force
    assert force[:3].mean() == pytest.approx(1.19727e6, rel=2e-5)
    assert force[3:6].mean() == pytest.approx(5.5536e5, rel=2e-5)
    assert force[6] == pytest.approx(7.91857e5, rel=2e-5)


def test_torque_chain() -> None:
    gearbox, found = at_rest(*WITHOUT_FRICTION)
    kinematics = gearbox.kinematics
    helix = [math.cos(stage.pair.base_helix) for stage in kinematics.stages]
    force, bodies, ratio = gearbox.contact.force, kinematics.bodies, kinematics.shaft_ratio
    ring = force[:3].sum() * helix[0] * bodies.ring.base_radius
    sun = force[3:6].sum() * helix[1] * bodies.sun.base_radius * ratio["sun"]
    herringbone = force[6] * helix[2] * bodies.herringbone_1.base_radius * ratio["sun"]
    twist = found.q[gearbox.layout.nodes["h2"].u] / bodies.herringbone_2.base_radius
    generator = RATED_TORQUE + 5e6 * twist * ratio["output"]
    assert [ring, sun, herringbone, generator] == pytest.approx([RATED_TORQUE] * 4, rel=1e-9)


@pytest.mark.parametrize("load", [0.0, 1e-3, 0.05, 0.3, 4.0])
def test_found_at_any_load(load: float) -> None:
    gearbox = make()
    found = find_equilibrium(gearbox, load * RATED_TORQUE, speed=RATED_SPEED, angle=2.7)
    assert found.residual < 0.01
    assert np.max(np.abs(found.q)) < 0.02


def test_matrices_are_symmetric_without_friction() -> None:
    gearbox, found = at_rest(*WITHOUT_FRICTION)
    for matrix in (gearbox.stiffness(found.q), gearbox.damping(found.q)):
        assert np.max(np.abs(matrix - matrix.T)) < 1e-8 * np.max(np.abs(matrix))


def test_friction_makes_the_stiffness_asymmetric() -> None:
    gearbox, found = at_rest()
    stiffness = gearbox.stiffness(found.q)
    assert np.max(np.abs(stiffness - stiffness.T)) > 1e-5 * np.max(np.abs(stiffness))


def test_modes() -> None:
    gearbox, found = at_rest(*WITHOUT_FRICTION)
    modes = find_modes(gearbox, found.q)
    assert gearbox.layout.size == 463
    assert modes.frequencies_hz[:7] == pytest.approx([38.5, 58.25, 58.58, 59.24, 65.7, 79.9, 94.2], abs=0.06)
    assert modes.largest_eigenvalue == pytest.approx(1.057e5, rel=1e-3)
    assert modes.largest_stable_step == pytest.approx(2.79e-5, rel=2e-3)
    assert modes.eigenvalues.real.max() < 0
    assert gearbox.kinematics.omega_n == pytest.approx(5286, rel=1e-3)
