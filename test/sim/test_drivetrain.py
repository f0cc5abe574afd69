"""Load cases against closed forms and conservation of energy, and what they do to the gearbox."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.config import load, with_values
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.drivetrain import SCENARIOS, DriveTrain
from nw_gear_sim.physics.rotor import operating_point
from nw_gear_sim.physics.wind_gust import GustWind
from nw_gear_sim.simulation import Simulation
from test.sim.gearboxes import RATED_SPEED, RATED_TORQUE, rigid_rotation

CONFIGURATION = load()
TICK = 0.0125
WIND = 12.0
REST = Drive(0.0, 0.0, 0.0, 0.0)
SHORT = {  # a light rotor under a strong brake: each case is over within a few seconds
    "rotor_inertia": 1e7,
    "start_time": 0.5,
    "connect_time": 0.5,
    "shutdown_time": 1.0,
    "pitch_time": 0.5,
    "brake_torque": 2e7,
    "brake_time": 0.2,
    "brake_speed": 1.0,
}


def configured(**values: float) -> Configuration:
    return with_values({f"drivetrain.{name}": value for name, value in values.items()}, CONFIGURATION)


def driven(scenario: str, *, event: float = 0.5, wind: float = WIND, **values: float) -> DriveTrain:
    configuration = configured(**values)
    return DriveTrain(configuration.turbine, configuration.drivetrain, scenario, event, wind)


def course(train: DriveTrain, until: float, *, wind: float = WIND, tick: float = TICK) -> Array:
    """Time, speed and torque of the ring tick by tick until a time, (n, 3)."""
    rows = [(train.time, train.drive.speed_end, train.drive.torque_end)]
    while train.time < until - 1e-9:
        drive = train.advance(wind, tick)
        assert (drive.speed_start, drive.torque_start) == rows[-1][1:]
        rows.append((train.time, drive.speed_end, drive.torque_end))
    return np.array(rows)


@pytest.mark.parametrize("wind", [4.0, 9.0, 11.5, 20.0])
def test_a_steady_start_stays_steady(wind: float) -> None:
    """At the point of Eq 2 the generator's law asks just the torque that the wind gives."""
    train = driven("shutdown", event=100.0, wind=wind)
    speed, torque = operating_point(CONFIGURATION.turbine, wind)
    found = course(train, 20.0, wind=wind)
    assert found[:, 1] == pytest.approx(speed, rel=1e-12)
    assert found[:, 2] == pytest.approx(torque, rel=1e-12)
    assert train.phase == "running"
    assert train.events() == {}


def test_a_loss_of_the_grid_against_the_matrix_exponential() -> None:
    """d(x, w_1, w_2)/dt with a torque of the wind that falls linearly above the steady speed n, and no generator.

    (The rotor never falls below n while the wind drives, so that the system is linear.)
    """
    values = {"trip_time": 0.0, "pitch_delay": 5.0}
    train, p = driven("grid_loss", **values), configured(**values).drivetrain
    found = course(train, 3.0)
    k, rotor, generator = p.shaft_stiffness, p.rotor_inertia, p.generator_inertia
    c = 2 * p.shaft_damping_ratio * math.sqrt(k * rotor * generator / (rotor + generator))
    slope = RATED_TORQUE / (RATED_SPEED * (p.runaway_ratio - 1))
    matrix = np.zeros((4, 4))  # the last entry is 1, times the constant torque
    matrix[0] = [0, 1, -1, 0]
    matrix[1] = [-k / rotor, -(c + slope) / rotor, c / rotor, (RATED_TORQUE + slope * RATED_SPEED) / rotor]
    matrix[2] = [k / generator, c / generator, -c / generator, 0]
    at_first = np.array([RATED_TORQUE / k, RATED_SPEED, RATED_SPEED, 1.0])
    after = found[found[:, 0] > 0.5]
    exact = np.array([expm(matrix * (time - 0.5)) @ at_first for time in after[:, 0]])
    torque = k * exact[:, 0] + c * (exact[:, 1] - exact[:, 2])
    assert after[:, 1] == pytest.approx(exact[:, 2], rel=1e-8)
    assert after[:, 2] == pytest.approx(torque, abs=1e-7 * RATED_TORQUE)
    assert np.min(torque) < -0.6 * RATED_TORQUE


