"""Ratios, frequencies, phases, masses and assembly against hand calculations."""

import math

import pytest

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_sim.config import load, with_values
from nw_gear_sim.kinematics import PLANET_ANGLES, SHAFT_OF_BEARING, bearing_kind, derive

CONFIGURATION = load()
KINEMATICS = derive(CONFIGURATION)
RATED = 17.3 * 2 * math.pi / 60


def test_speeds_at_rated() -> None:
    rpm = [17.3 * KINEMATICS.shaft_ratio[shaft] for shaft in names.SHAFTS]
    assert rpm == pytest.approx([17.3, 71.559, 148.485, 972.58], rel=1e-5)
    assert KINEMATICS.total_ratio == pytest.approx(91 / 22 * 83 / 40 * 131 / 20, rel=1e-15)
    assert KINEMATICS.total_ratio == pytest.approx(56.2184, abs=5e-5)


@pytest.mark.parametrize(("stage", "frequency"), [("I", 26.2383), ("II", 98.9901), ("III", 324.192)])
def test_mesh_frequencies_at_rated(stage: str, frequency: float) -> None:
    assert KINEMATICS.mesh_frequency_hz(stage, RATED) == pytest.approx(frequency, rel=3e-6)


def test_mesh_frequencies_are_those_of_both_gears() -> None:
    """Each mesh passes as many teeth of its driven gear as of its driver."""
    for stage, shaft in zip(KINEMATICS.stages, ("planet", "sun", "output"), strict=True):
        assert stage.mesh_ratio == pytest.approx(stage.pair.driven.teeth * KINEMATICS.shaft_ratio[shaft], rel=1e-14)


def test_mesh_phases() -> None:
    """Teeth of the ring pass planet j later by 91 th_j, those of the sun, turning the other way, earlier by 40 th_j."""
    for stage, turns in (("I", -91), ("II", 40)):
        for phase, angle in zip(KINEMATICS.stage(stage).planet_phases, PLANET_ANGLES, strict=True):
            assert math.remainder(phase - turns * angle, 2 * math.pi) == pytest.approx(0, abs=1e-12)
    assert KINEMATICS.stage("III").planet_phases == (0.0,)


def test_stage_by_mesh_name() -> None:
    assert KINEMATICS.stage("II_3") is KINEMATICS.stages[1]


@pytest.mark.parametrize(("gear", "inertia", "base_mass"), [
    ("ring", None, 7261.8),
    ("planet_1", 57.89, 688.1),
    ("planet_2", 773.0, 1958.1),
    ("sun", 36.20, 394.8),
    ("herringbone_1", 1601.6, 2952.9),
    ("herringbone_2", 0.870, 68.8),
])  # fmt: skip
def test_inertias(gear: str, inertia: float | None, base_mass: float) -> None:
    body = getattr(KINEMATICS.bodies, gear)
    if inertia is not None:
        assert body.inertia == pytest.approx(inertia, rel=1.2e-3)
    assert body.base_mass == pytest.approx(base_mass, rel=1.2e-3)
    assert body.mass == getattr(CONFIGURATION.gears, gear).mass


@pytest.mark.parametrize(("gear", "stage"), [("planet_1", "I"), ("planet_2", "II"), ("sun", "II"),
                                             ("herringbone_1", "III"), ("herringbone_2", "III")])  # fmt: skip
def test_bores_leave_the_mass_of_table_2_in_steel(gear: str, stage: str) -> None:
    """Density 7850 kg/m3 between bore and reference circle over the face width gives the paper's mass."""
    wheel = getattr(CONFIGURATION.gears, gear)
    pair = KINEMATICS.stage(stage).pair
    outer = (pair.driven if gear in ("planet_1", "sun", "herringbone_2") else pair.driver).reference_radius
    steel = 7850 * math.pi * (outer**2 - wheel.bore_radius**2) * pair.face_width
    assert steel == pytest.approx(wheel.mass, rel=2e-3)


def test_ring_segments() -> None:
    ring = KINEMATICS.ring
    assert ring.mass == pytest.approx(56.90)
    assert ring.inertia == pytest.approx(0.1441, rel=1e-3)
    assert ring.radius == pytest.approx(1.3532, abs=5e-5)
    assert ring.length == pytest.approx(85.02e-3, abs=1e-5)
    assert ring.rim == pytest.approx(117.23e-3, abs=1e-5)
    assert ring.tangential == pytest.approx(1.590e11, rel=1e-3)
    assert (ring.radial, ring.axial) == pytest.approx((5.096e10, 5.096e10), rel=1e-3)
    assert ring.rotational == pytest.approx(1.820e8, rel=1e-3)
    steel = 7850 * math.pi * (CONFIGURATION.ring.outer_radius**2 - 1.277111**2) * 0.56
    assert steel == pytest.approx(5690, rel=1e-4)


