"""The nondimensional form: hand numbers, both ways, and the equations themselves in it."""

from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st

from nw_gear_common.errors import InputError
from nw_gear_sim import nondimensional
from nw_gear_sim.config import from_yaml, load, to_yaml, with_values
from nw_gear_sim.kinematics import derive
from nw_gear_sim.linear import linearise
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.simulation import Simulation
from test.sim.gearboxes import RATED_SPEED, RATED_TORQUE, at_rest

BASE = load()
KINEMATICS = derive(BASE)
SCALES = nondimensional.scales(BASE, KINEMATICS)


def test_scales_by_hand() -> None:
    """M_e = I_p I_s / (I_p r_s^2 + I_s r_p^2) = 328.5 kg, omega_n = sqrt(9.18e9 / 328.5) = 5285 rad/s (841 Hz)."""
    planet, sun = 773.0 / 0.628329**2, 36.20 / 0.302809**2
    effective = planet * sun / (planet + sun)
    assert effective == pytest.approx(328.5, rel=1e-3)
    assert SCALES.frequency == pytest.approx(np.sqrt(9.18e9 / effective), rel=1e-3)
    assert SCALES.frequency == pytest.approx(5284.6, rel=1e-4)
    assert SCALES.length == 45e-6
    assert SCALES.time == pytest.approx(1.8923e-4, rel=1e-4)


def test_numbers_of_the_equations_by_hand() -> None:
    derived = nondimensional.derived(BASE, KINEMATICS)
    assert derived["f_g"] == pytest.approx(7.8e-3, rel=2e-3)
    assert derived["k_m_II"] == pytest.approx(1, rel=1e-12)
    assert derived["zeta_II"] == pytest.approx(0.05, rel=1e-12)
    assert derived["omega_II"] == pytest.approx(621.97 / 5284.6, rel=1e-4)
    assert derived["k_m_I"] == pytest.approx(1.13e10 / 628.5 / 5284.6**2, rel=3e-3)
    assert derived["k_m_III"] == pytest.approx(5.95e9 / 67.2 / 5284.6**2, rel=3e-3)
    ring = 4.3e6 / (1.199749 * 7261.8 * 45e-6 * 5284.6**2)
    assert derived["t_in"] == pytest.approx(ring, rel=1e-3)


def test_parameters_by_hand() -> None:
    found = nondimensional.parameters(BASE, KINEMATICS)
    assert found["mesh.I.backlash"] == pytest.approx(55 / 45)
    assert found["bearings.sb.clearance"] == pytest.approx(40 / 45)
    assert found["shafts.sun_radial"] == pytest.approx(4e9 / (440 * 5284.62**2), rel=1e-5)
    assert found["bearings.b21.damping"] == pytest.approx(5e4 / (2 * 40 * 5284.62), rel=1e-5)
    assert found["torsion.sun"] == pytest.approx(1.47e8 / (36.20 * 5284.62**2), rel=2e-3)
    assert found["ring.axial_support"] == pytest.approx(2e9 / (5690 * 5284.62**2), rel=1e-5)
    assert "bearings.sb.stiffness" not in found  # it isn't set


def test_equations_in_nondimensional_form() -> None:
    """q^'' + 2 zeta q^' + k q^ = 0, each row over its own mass: omega_n times its eigenvalues are those in SI."""
    gearbox, found = at_rest()
    linear = linearise(gearbox, found.q)
    k = linear.stiffness / SCALES.stiffness(linear.mass)[:, None]
    zeta = linear.damping / SCALES.damping(linear.mass)[:, None]
    size = len(k)
    pure = scipy.linalg.eigvals(np.block([[np.zeros((size, size)), np.eye(size)], [-k, -2 * zeta]]))
    square = np.outer(linear.mass**0.5, linear.mass**0.5)
    K, C = linear.stiffness / square, linear.damping / square
    si = scipy.linalg.eigvals(np.block([[np.zeros((size, size)), np.eye(size)], [-K, -C]]))
    assert np.sort(np.abs(pure)) * SCALES.frequency == pytest.approx(np.sort(np.abs(si)), rel=1e-7)


def test_forces_in_nondimensional_form() -> None:
    """Acceleration over b omega_n^2 is F / (m b omega_n^2); weight gives f_g on every body that falls."""
    gearbox, _ = at_rest()
    node = gearbox.layout.nodes["sb"]
    weight = gearbox.laws.weight[node.y]
    assert -weight / SCALES.force(gearbox.mass[node.y]) == pytest.approx(7.806e-3, rel=1e-3)
    assert SCALES.force(2.0) / 2.0 == SCALES.acceleration
    assert SCALES.velocity * SCALES.frequency == pytest.approx(SCALES.acceleration)