def test_frequency_and_decay_of_the_free_oscillation() -> None:
    """f = sqrt(k (1/J_1 + 1/J_2)) / 2 pi, damped; the extremes of the slip fall by exp(-pi zeta / sqrt(1 - zeta^2))."""
    values = {"trip_time": 0.0, "pitch_delay": 30.0, "runaway_ratio": 100.0, "shaft_damping_ratio": 0.02}
    train, p = driven("grid_loss", event=0.0, **values), configured(**values).drivetrain
    rows = []
    while train.time < 4.0:
        train.advance(WIND, 1e-3)
        state = train.state()
        rows.append((train.time, float(state["rotor_speed"]) - float(state["ring_speed"])))
    time, slip = np.array(rows).T
    turned = np.flatnonzero(np.sign(slip[1:]) != np.sign(slip[:-1]))
    zeros = time[turned] - slip[turned] * 1e-3 / (slip[turned + 1] - slip[turned])
    f = math.sqrt(p.shaft_stiffness * (1 / p.rotor_inertia + 1 / p.generator_inertia)) / (2 * math.pi)
    root = math.sqrt(1 - 0.02**2)
    assert f == pytest.approx(2.33, abs=0.005)
    assert np.diff(zeros) == pytest.approx(0.5 / (f * root), rel=2e-4)
    extremes = np.array([np.max(np.abs(part)) for part in np.split(slip, turned + 1)[:-1]])
    assert extremes[1:] / extremes[:-1] == pytest.approx(math.exp(-math.pi * 0.02 / root), rel=1e-3)


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_the_energy_balances(scenario: str) -> None:
    """Stored = wind - generator - brake - damping, over a whole case in an unsteady wind."""
    train = driven(scenario)
    at_first = train.energies()["stored"]
    for tick in range(4800):
        train.advance(WIND + 4 * math.sin(0.01 * tick), TICK)
    found = train.energies()
    gained = found["wind"] - found["generator"] - found["brake"] - found["shaft"]
    most = max(abs(value) for value in found.values())
    assert found["stored"] - at_first == pytest.approx(gained, abs=1e-6 * most)
    assert found["shaft"] > 0.0
    assert found["stored"] == 0.0 if train.phase == "standstill" else found["stored"] > 0.0


def test_start_up() -> None:
    """From an exact standstill to the point of Eq 2; at constant torque the speed rises as T t / (J_1 + J_2)."""
    train, p = driven("start_up", start_time=0.0), CONFIGURATION.drivetrain
    found = course(train, 60.0)
    time, speed, torque = found.T
    assert not np.any(found[time <= 0.5, 1:])
    events = train.events()
    assert list(events) == ["event", "generator_on", "running"]
    assert events["event"] == 0.5
    inertia = p.rotor_inertia + p.generator_inertia
    assert events["generator_on"] - 0.5 == pytest.approx(RATED_SPEED * inertia / RATED_TORQUE, rel=3e-3)
    assert events["running"] - events["generator_on"] == pytest.approx(p.connect_time, abs=1e-9)
    carried = torque[(time > 10.0) & (time < events["generator_on"])]
    assert carried == pytest.approx(RATED_TORQUE * p.generator_inertia / inertia, rel=2e-3)
    assert np.max(speed) < 1.1 * RATED_SPEED
    assert speed[-1] == pytest.approx(RATED_SPEED, rel=1e-3)
    assert torque[-1] == pytest.approx(RATED_TORQUE, rel=1e-3)


def test_momentum_on_a_ramp() -> None:
    """J_1 w_1 + J_2 w_2 is the integral of the wind's torque, T t^2 / (2 t_ramp) while the pitch moves."""
    train, p = driven("start_up", feathered_drag=0.0), CONFIGURATION.drivetrain
    for _ in range(240):
        train.advance(WIND, TICK)
        state, since = train.state(), max(0.0, train.time - 0.5)
        momentum = p.rotor_inertia * float(state["rotor_speed"]) + p.generator_inertia * float(state["ring_speed"])
        assert momentum == pytest.approx(0.5 * RATED_TORQUE * since**2 / p.start_time, rel=1e-9)


