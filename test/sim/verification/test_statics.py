"""Static equilibrium: torque chain at any angle and load, load shares where they have an answer by hand."""

import math

import numpy as np
import pytest

from nw_gear_common.tables import Array
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from test.sim.gearboxes import RATED_TORQUE, WITHOUT_FRICTION, make

ONE_STIFFNESS = (
    *((f"mesh.{stage}.stiffness_variation", 0.0) for stage in ("I", "II", "III")),
    *((f"mesh.{stage}.error_amplitude", 0.0) for stage in ("I", "II", "III")),
    ("gravity.acceleration", 0.0),
)
RIGID_CENTRE = (
    *((f"bearings.{kind}.stiffness", 1e14) for kind in ("sb", "b1")),
    *((f"bearings.{kind}.clearance", 0.0) for kind in ("sb", "b1")),
    ("shafts.sun_radial", 1e13),
    ("shafts.sun_axial", 1e13),
)


def balanced(gearbox: Gearbox, torque: float, angle: float = 0.0) -> tuple[Array, Array]:
    """Mesh forces and displacements at rest."""
    q = find_equilibrium(gearbox, torque, angle=angle).q
    gearbox.set_instant(torque, 0.0, angle, static=True)
    gearbox.forces(q, 0 * q)
    return gearbox.contact.force.copy(), q


@pytest.mark.parametrize(("angle", "load"), [(0.0, 1.0), (0.9, 1.0), (-3.3, 0.1), (2.2, 3.0)])
def test_torque_chain(angle: float, load: float, figure) -> None:
    """Torques of ring, planets, sun, herringbone 1 and generator are the input torque over the ratios, to 1e-9.

    From mesh forces and base radii alone; a reference radius instead of the working one would cost 2.4 % in stage I.
    """
    gearbox = make(*WITHOUT_FRICTION)
    torque = load * RATED_TORQUE
    force, q = balanced(gearbox, torque, angle)
    kinematics, ratio = gearbox.kinematics, gearbox.kinematics.shaft_ratio
    helix = [math.cos(stage.pair.base_helix) for stage in kinematics.stages]
    bodies = kinematics.bodies
    twist = q[gearbox.layout.nodes["h2"].u] / bodies.herringbone_2.base_radius
    torques = {
        "ring": force[:3].sum() * helix[0] * bodies.ring.base_radius,
        "planet 1": force[:3].sum() * helix[0] * bodies.planet_1.base_radius * ratio["planet"],
        "planet 2": force[3:6].sum() * helix[1] * bodies.planet_2.base_radius * ratio["planet"],
        "sun": force[3:6].sum() * helix[1] * bodies.sun.base_radius * ratio["sun"],
        "herringbone 1": force[6] * helix[2] * bodies.herringbone_1.base_radius * ratio["sun"],
        "herringbone 2": force[6] * helix[2] * bodies.herringbone_2.base_radius * ratio["output"],
        "generator": torque + 5e6 * twist * ratio["output"],
    }
    worst = max(abs(value / torque - 1) for value in torques.values())
    assert figure("torque chain, off the ratios", worst) < 1e-9


def test_each_planet_passes_on_what_it_takes() -> None:
    """Torque on planet_1 of a planet is that on its planet_2, planet by planet."""
    gearbox = make(*WITHOUT_FRICTION)
    force, _ = balanced(gearbox, RATED_TORQUE, 0.77)
    first, second, _ = (stage.pair for stage in gearbox.kinematics.stages)
    taken = force[:3] * math.cos(first.base_helix) * first.driven.base_radius
    passed = force[3:6] * math.cos(second.base_helix) * second.driver.base_radius
    assert taken == pytest.approx(passed, rel=1e-9)


def test_axial_forces_by_hand() -> None:
    """Stage I pushes 78.5 kN, stage II 65.4 kN per planet along the axis; a planet's bearings keep about 13 kN."""
    gearbox = make(*WITHOUT_FRICTION, *ONE_STIFFNESS)
    force, _ = balanced(gearbox, RATED_TORQUE)
    first, second, _ = (stage.pair for stage in gearbox.kinematics.stages)
    axial_1, axial_2 = force[:3] * math.sin(first.base_helix), force[3:6] * math.sin(second.base_helix)
    assert axial_1.mean() == pytest.approx(7.85e4, rel=2e-3)
    assert axial_2.mean() == pytest.approx(6.54e4, rel=2e-3)
    housing = gearbox.housing[:, 2]
    for j in range(3):
        assert abs(housing[j] + housing[3 + j]) == pytest.approx(abs(axial_1[j] - axial_2[j]), rel=1e-6)
    assert abs(housing[6] + housing[7]) == pytest.approx(axial_2.sum(), rel=1e-6)


def test_equal_shares_on_a_rigid_centre(figure) -> None:
    """Where nothing tells the planets apart, each carries a third.

    Weight, errors and variation of stiffness are off, and the central shaft is as good as fixed, so that stage III
    doesn't pull it to one side.
    """
    force, _ = balanced(make(*WITHOUT_FRICTION, *ONE_STIFFNESS, *RIGID_CENTRE), RATED_TORQUE)
    worst = max(float(np.max(np.abs(part / part.mean() - 1))) for part in (force[:3], force[3:6]))
    assert figure("load share of planets that are alike, off a third", worst) < 2e-3


def test_shares_on_a_yielding_centre(figure) -> None:
    """Stage III pulls the sun by X; by hand each planet's elongation in II gets -cos beta n_j X, and n sums to zero.

    The sum of the three is the torque's whatever X is. Weight and differences in phase are off.
    """
    gearbox = make(*WITHOUT_FRICTION, *ONE_STIFFNESS)
    force, q = balanced(gearbox, RATED_TORQUE)
    layout, pair = gearbox.layout, gearbox.kinematics.stages[1].pair
    cos, a = math.cos(pair.base_helix), pair.working_angle
    sun, elongation = layout.nodes["s"], []
    for j in range(3):
        th, planet = 2 * math.pi * j / 3, layout.planet("p2", j)
        n = -math.sin(a) * np.array([math.cos(th), math.sin(th)]) - math.cos(a) * np.array(
            [-math.sin(th), math.cos(th)]
        )
        apart = np.array([q[planet.x] - q[sun.x], q[planet.y] - q[sun.y]])
        axial = math.sin(pair.base_helix) * (q[planet.z] - q[sun.z])
        elongation.append(cos * (q[planet.u] - q[sun.u] + n @ apart) + axial)
    stage = gearbox.kinematics.stages[1]
    by_hand = stage.stiffness.normal * (np.array(elongation) - stage.mesh.backlash)
    assert force[3:6] == pytest.approx(by_hand, rel=1e-9)
    assert figure("swing of the shares by stage III's pull", float(np.ptp(force[3:6]) / force[3:6].mean())) > 1e-3