@given(st.sampled_from(sorted(nondimensional.UNITS)), st.floats(0.3, 3.0))
def test_parameters_there_and_back(key: str, factor: float) -> None:
    """A pure number goes in, the same comes out; all other parameters stay."""
    value = factor * nondimensional.parameters(BASE, KINEMATICS).get(key, 1.0)
    changed = with_values({f"nondimensional.{key}": value}, BASE)
    kinematics = derive(changed)
    assert nondimensional.scales(changed, kinematics) == SCALES
    found = nondimensional.parameters(changed, kinematics)
    assert found[key] == pytest.approx(value, rel=1e-12)
    before = nondimensional.parameters(BASE, KINEMATICS)
    assert {k: v for k, v in found.items() if k != key} == {k: v for k, v in before.items() if k != key}


def test_signals_there_and_back() -> None:
    simulation = Simulation(BASE, Drive(RATED_SPEED, RATED_SPEED, RATED_TORQUE, RATED_TORQUE), start="zero")
    block = simulation.advance(16, Drive(RATED_SPEED, RATED_SPEED, RATED_TORQUE, RATED_TORQUE))
    pure = nondimensional.signals(vars(block), BASE, KINEMATICS)
    assert pure["time"][1] == pytest.approx(5284.619 / 5120, rel=1e-6)
    assert pure["x"] == pytest.approx(block.x / 45e-6, rel=1e-14)
    assert pure["v"][3] == pytest.approx(block.v[3] / (45e-6 * 5284.619), rel=1e-6)
    assert pure["force"][3, 3:6] == pytest.approx(block.force[3, 3:6] / (328.5 * 45e-6 * 5284.6**2), rel=1e-3)
    assert pure["bearing_force"][3, 6] == pytest.approx(block.bearing_force[3, 6] / (150 * 45e-6 * 5284.6**2), rel=1e-4)
    back = nondimensional.signals(pure, BASE, KINEMATICS, back=True)
    for name, value in vars(block).items():
        assert back[name] == pytest.approx(value, rel=1e-14)
    with pytest.raises(InputError, match="speeed"):
        nondimensional.signals({"speeed": block.time}, BASE, KINEMATICS)


def test_a_file_in_nondimensional_form(tmp_path: Path) -> None:
    """The scales are those of the file itself, whatever it changes in them; what comes out is plain SI."""
    path = tmp_path / "pure.yaml"
    path.write_text(
        "mesh: {II: {backlash: 90 um}}\n"
        "nondimensional:\n"
        "  mesh: {I: {backlash: 1.5, error_amplitude: 0.25}}\n"
        "  bearings: {sb: {clearance: 1, damping: 0.1}}\n"
        "  gravity: {acceleration: 0.004}\n"
        "  operation: {ring_speed: 3.4e-4}\n"
    )
    found = load(path)
    kinematics = derive(found)
    assert found.mesh.I.backlash == pytest.approx(135e-6)
    assert found.mesh.I.error_amplitude == pytest.approx(22.5e-6)
    assert found.bearings.sb.clearance == pytest.approx(90e-6)
    assert found.bearings.sb.damping == pytest.approx(0.1 * 2 * 150 * kinematics.omega_n)
    assert found.gravity.acceleration == pytest.approx(0.004 * 90e-6 * kinematics.omega_n**2)
    assert found.operation.ring_speed == pytest.approx(3.4e-4 * kinematics.omega_n)
    assert from_yaml(to_yaml(found)) == found


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "nondimensional: {mesh: {II: {backlash: 1}}}",
            "line 1: nondimensional.mesh.II.backlash: expected a parameter that has a",
        ),
        ("nondimensional: {mesh: {I: {backlash: 1 um}}}", "expected a number, got '1 um'"),
        ("nondimensional: {mesh: {I: {backlash: null}}}", "expected a number, got None"),
        ("nondimensional: {mesh: {I: {backlash: -1}}}", "got -1, which is -4.5e-05"),
        ("nondimensional: {mesh: {I: {slack: 1}}}", "expected one of backlash, error_amplitude"),
        ("nondimensional: {numerics: {step: 1}}", "got 'numerics.step'"),
        ("nondimensional: 3", "expected a mapping of keys to values"),
        ("mesh: {I: {backlash: 1 um}}\nnondimensional: {mesh: {I: {backlash: 1}}}", "each key once"),
        ("mesh: {II: {backlash: 0 um}}\nnondimensional: {mesh: {I: {backlash: 1}}}", "expected more than 0, the unit"),
    ],
)
def test_what_a_file_may_not_say(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "pure.yaml"
    path.write_text(text)
    with pytest.raises(InputError) as error:
        load(path)
    assert message in str(error.value)
    assert str(path) in str(error.value) or "mesh.II.backlash" in str(error.value)
    assert "\n" not in str(error.value)