def test_a_step_of_the_wind_above_the_rated_one() -> None:
    """The pitch follows with v_p = v - (v - v_e) exp(-t / tau); the torque (v / v_p)^2 T_e less T_e turns the rotor up.

    (So small a slope over the speed, and so short a time, that the torque over the speed counts for 2e-4.)
    """
    train, p = driven("shutdown", event=100.0, wind=11.5, runaway_ratio=100.0), CONFIGURATION.drivetrain
    inertia, lag, wind = p.rotor_inertia + p.generator_inertia, p.pitch_lag, 14.0
    for _ in range(2000):
        train.advance(wind, 1e-3)
    state = train.state()
    momentum = p.rotor_inertia * float(state["rotor_speed"]) + p.generator_inertia * float(state["ring_speed"])
    time = np.linspace(0.0, 2.0, 20001)
    surplus = (wind / (wind - (wind - 11.5) * np.exp(-time / lag))) ** 2 - 1.0
    gained = RATED_TORQUE * float(np.sum(0.5 * (surplus[1:] + surplus[:-1]))) * 1e-4
    assert momentum - RATED_SPEED * inertia == pytest.approx(gained, rel=3e-3)
    assert float(state["pitched_wind"]) == pytest.approx(wind - (wind - 11.5) * math.exp(-2.0 / lag), rel=1e-9)


def test_a_gust_makes_a_loss_of_the_grid_worse() -> None:
    """An extreme operating gust above rated wind, and the loss while it rises, against the loss in steady wind."""
    fastest = []
    for size in (0.0, 5.29):
        train, gust = driven("grid_loss", event=7.0, wind=14.0), GustWind(14.0, size, 2.0, 0.0)
        speeds = [train.advance(gust.at(train.time + TICK), TICK).speed_end for _ in range(1200)]
        fastest.append(max(speeds) / RATED_SPEED)
    assert fastest[0] > 1.05
    assert fastest[1] > fastest[0] + 0.01


def test_a_start_without_wind_waits_for_it() -> None:
    train = driven("start_up", wind=1.0)
    assert not np.any(course(train, 5.0, wind=1.0)[:, 1:])
    assert train.phase == "starting"
    course(train, 60.0, wind=8.0)
    assert train.phase == "running"


def test_ramps_take_their_time() -> None:
    p = CONFIGURATION.drivetrain
    stop, trip, loss = driven("shutdown"), driven("emergency_stop"), driven("grid_loss")
    for train in (stop, trip, loss):
        course(train, 12.0)
    at = stop.events()
    assert at["generator_off"] == at["feathered"] == pytest.approx(0.5 + p.shutdown_time, abs=1e-12)
    at = trip.events()
    assert at["generator_off"] == pytest.approx(0.5 + p.trip_time, abs=1e-12)
    assert at["feathered"] == pytest.approx(0.5 + p.pitch_time, abs=1e-12)
    assert at["brake"] == at["event"] == 0.5
    at = loss.events()
    assert at["generator_off"] == pytest.approx(0.5 + p.trip_time, abs=1e-12)
    assert at["feathered"] == pytest.approx(0.5 + p.pitch_delay + p.pitch_time, abs=1e-12)


def test_feathered_blades_slow_the_rotor_down() -> None:
    """J dw/dt = -d T_e (w/n_e)^2 has the solution 1/w = 1/w_0 + d T_e t / (J n_e^2)."""
    train, p = driven("grid_loss", brake_speed=0.0), CONFIGURATION.drivetrain
    time, speed, _ = course(train, 40.0).T
    place = np.flatnonzero(time > 15.0)  # the shaft has come to rest
    rate = p.feathered_drag * RATED_TORQUE / (RATED_SPEED**2 * (p.rotor_inertia + p.generator_inertia))
    expected = 1 / speed[place[0]] + rate * (time[place] - time[place[0]])
    assert 1 / speed[place] == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("scenario", ["shutdown", "emergency_stop", "grid_loss"])
@pytest.mark.parametrize("wind", [4.0, 12.0])
def test_stops_end_in_an_exact_standstill(scenario: str, wind: float) -> None:
    train = driven(scenario, wind=wind)
    found = course(train, 60.0, wind=wind)
    assert train.phase == "standstill"
    assert np.min(found[:, 1]) >= 0.0
    standing = train.events()["standstill"]
    assert not np.any(found[found[:, 0] >= standing, 1:])
    last = found[found[:, 0] < standing][-1]
    assert 0.0 < last[1] < 2e-3 * RATED_SPEED  # it doesn't fall off a cliff
    assert abs(last[2]) < 0.02 * RATED_TORQUE
    assert train.advance(25.0, 1.0) == REST