@pytest.mark.parametrize("segments", [12, 25, 100, 200])
def test_ring_supports_add_up(segments: int) -> None:
    """A radial shift by d pushes segment i by d cos(phi_i): the springs together give the whole ring's stiffness."""
    ring = derive(with_values({"ring.segments": segments}, CONFIGURATION)).ring
    total = sum(ring.radial_support * math.cos(i * ring.pitch) ** 2 for i in range(segments))
    assert total == pytest.approx(5e9, rel=1e-12)
    assert ring.axial_support * segments == pytest.approx(2e9, rel=1e-12)
    assert ring.mass * segments == pytest.approx(5690, rel=1e-12)
    ratio = ring.radial_support_damping / (2 * math.sqrt(ring.radial_support * ring.mass))
    assert ratio == pytest.approx(0.01, rel=1e-12)


def test_omega_n() -> None:
    assert KINEMATICS.omega_n == pytest.approx(5286, rel=5e-4)


def test_mesh_loads_at_rated_and_torque_chain() -> None:
    """Normal forces T / (r_b cos beta_b), and the tangential force of stage I at its working pitch radius."""
    torque = {"I": 4.3e6 / 3, "II": 4.3e6 / 3 * 22 / 91, "III": 4.3e6 * 22 / 91 * 40 / 83}
    forces = []
    for stage in KINEMATICS.stages:
        pair = stage.pair
        force = torque[stage.name] / (pair.driver.base_radius * math.cos(pair.base_helix))
        driven = force * pair.driven.base_radius * math.cos(pair.base_helix)
        assert driven == pytest.approx(torque[stage.name] / pair.speed_ratio, rel=1e-14)
        forces.append(force)
    assert forces == pytest.approx([1.19727e6, 5.5536e5, 7.91857e5], rel=2e-5)
    first = KINEMATICS.stages[0].pair
    tangential = forces[0] * math.cos(first.base_helix) * math.cos(first.working_angle)
    assert tangential == pytest.approx(1.0958e6, rel=1e-4)
    assert tangential * first.driver.pitch_radius == pytest.approx(4.3e6 / 3, rel=1e-12)


def test_roller_passing() -> None:
    """28 rollers on a planet, whose cage turns at 0.44 of its speed."""
    assert KINEMATICS.roller_pass_ratio["pb1"] == pytest.approx(28 * 0.44 * 91 / 22, rel=1e-14)
    assert KINEMATICS.cage_ratio["b21"] == pytest.approx(0.42 * KINEMATICS.total_ratio, rel=1e-14)
    assert {bearing_kind(bearing) for bearing in names.BEARINGS} == set(SHAFT_OF_BEARING)


def test_omega_e_sets_the_speed() -> None:
    kinematics = derive(with_values({"excitation.omega_e": 0.17}, CONFIGURATION))
    mesh = 2 * math.pi * kinematics.mesh_frequency_hz("II", kinematics.ring_speed)
    assert mesh == pytest.approx(0.17 * kinematics.omega_n, rel=1e-12)
    assert KINEMATICS.ring_speed == pytest.approx(RATED, rel=1e-15)
    rated = 2 * math.pi * KINEMATICS.mesh_frequency_hz("II", RATED) / KINEMATICS.omega_n
    assert rated == pytest.approx(0.118, abs=5e-4)


def test_input_torque() -> None:
    assert derive(load("rattling")).input_torque == pytest.approx(0.05 * 4.3e6)


@pytest.mark.parametrize(("values", "message"), [
    ({"centre_distance.planets": 0.9}, "centre distance of stage I: expected more than"),
    ({"toothing.II.normal_module": 0.018}, "centre distance of stage II: expected more than"),
    ({"gears.sun.teeth": 41, "centre_distance.planets": 1.0}, "divisible by 3"),
    ({"gears.planet_2.teeth": 105, "gears.sun.teeth": 18}, "planets whose tip diameter is less than the distance"),
    ({"gears.planet_1.bore_radius": 0.5}, "gears.planet_1.bore_radius: expected less than"),
    ({"ring.outer_radius": 1.3}, "ring.outer_radius: expected more than the root radius"),
    ({"ring.segments": 11}, "ring.segments: expected a whole number >= 12"),
    ({"mesh.I.backlash": -1e-6}, "mesh.I.backlash: expected a number in m >= 0"),
])  # fmt: skip
def test_what_cannot_be_assembled(values: dict[str, float], message: str) -> None:
    with pytest.raises(InputError) as caught:
        with_values(values, CONFIGURATION)
    assert message in str(caught.value)
