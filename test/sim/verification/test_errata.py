"""The paper's equations as they are printed: what each of the larger errors in docs/errata.md would do."""

import math
from collections.abc import Callable

import numpy as np
import pytest
import scipy.linalg

from nw_gear_common.tables import Array
from nw_gear_sim.config import load
from nw_gear_sim.kinematics import derive

CONFIGURATION = load()
KINEMATICS = derive(CONFIGURATION)


def test_joints_at_rest(figure: Callable[[str, float], float]) -> None:
    """Eq 28 with all displacements zero: each joint is stretched by 2 r_c sin(pi / M), 85 mm."""
    ring = KINEMATICS.ring
    phi = math.pi / ring.count
    a, xi = 2 * ring.radius * math.sin(phi / 2), (math.pi - phi) / 2
    at = 2 * phi * np.arange(ring.count)
    before = np.roll(at, 1) - np.where(np.arange(ring.count) == 0, 2 * math.pi, 0)
    x = -a * np.cos(xi + at) + a * np.cos(xi - before)
    y = -a * np.sin(xi + at) - a * np.sin(xi - before)
    assert np.hypot(x, y) == pytest.approx(2 * ring.radius * math.sin(phi), rel=1e-9)
    assert figure("elongation of the printed joints at rest, mm", 1e3 * float(np.hypot(x, y)[5])) == pytest.approx(
        85, abs=0.1
    )


def torsion_chain(sign: float) -> Array:
    """Eigenvalues (1/s^2) of the shafts' rotations alone: ring, three planets of two, sun, both herringbones.

    `sign` is +1 for x_n2 = u_p2 - u_s with the force that belongs to it, -1 for Eq 32 with the forces of Eqs 42, 44.
    """
    bodies, stages = KINEMATICS.bodies, KINEMATICS.stages
    K = np.zeros((10, 10))
    gears = [bodies.ring, *[bodies.planet_1] * 3, *[bodies.planet_2] * 3, bodies.sun]
    gears += [bodies.herringbone_1, bodies.herringbone_2]

    def spring(i: int, j: int, a: float, b: float, stiffness: float) -> None:
        row = np.zeros(10)
        row[i], row[j] = a, -b
        K[:] += stiffness * np.outer(row, row)

    for j in (1, 2, 3):
        spring(0, j, 1, 1, stages[0].stiffness.transverse)
        spring(j, 3 + j, 1 / gears[j].base_radius, 1 / gears[3 + j].base_radius, CONFIGURATION.torsion.planet)
        spring(3 + j, 7, 1, 1, sign * stages[1].stiffness.transverse)
    spring(7, 8, 1 / gears[7].base_radius, 1 / gears[8].base_radius, CONFIGURATION.torsion.sun)
    spring(8, 9, 1, 1, stages[2].stiffness.transverse)
    K[9, 9] += CONFIGURATION.generator.stiffness / gears[9].base_radius ** 2
    scale = np.array([gear.base_mass for gear in gears]) ** -0.5
    return np.asarray(scipy.linalg.eigvalsh(K * np.outer(scale, scale)))


def test_printed_signs_of_stage_two_are_a_negative_stiffness(figure: Callable[[str, float], float]) -> None:
    """Eqs 32, 42, 44: three motions of the shafts grow by e in 0.1 to 0.5 ms; with consistent signs none does."""
    consistent, printed = torsion_chain(1.0), torsion_chain(-1.0)
    assert consistent[0] > 0
    assert figure("lowest torsional frequency, Hz", math.sqrt(consistent[0]) / (2 * math.pi)) == pytest.approx(
        42, abs=1
    )
    assert np.count_nonzero(printed < 0) == 3
    assert figure("growth of the printed stage II, 1/s", math.sqrt(-printed[0])) > 8000


@pytest.mark.parametrize(("stage", "holds"), [("I", True), ("II", False), ("III", False)])
def test_five_branches_need_a_small_overlap(stage: str, holds: bool) -> None:
    """Eq 11 cuts the mesh at eps_beta and eps_alpha / 2, in this order."""
    pair = KINEMATICS.stage(stage).pair
    assert (pair.overlap_ratio <= pair.contact_ratio / 2) == holds
    assert abs(pair.approach - pair.recess) > 0.04 * pair.approach  # and the pitch point isn't in the middle


def test_reference_radius_with_the_working_angle(figure: Callable[[str, float], float]) -> None:
    """Mixing them in stage I (Eqs 29-37 say alpha_t) makes forces whose torques don't fit: 2.4 %."""
    pair = KINEMATICS.stages[0].pair
    mixed = pair.driver.reference_radius * math.cos(pair.working_angle)
    off = abs(mixed / pair.driver.base_radius - 1)
    assert figure("torque imbalance by the reference radius", off) == pytest.approx(0.024, abs=5e-4)


def test_planets_cant_mesh_in_step() -> None:
    """Eqs 3 and 34 have no phase between planets; 91 and 40 teeth don't divide by three."""
    for stage in KINEMATICS.stages[:2]:
        turns = np.array(stage.planet_phases) / (2 * math.pi)
        assert sorted(turns % 1) == pytest.approx([0, 1 / 3, 2 / 3], abs=1e-12)


def test_nondimensional_moments(figure: Callable[[str, float], float]) -> None:
    """Eqs 50-60 balance f r_b (m) against t with b^2 in its unit: a factor r_b / b of some ten thousand."""
    ratio = KINEMATICS.bodies.ring.base_radius / CONFIGURATION.mesh.II.backlash
    assert figure("factor by which the printed torque is off", ratio) == pytest.approx(2.7e4, rel=0.02)
