"""The rotor against Eq 2 of the paper and the closed form of its lag."""

import math
from dataclasses import dataclass

import pytest

from nw_gear_sim.physics.rotor import STANDSTILL, Rotor, operating_point


@dataclass(frozen=True)
class Turbine:
    """Table 1 of the paper; cut-in and time constant are guesses."""

    rated_torque: float = 4.3e6
    rated_speed: float = 17.3 * math.pi / 30
    rated_wind: float = 11.5
    cut_in_wind: float = 3.0
    cut_out_wind: float = 25.0
    time_constant: float = 8.0


TURBINE = Turbine()


def test_rated_power_of_the_paper() -> None:
    speed, torque = operating_point(TURBINE, 11.5)
    assert (speed, torque) == (TURBINE.rated_speed, 4.3e6)
    assert speed * torque == pytest.approx(7.790e6, rel=1e-4)


@pytest.mark.parametrize(
    ("wind", "speed_share", "torque_share"),
    [
        (0.0, 0, 0),
        (math.nextafter(3.0, 0.0), 0, 0),
        (3.0, 3 / 11.5, (3 / 11.5) ** 2),
        (5.75, 0.5, 0.25),
        (math.nextafter(11.5, 0.0), 1, 1),
        (18.0, 1, 1),
        (math.nextafter(25.0, 0.0), 1, 1),
        (25.0, 0, 0),
        (40.0, 0, 0),
    ],
)
def test_operating_point(wind: float, speed_share: float, torque_share: float) -> None:
    speed, torque = operating_point(TURBINE, wind)
    assert speed == pytest.approx(speed_share * TURBINE.rated_speed)
    assert torque == pytest.approx(torque_share * TURBINE.rated_torque)


def test_a_rotor_starts_in_its_steady_state_and_stays_there() -> None:
    rotor = Rotor(TURBINE, 9.0)
    drive = rotor.advance(9.0, 100.0)
    assert drive.speed_start == drive.speed_end == rotor.speed == pytest.approx(9 / 11.5 * TURBINE.rated_speed)
    assert drive.torque_start == drive.torque_end == rotor.torque


def test_speed_after_a_step_in_the_wind() -> None:
    rotor = Rotor(TURBINE, 5.0)
    old, new = 5 / 11.5 * TURBINE.rated_speed, 10 / 11.5 * TURBINE.rated_speed
    drive = rotor.advance(10.0, 8.0)  # one time constant
    assert drive.speed_start == pytest.approx(old)
    assert drive.speed_end == pytest.approx(new - (new - old) / math.e)
    assert drive.torque_start == pytest.approx((5 / 11.5) ** 2 * 4.3e6)
    assert drive.torque_end == pytest.approx((10 / 11.5) ** 2 * 4.3e6)


def test_the_lag_does_not_depend_on_how_time_is_cut() -> None:
    whole, cut = Rotor(TURBINE, 4.0), Rotor(TURBINE, 4.0)
    whole.advance(11.0, 3.0)
    for _ in range(300):
        cut.advance(11.0, 0.01)
    assert cut.speed == pytest.approx(whole.speed, rel=1e-12)
    assert cut.torque == whole.torque


def test_intervals_join_without_a_jump() -> None:
    rotor = Rotor(TURBINE, 6.0)
    last = rotor.advance(7.0, 0.1)
    for wind in (7.5, 12.0, 26.0, 2.0, 8.0):
        drive = rotor.advance(wind, 0.1)
        assert (drive.speed_start, drive.torque_start) == (last.speed_end, last.torque_end)
        last = drive


def test_a_rotor_without_wind_comes_to_an_exact_standstill() -> None:
    rotor = Rotor(TURBINE, 11.5)
    limit = TURBINE.time_constant * math.log(1 / STANDSTILL)
    rotor.advance(1.0, 0.999 * limit)
    assert rotor.speed > 0.0
    assert rotor.torque == 0.0
    drive = rotor.advance(1.0, 0.002 * limit)
    assert drive.speed_end == rotor.speed == 0.0
    assert rotor.advance(5.0, 1.0).speed_end > 0.0


def test_small_speeds_are_kept_while_the_rotor_starts() -> None:
    rotor = Rotor(TURBINE, 0.0)
    rotor.advance(3.0, 1e-3)
    assert 0.0 < rotor.speed < STANDSTILL * TURBINE.rated_speed


def test_without_a_time_constant_the_speed_follows_at_once() -> None:
    rotor = Rotor(Turbine(time_constant=0.0), 5.0)
    assert rotor.advance(10.0, 1e-6).speed_end == pytest.approx(10 / 11.5 * TURBINE.rated_speed)