def test_the_ring_never_turns_backwards() -> None:
    """A shaft that springs back at a crawl, and a brake that bites: the backstop holds."""
    train = driven("emergency_stop", wind=3.0, shaft_damping_ratio=0.0, shaft_stiffness=1e6, brake_torque=1e9)
    at_first = train.energies()["stored"]
    found = course(train, 60.0, wind=3.0)
    assert np.min(found[:, 1]) == 0.0
    assert np.all(np.isfinite(found))
    energy = train.energies()
    gained = energy["wind"] - energy["generator"] - energy["brake"] - energy["shaft"]
    assert energy["stored"] - at_first == pytest.approx(gained, abs=1e-6 * at_first)


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_restoring_continues_bit_for_bit(scenario: str) -> None:
    for ticks in (10, 41, 300, 2200):
        train = driven(scenario)
        for tick in range(ticks):
            train.advance(WIND + math.sin(tick), TICK)
        again = driven(scenario, wind=5.0)
        again.restore(train.state())
        assert again.drive == train.drive
        for tick in range(100):
            assert again.advance(11.0 + math.cos(tick), TICK) == train.advance(11.0 + math.cos(tick), TICK)
        assert again.state() == train.state()
        assert again.events() == train.events()


def test_the_result_hardly_depends_on_the_tick() -> None:
    fine, coarse = (course(driven("emergency_stop"), 5.0, tick=tick)[-1] for tick in (1e-3, TICK))
    assert coarse == pytest.approx(fine, rel=2e-4)  # the brake's regime changes at the end of a step


def test_what_is_refused() -> None:
    with pytest.raises(InputError, match=r"scenario: expected one of start_up, .* got 'crash'"):
        driven("crash")
    with pytest.raises(InputError, match=r"event_time"):
        driven("shutdown", event=-1.0)
    train = driven("shutdown")
    with pytest.raises(InputError, match=r"scenario: expected shutdown, got grid_loss"):
        train.restore(driven("grid_loss").state())
    with pytest.raises(InputError, match=r"twist: expected a value, got nothing"):
        train.restore({"scenario": "shutdown"})


def test_the_gearbox_is_light() -> None:
    """The inertia of the gears seen from the ring, from the model's own masses in a rigid rotation."""
    gearbox = Gearbox(CONFIGURATION, "kinematic")
    inertia = float(np.sum(rigid_rotation(gearbox) ** 2 / gearbox.laws.inverse_mass))
    assert inertia == pytest.approx(1.77e5, rel=5e-3)
    assert inertia / CONFIGURATION.drivetrain.generator_inertia == pytest.approx(0.038, abs=5e-4)


def turned(train: DriveTrain, until: float) -> tuple[Array, Array, Array]:
    """The gearbox under a load case: time of each tick, back_fraction (n, 7), torque of its shafts (n, 4)."""
    gearbox = Simulation(CONFIGURATION, train.drive)
    time, back, torque = [], [], []
    while train.time < until - 1e-9:
        time.append(train.time)
        block = gearbox.advance(64, train.advance(WIND, TICK))
        for array in (block.x, block.force, block.bearing_force, block.shaft_speed, block.shaft_torque):
            assert np.all(np.isfinite(array))
        back.append(block.back_fraction)
        torque.append(np.mean(block.shaft_torque, axis=0))
    return np.array(time), np.array(back), np.array(torque)


def test_the_gearbox_after_a_loss_of_the_grid() -> None:
    """The torque turns round, and every mesh carries on its back flanks; none did before."""
    time, back, torque = turned(driven("grid_loss"), 1.5)
    before, after = time < 0.5 - 1e-9, time >= 0.5 - 1e-9
    assert not np.any(back[before])
    assert np.all(np.max(back[after], axis=0) > 0.5)
    rated = np.mean(torque[before], axis=0)
    assert rated[[0, 3]] == pytest.approx([RATED_TORQUE, RATED_TORQUE / 56.2184], rel=0.02)
    assert np.all(np.min(torque[after], axis=0) < -0.3 * rated)


@pytest.mark.parametrize("scenario", ["start_up", "shutdown", "emergency_stop"])
def test_the_gearbox_through_the_other_cases(scenario: str) -> None:
    """Shortened; nothing goes astray, and what stops stands still, unloaded."""
    train = driven(scenario, event=0.1, **SHORT)
    _, _, torque = turned(train, 8.0)
    if scenario == "start_up":
        assert train.phase == "running"
        assert torque[-1, 0] == pytest.approx(RATED_TORQUE, rel=0.05)
    else:
        assert train.drive == REST
        assert abs(torque[-1]) == pytest.approx(0.0, abs=1e-3 * RATED_TORQUE)
