"""Mesh stiffness and pitch deviations against numbers worked out by hand from the standards' formulas.

ISO 6336-1 and ISO 1328-1 couldn't be looked up: their coefficients are quoted from memory. What is checked is that the
program computes what the formulas say, and that an older edition and plain beam theory give like numbers.
"""

import math

import pytest

from nw_gear_sim.config import load
from nw_gear_sim.kinematics import derive

CONFIGURATION = load()
KINEMATICS = derive(CONFIGURATION)

# By hand, digit by digit: z_n = z / cos^3 beta, q' (mm um/N), c' and c_gamma (N/(mm um)), K_m (N/m).
BY_HAND = {
    # z_n = 22.1618, ring gear infinite; q' = 0.04723 + 0.15551/22.1618 = 0.0542470
    # C_B = (1 + 0.5 (1.2 - 1.25)) (1 - 0) = 0.975; c' = 0.8 * 0.975 * 0.997564 / 0.0542470
    "I": {"flexibility": 0.0542470, "c_single": 14.3438, "c_mesh": 20.1776, "K_m": 1.1299e10},
    # z_n = 40.9608 and 84.9936; q' = 0.04723 + 0.0037966 + 0.0030345
    "II": {"flexibility": 0.0540610, "c_single": 14.3141, "c_mesh": 22.379, "K_m": 9.175e9},
    # z_n = 32.7908 and 214.780; q' = 0.04723 + 0.0047425 + 0.0012008; C_B = 0.975 * (1 - 0.02 * 5) = 0.8775
    "III": {"flexibility": 0.0531733, "c_single": 11.1961, "c_mesh": 16.295, "K_m": 5.948e9},
}


@pytest.mark.parametrize("name", BY_HAND)
def test_mesh_stiffness_by_hand(name: str, figure) -> None:
    """Method B of ISO 6336-1; the contact ratios are those of docs/model.md to four digits."""
    hand, stage = BY_HAND[name], KINEMATICS.stage(name)
    toothing = getattr(CONFIGURATION.toothing, name)
    contact_ratio = {"I": 1.5423, "II": 1.7512, "III": 1.6072}[name]
    rack = 0.975 * (0.9 if name == "III" else 1.0)
    single = 0.8 * rack * math.cos(toothing.helix_angle) / hand["flexibility"]
    assert single == pytest.approx(hand["c_single"], rel=2e-4)
    mesh = single * (0.75 * contact_ratio + 0.25)
    assert mesh == pytest.approx(hand["c_mesh"], rel=2e-4)
    assert mesh * 1e9 * toothing.face_width == pytest.approx(hand["K_m"], rel=3e-4)
    error = abs(stage.stiffness.transverse / hand["K_m"] - 1)
    assert figure(f"mesh stiffness {name}, off the hand number", error) < 5e-4


@pytest.mark.parametrize("name", BY_HAND)
def test_stiffness_is_that_of_steel_teeth(name: str, figure) -> None:
    """c_gamma lies in the standard's range about 20 N/(mm um), to which it rounds for spur gears of steel."""
    stage = KINEMATICS.stage(name)
    per_width = stage.stiffness.transverse / getattr(CONFIGURATION.toothing, name).face_width * 1e-9
    assert 14 < figure(f"c_gamma {name}, N/(mm um)", per_width) < 25


# Diameter and module (mm), accuracy grade, deviation of config/gearbox.yaml (um); the third gear is the largest.
PITCH = {"I": (2554.22, 28, 6, 26.5), "II": (1338.55, 16, 5, 12.7), "III": (1544.72, 10, 5, 10.5)}


@pytest.mark.parametrize("name", PITCH)
def test_pitch_deviation_by_hand(name: str) -> None:
    """ISO 1328-1:2013: f_pt = (0.001 d + 0.4 m_n + 5) sqrt(2)^(A - 5) um; the amplitude of the error is half of it."""
    diameter, module, grade, quoted = PITCH[name]
    pair = KINEMATICS.stage(name).pair
    assert 2e3 * pair.driver.reference_radius == pytest.approx(diameter, abs=0.01)
    deviation = (0.001 * diameter + 0.4 * module + 5) * math.sqrt(2) ** (grade - 5)
    assert deviation == pytest.approx(quoted, abs=0.06)
    assert getattr(CONFIGURATION.mesh, name).error_amplitude == pytest.approx(deviation / 2 * 1e-6, rel=0.01)


@pytest.mark.parametrize("name", PITCH)
def test_pitch_deviation_in_the_older_edition(name: str, figure) -> None:
    """ISO 1328-1:1995: 0.3 (m + 0.4 sqrt d) + 4 um in grade 5, m and d being geometric means of the table's ranges."""
    ranges = {"I": ((2500, 4000), (25, 40)), "II": ((1000, 1600), (10, 16)), "III": ((1000, 1600), (6, 10))}[name]
    diameter, module = (math.sqrt(low * high) for low, high in ranges)
    older = (0.3 * (module + 0.4 * math.sqrt(diameter)) + 4) * math.sqrt(2) ** (PITCH[name][2] - 5)
    found = 2e6 * getattr(CONFIGURATION.mesh, name).error_amplitude
    assert figure(f"f_pt {name} over that of 1995", found / older) == pytest.approx(1, abs=0.1)
