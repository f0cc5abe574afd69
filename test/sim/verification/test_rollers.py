"""Rolling bearings against the textbook's integrals for the load's distribution over the rollers.

T. A. Harris, Rolling Bearing Analysis: with the load distribution factor eps = (1 - c / delta_r) / 2 (c: half of the
diametral clearance) the rollers carry Q = Q_max [1 - (1 - cos psi) / (2 eps)]^n, and F_r = Z Q_max J_r(eps) with
Sjoevall's integral J_r; for eps = 1/2 (no clearance) Z Q_max / F_r is 4.08 with line contact, 4.37 with point contact.
The tabulated J_r are quoted from memory (the book's line contact has n = 1.1, which the quadrature confirms); the
integrals are computed here by another quadrature.
"""

import math

import numpy as np
import pytest
import scipy.integrate

from nw_gear_common.tables import Array
from nw_gear_sim.config import load
from nw_gear_sim.kinematics import bearing_kind, derive
from nw_gear_sim.physics.bearing import Bearing, bearing_forces, bearing_law
from test.sim.gearboxes import at_rest

LINE, POINT = 10 / 9, 3 / 2
TABULATED_LINE = 1.1
STIFFNESS = 4.82e9
CLEARANCE = 50e-6
J_LINE = {0.1: 0.1268, 0.2: 0.1737, 0.3: 0.2055, 0.4: 0.2286, 0.5: 0.2453, 0.6: 0.2568}
J_POINT = {0.1: 0.1156, 0.2: 0.1590, 0.3: 0.1892, 0.4: 0.2117, 0.5: 0.2288, 0.6: 0.2416}


def sjoevall(eps: float, exponent: float) -> tuple[float, float]:
    """J_r and J_a by adaptive quadrature."""
    last = math.acos(max(1 - 2 * eps, -1.0))

    def load(psi: float) -> float:
        return max(1 - (1 - math.cos(psi)) / (2 * eps), 0.0) ** exponent

    def mean(weight) -> float:
        return (
            scipy.integrate.quad(lambda psi: load(psi) * weight(psi), 0, last, epsabs=1e-12, epsrel=1e-10)[0] / math.pi
        )

    return mean(math.cos), mean(lambda psi: 1.0)


def push(rollers: int, shift: Array, exponent: float, clearance: float = CLEARANCE, contact_angle: float = 0.0,
         cage: float = 0.0) -> Array:  # fmt: skip
    """Force on the housing."""
    bearing = Bearing(0, 1, 2, rollers, STIFFNESS, contact_angle, clearance, 0.0, 0.0)
    law, housing = bearing_law([bearing], exponent), np.zeros((1, 3))
    bearing_forces(
        law, False, np.array([[math.cos(cage), math.sin(cage)]]), shift, *np.zeros((2, law.start[-1])), housing
    )
    return housing[0]


@pytest.mark.parametrize(("table", "exponent"), [(J_LINE, TABULATED_LINE), (J_POINT, POINT)])
def test_quadrature_gives_the_tabulated_integrals(table: dict[float, float], exponent: float) -> None:
    for eps, tabulated in table.items():
        assert sjoevall(eps, exponent)[0] == pytest.approx(tabulated, abs=1.01e-4)


@pytest.mark.parametrize("exponent", [LINE, POINT])
@pytest.mark.parametrize("eps", [0.05, 0.1, 0.2, 0.3, 0.4, 0.45])
def test_radial_load_with_clearance(eps: float, exponent: float, figure) -> None:
    """Many rollers: F_r = Z Q_max J_r(eps), Q_max = K (delta_r - c)^n, delta_r = c / (1 - 2 eps)."""
    approach, rollers = CLEARANCE / (1 - 2 * eps), 500
    force = push(rollers, np.array([approach, 0.0, 0.0]), exponent)
    heaviest = STIFFNESS * (approach - CLEARANCE) ** exponent
    error = abs(force[0] / (rollers * heaviest * sjoevall(eps, exponent)[0]) - 1)
    assert figure("off Harris' integral, 500 rollers", error) < 1e-4
    assert abs(force[1]) < 1e-9 * force[0]


@pytest.mark.parametrize(("exponent", "factor"), [(LINE, 4.08), (POINT, 4.37)])
@pytest.mark.parametrize("rollers", [20, 28, 30])
def test_heaviest_roller_without_clearance(rollers: int, exponent: float, factor: float, figure) -> None:
    """Stribeck's number Z Q_max / F_r, with the gearbox's own numbers of rollers."""
    force = push(rollers, np.array([100e-6, 0.0, 0.0]), exponent, clearance=0.0)
    number = rollers * STIFFNESS * 100e-6**exponent / force[0]
    assert figure(f"Z Q_max / F_r, {rollers} rollers, n = {exponent:.3g}", number) == pytest.approx(factor, rel=3e-3)


def test_preloaded_bearing() -> None:
    """Negative clearance, all rollers loaded: eps above 1, no roller at its bound, the sum converges at once."""
    approach, preload = 20e-6, 50e-6
    eps = 0.5 * (1 + preload / approach)
    force = push(28, np.array([0.0, approach, 0.0]), LINE, clearance=-preload)
    heaviest = STIFFNESS * (approach + preload) ** LINE
    assert force[1] == pytest.approx(28 * heaviest * sjoevall(eps, LINE)[0], rel=1e-8)


