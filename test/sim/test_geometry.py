"""Gear geometry against hand calculations and against what defines it."""

import math
from dataclasses import replace

import pytest

from nw_gear_common.errors import InputError
from nw_gear_sim.config import load
from nw_gear_sim.geometry import GearGeometry, PairGeometry, involute, solve_pair
from nw_gear_sim.kinematics import derive

CONFIGURATION = load()
PAIRS = {stage.name: stage.pair for stage in derive(CONFIGURATION).stages}

# Hand calculation with ISO 21771; lengths in mm, angles in degrees, driver first.
HAND = {
    "I": {
        "reference_radius": (1277.111, 308.752),
        "base_radius": (1199.749, 290.049),
        "transverse_angle": 20.0450,
        "working_angle": 23.480,
        "base_helix": 3.7584,
        "reference_centre_distance": 968.359,
        "base_pitch": 82.838,
        "contact_ratio": 1.542,
        "overlap_ratio": 0.4441,
        "approach": 61.09,
        "recess": 66.67,
    },
    "II": {
        "reference_radius": (669.277, 322.543),
        "base_radius": (628.329, 302.809),
        "transverse_angle": 20.1462,
        "working_angle": 20.146,
        "base_helix": 6.7637,
        "reference_centre_distance": 991.821,
        "base_pitch": 47.565,
        "contact_ratio": 1.751,
        "overlap_ratio": 1.0223,
        "approach": 40.30,
        "recess": 43.00,
    },
    "III": {
        "reference_radius": (772.362, 117.918),
        "base_radius": (736.475, 112.439),
        "transverse_angle": 17.5344,
        "working_angle": 17.534,
        "base_helix": 30.7880,
        "reference_centre_distance": 890.280,
        "base_pitch": 35.324,
        "contact_ratio": 1.607,
        "overlap_ratio": 3.078,
        "approach": 25.47,
        "recess": 31.30,
    },
}
ANGLES = ("transverse_angle", "working_angle", "base_helix")
NUMBERS = ("contact_ratio", "overlap_ratio")


def in_hand_units(name: str, value: float) -> float:
    if name in ANGLES:
        return math.degrees(value)
    return value if name in NUMBERS else value * 1e3


@pytest.mark.parametrize(("stage", "name"), [(stage, name) for stage, values in HAND.items() for name in values])
def test_hand_numbers(stage: str, name: str) -> None:
    pair, expected = PAIRS[stage], HAND[stage][name]
    if isinstance(expected, tuple):
        found = tuple(in_hand_units(name, getattr(gear, name)) for gear in (pair.driver, pair.driven))
        assert found == pytest.approx(expected, abs=6e-4)
    else:
        digits = 10.0 ** -len(f"{expected!r}".partition(".")[2])
        assert in_hand_units(name, getattr(pair, name)) == pytest.approx(expected, abs=0.6 * max(digits, 5e-4))


@pytest.mark.parametrize("stage", PAIRS)
def test_pitch_circles_touch_and_roll(stage: str) -> None:
    pair = PAIRS[stage]
    sign = -1 if pair.internal else 1
    assert pair.driver.pitch_radius + sign * pair.driven.pitch_radius == pytest.approx(pair.centre_distance, rel=1e-12)
    assert pair.driver.pitch_radius / pair.driven.pitch_radius == pytest.approx(pair.driver.teeth / pair.driven.teeth)


@pytest.mark.parametrize("stage", PAIRS)
def test_tooth_fills_the_space_at_the_pitch_circles(stage: str) -> None:
    """Profile shifts are those without backlash: the teeth's arcs on the working pitch circles add up to the pitch."""
    pair = PAIRS[stage]
    alpha_n = getattr(CONFIGURATION.toothing, stage).pressure_angle
    widening = involute(pair.transverse_angle) - involute(pair.working_angle)

    def half_angle(gear: GearGeometry, sign: int) -> float:
        return (math.pi / 2 + sign * 2 * gear.profile_shift * math.tan(alpha_n)) / gear.teeth + sign * widening

    thickness = 2 * pair.driven.pitch_radius * half_angle(pair.driven, 1)
    thickness += 2 * pair.driver.pitch_radius * half_angle(pair.driver, -1 if pair.internal else 1)
    pitch = 2 * math.pi * pair.driven.pitch_radius / pair.driven.teeth
    assert thickness == pytest.approx(pitch, rel=1e-12)


@pytest.mark.parametrize(("distance", "working_angle", "shift", "contact_ratio"), [
    (991.82, 23.480, 0.9085, 1.542),
    (980.09, 21.847, 0.4373, 1.642),
    (968.3589, 20.045, 0.0, 1.717),
])  # fmt: skip
def test_stage_one_at_other_centre_distances(
    distance: float, working_angle: float, shift: float, contact_ratio: float
) -> None:
    pair = solve_pair("I", CONFIGURATION.toothing.I, (91, 22), distance / 1e3, ring=True)
    assert math.degrees(pair.working_angle) == pytest.approx(working_angle, abs=1e-3)
    assert pair.driver.profile_shift - pair.driven.profile_shift == pytest.approx(shift, abs=2e-4)
    assert pair.contact_ratio == pytest.approx(contact_ratio, abs=1e-3)


@pytest.mark.parametrize(("distance", "shift", "contact_ratio"), [(980.09, -0.6995, 1.928), (968.36, -1.3251, 2.223)])
def test_stage_two_at_other_centre_distances(distance: float, shift: float, contact_ratio: float) -> None:
    toothing = replace(CONFIGURATION.toothing.II, pinion_shift=shift / 2)
    pair = solve_pair("II", toothing, (83, 40), distance / 1e3)
    assert pair.driver.profile_shift + pair.driven.profile_shift == pytest.approx(shift, abs=2e-4)
    assert pair.contact_ratio == pytest.approx(contact_ratio, abs=0.05)


def test_spur_pair_against_textbook_contact_ratio() -> None:
    """Two spur gears of 20 degrees: eps = (sum sqrt(ra^2 - rb^2) - a sin alpha) / p_b, here for 20 and 40 teeth."""
    toothing = replace(CONFIGURATION.toothing.II, helix_angle=0.0, normal_module=1.0, pinion_shift=0.0)
    pair = solve_pair("test", toothing, (40, 20), None)
    alpha = math.radians(20)
    outside = math.sqrt(11**2 - (10 * math.cos(alpha)) ** 2) + math.sqrt(21**2 - (20 * math.cos(alpha)) ** 2)
    assert pair.contact_ratio == pytest.approx(
        (outside - 30 * math.sin(alpha)) / (math.pi * math.cos(alpha)), rel=1e-12
    )
    assert pair.overlap_ratio == 0.0


def test_too_small_centre_distance_is_refused() -> None:
    with pytest.raises(InputError, match=r"centre distance of stage II: expected more than 0\.931138 m.*, got 0\.9 m"):
        solve_pair("II", CONFIGURATION.toothing.II, (83, 40), 0.9)


def test_too_large_centre_distance_is_refused() -> None:
    with pytest.raises(InputError, match="stage I"):
        solve_pair("I", CONFIGURATION.toothing.I, (91, 22), 1.3, ring=True)


def test_ring_smaller_than_planet_is_refused() -> None:
    with pytest.raises(InputError, match="more than the planet's 22, got 22"):
        solve_pair("I", CONFIGURATION.toothing.I, (22, 22), 0.1, ring=True)


def test_pair_is_immutable() -> None:
    pair: PairGeometry = PAIRS["I"]
    with pytest.raises(AttributeError):
        pair.approach = 1.0  # type: ignore[misc]