@pytest.mark.parametrize("axial", [0.0, 120e-6, 300e-6])
def test_combined_load(axial: float, figure) -> None:
    """Radial and axial shift at a contact angle g: eps = (1 + (z sin g - c) / (r cos g)) / 2; thrust by J_a."""
    angle, radial, rollers = math.radians(12), 100e-6, 500
    offset = axial * math.sin(angle) - CLEARANCE
    eps = 0.5 * (1 + offset / (radial * math.cos(angle)))
    heaviest = STIFFNESS * (radial * math.cos(angle) + offset) ** LINE
    j_radial, j_axial = sjoevall(eps, LINE)
    force = push(rollers, np.array([radial, 0.0, axial]), LINE, contact_angle=angle)
    expected = rollers * heaviest * np.array([j_radial * math.cos(angle), 0.0, j_axial * math.sin(angle)])
    assert force == pytest.approx(expected, rel=2e-4, abs=1e-6 * expected[0])


def test_pure_thrust() -> None:
    """All rollers alike: F_a = Z K (z sin g - c)^n sin g, no radial force."""
    angle, axial = math.radians(12), 400e-6
    force = push(28, np.array([0.0, 0.0, axial]), LINE, contact_angle=angle)
    load = STIFFNESS * (axial * math.sin(angle) - CLEARANCE) ** LINE
    assert force == pytest.approx([0.0, 0.0, 28 * load * math.sin(angle)], rel=1e-9, abs=1e-3)


@pytest.mark.parametrize("rollers", [20, 28, 30])
def test_force_varies_while_rollers_pass(rollers: int, figure) -> None:
    """At a fixed shift the radial force repeats with each roller and swings about the integral by a few per cent."""
    eps = 0.35
    shift = np.array([CLEARANCE / (1 - 2 * eps), 0.0, 0.0])
    pitch = 2 * math.pi / rollers
    cages = np.arange(64) / 64 * pitch
    force = np.array([push(rollers, shift, LINE, cage=cage)[0] for cage in cages])
    mean = rollers * STIFFNESS * (shift[0] - CLEARANCE) ** LINE * sjoevall(eps, LINE)[0]
    assert force.mean() == pytest.approx(mean, rel=1e-3)
    assert 1e-4 < figure(f"ripple of {rollers} rollers", np.ptp(force) / mean) < 0.05
    assert push(rollers, shift, LINE, cage=pitch)[0] == pytest.approx(force[0], rel=1e-9)


@pytest.mark.parametrize("axial", [0.0, 500e-6])
def test_bearing_has_a_potential(axial: float) -> None:
    """Force = slope of sum K delta^(n+1) / (n+1), an independent sum: no work is gained around a loop."""
    angle, bearing = math.radians(12), 28

    def energy(shift: Array) -> float:
        psi = 2 * math.pi * np.arange(bearing) / bearing + 0.3
        squeeze = (shift[0] * np.cos(psi) + shift[1] * np.sin(psi)) * math.cos(angle) + shift[2] * math.sin(angle)
        return float(np.sum(np.maximum(squeeze - CLEARANCE, 0) ** (LINE + 1)) * STIFFNESS / (LINE + 1))

    shift = np.array([80e-6, -110e-6, axial])
    force = push(bearing, shift, LINE, contact_angle=angle, cage=0.3)
    for k, step in enumerate(1e-8 * np.eye(3)):
        assert (energy(shift + step) - energy(shift - step)) / 2e-8 == pytest.approx(force[k], rel=1e-5)


def test_palmgrens_contact() -> None:
    """A roller of 100 mm under 10 kN: each contact gives by delta = 3.84e-5 Q^0.9 / l^0.8 mm (Palmgren, N and mm).

    The inverse of Q = 8.06e4 l^(8/9) delta^(10/9), both quoted from memory; the two agree.
    """
    load_per_roller, length = 1e4, 100.0
    one = 3.84e-5 * load_per_roller**0.9 / length**0.8
    stiffness = derive(load()).roller_stiffness["pb1"]
    assert (load_per_roller / stiffness) ** 0.9 == pytest.approx(2 * one * 1e-3, rel=2e-3)


def test_bearings_of_the_gearbox_at_rest(figure) -> None:
    """All ten bearings under rated load: force on the housing by Harris' integrals from the shift of the shaft alone.

    28, 30 and 20 rollers instead of many leave a ripple of half a per cent.
    """
    gearbox, found = at_rest()
    configuration = load()
    worst = 0.0
    for node, housing in zip(gearbox.layout.bearings(), gearbox.housing, strict=True):
        data = getattr(configuration.bearings, bearing_kind(node.name))
        angle = data.contact_angle
        shift = np.array([found.q[node.x], found.q[node.y]])
        axial = found.q[node.z] if node.z >= 0 else 0.0
        radial = float(np.linalg.norm(shift))
        offset = axial * math.sin(angle) - data.clearance
        eps = 0.5 * (1 + offset / (radial * math.cos(angle)))
        heaviest = gearbox.kinematics.roller_stiffness[bearing_kind(node.name)]
        heaviest *= (radial * math.cos(angle) + offset) ** LINE
        j_radial, j_axial = sjoevall(eps, LINE)
        along = data.rollers * heaviest * j_radial * math.cos(angle) * shift / radial
        expected = np.array([*along, data.rollers * heaviest * j_axial * math.sin(angle)])
        worst = max(worst, float(np.linalg.norm(housing - expected) / np.linalg.norm(housing)))
    assert figure("bearing forces at rest, off Harris' integrals", worst) < 0.01
