"""Order tracking by pulses alone, against closed forms and against the simulator's own phase."""

import math

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_monitor.signals.tacho import DOUBLE, MISSING, Fault, Pulses, read_pulses, strongest, tacho_orders

TURN = 2 * math.pi
W, A, SWAY, GUST = 90.0, 0.4, 1.5, 0.9
"""Speed (rad/s), its growth (rad/s^2), and a sway (rad) with a frequency (rad/s), as wind makes them."""


def angle(t):
    return W * t + 0.5 * A * t * t + SWAY * np.sin(GUST * t)


def pulse_times(per_turn, seconds=40.0):
    """Times of the pulses, by Newton's method on the closed form."""
    marks = np.arange(1, int(angle(seconds) * per_turn / TURN)) * TURN / per_turn
    t = marks / W
    for _ in range(60):
        t = t - (angle(t) - marks) / (W + A * t + SWAY * GUST * np.cos(GUST * t))
    return t


@pytest.mark.parametrize(("per_turn", "most"), [(1, 2e-6), (8, 1e-9)])
def test_the_phase_between_the_pulses_follows_a_speed_that_changes(per_turn, most):
    """A cubic spline through knots h apart is off by 5/384 h^4 theta'''', at the ends by more."""
    times = pulse_times(per_turn)
    pulses = read_pulses(times, per_turn)
    assert pulses.faults == ()
    t = np.linspace(times[4 * per_turn], times[-4 * per_turn], 20001)
    assert np.abs(pulses.phase(t) + TURN / per_turn - angle(t)).max() < most
    exact = W + A * t + SWAY * GUST * np.cos(GUST * t)
    assert pulses.speed(t) == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize("start", [100.0, 1.8e9])
def test_lines_of_a_chirp_stand_at_their_orders_with_their_amplitudes(start):
    """Also where stamps are wall time, whose last bit is 0.24 us."""
    orders, amplitudes = np.array([1.6187, 6.107, 20.0]), np.array([0.3, 2.0, 0.7])
    since = np.arange(0, 40.0, 1 / 5120.0)
    time = start + since
    x = np.sin(angle(since)[:, None] * orders + [0.3, 1.0, 2.0]) @ amplitudes + 5.0
    spectrum = tacho_orders(read_pulses(start + pulse_times(1)), time, x)
    assert spectrum.turns == 256
    assert spectrum.segments >= 3
    for order, amplitude in zip(orders, amplitudes, strict=True):
        found = strongest(spectrum, order - 0.3, order + 0.3)
        assert found == pytest.approx((order, amplitude), rel=2e-4)
    smeared = np.abs(np.fft.rfft(x - x.mean())).max() * 2 / x.size
    assert smeared < 0.5 * amplitudes.max()


@pytest.mark.parametrize("lost", [1, 3])
def test_missing_pulses_are_counted_and_named(lost):
    times = pulse_times(1)
    pulses = read_pulses(np.delete(times, slice(200, 200 + lost)))
    assert pulses.faults == (Fault(MISSING, times[199], lost),)
    assert pulses.number[-1] == times.size - 1
    t = np.linspace(times[10], times[-10], 5001)
    assert np.abs(pulses.phase(t) - read_pulses(times).phase(t)).max() < 1e-4


@pytest.mark.parametrize("share", [0.01, 0.3, 0.5, 0.9])
def test_double_pulses_are_dropped_and_named(share):
    times = pulse_times(1)
    extra = times[200] + share * (times[201] - times[200])
    pulses = read_pulses(np.insert(times, 201, extra))
    assert pulses.faults == (Fault(DOUBLE, extra, 1),)
    assert np.array_equal(pulses.times, times)


def test_several_faults_are_named_in_order():
    times = pulse_times(4)
    bounce = times[300] + 2e-4
    damaged = np.delete(np.insert(times, 301, bounce), [100, 501])
    pulses = read_pulses(damaged, 4)
    assert [(fault.kind, fault.pulses) for fault in pulses.faults] == [(MISSING, 1), (DOUBLE, 1), (MISSING, 1)]
    assert pulses.number[-1] == times.size - 1


@pytest.mark.parametrize("seed", range(5))
def test_random_faults_far_from_each_other_leave_the_count_right(seed):
    random = np.random.default_rng(seed)
    times = pulse_times(1, 60.0)
    jittered = times + random.normal(0.0, 5e-4, times.size)
    places = 20 + 12 * random.permutation((times.size - 40) // 12)[:20]
    gone, doubled = places[:10], places[10:]
    extra = jittered[doubled] + random.uniform(0.02, 0.98, 10) * np.diff(jittered)[doubled]
    pulses = read_pulses(np.sort(np.concatenate([np.delete(jittered, gone), extra])))
    assert sum(fault.kind == MISSING for fault in pulses.faults) == 10
    assert sum(fault.kind == DOUBLE for fault in pulses.faults) == 10
    assert pulses.number[-1] == times.size - 1


def test_what_cannot_be_counted_is_refused():
    times = pulse_times(1)
    with pytest.raises(InputError, match=r"pulses: expected times that ascend, got .* at pulse 8"):
        read_pulses(np.concatenate([times[:8], times[7:]]))
    with pytest.raises(InputError, match="no gap of more than 8 pulses"):
        read_pulses(np.delete(times, slice(100, 112)))
    with pytest.raises(InputError, match="finite"):
        read_pulses(np.where(np.arange(times.size) == 5, np.nan, times))
    with pytest.raises(InputError, match="at least 6"):
        read_pulses(times[:5])
    with pytest.raises(InputError, match="pulses_per_turn"):
        read_pulses(times, 0)
    with pytest.raises(InputError, match="times from the first pulse to the last"):
        read_pulses(times).phase(np.array([0.0]))


def test_marks_at_unequal_distances_are_refused():
    """Two marks at 0 and 0.3 of a turn: nobody can say which of them is wrong."""
    times = np.sort(np.concatenate([np.arange(200.0), np.arange(200.0) + 0.3]))
    with pytest.raises(InputError, match=r"at most 5 % that are missing or double, got more than .* the first"):
        read_pulses(times)


def test_signals_that_cannot_be_tracked_are_refused():
    pulses = read_pulses(pulse_times(1))
    time = np.arange(0, 10.0, 1e-3)
    with pytest.raises(InputError, match="equal steps"):
        tacho_orders(pulses, np.where(time > 5, time + 1e-4, time), np.sin(time))
    with pytest.raises(InputError, match="one value for each"):
        tacho_orders(pulses, time, np.sin(time)[1:])
    with pytest.raises(InputError, match="between the first pulse and the last"):
        tacho_orders(pulses, time + 1000.0, np.sin(time))
    with pytest.raises(InputError, match="at least 8 whole turns"):
        tacho_orders(pulses, time[:300], np.sin(time[:300]))
    with pytest.raises(InputError, match="a line between 5000 and 6000"):
        strongest(tacho_orders(pulses, time, np.sin(time)), 5000.0, 6000.0)


def test_whatever_the_pulses_the_phase_never_turns_back():
    """Where a spline through them would, the monotone cubic stands in."""
    times = np.cumsum([1.0, 1, 1, 0.02, 0.02, 0.02, 1, 1, 1, 1])
    pulses = Pulses(times, np.arange(times.size), 1, ())
    t = np.linspace(times[0], times[-1], 20001)
    assert np.any(np.diff(CubicSpline(times, np.arange(times.size))(t)) < 0.0)
    assert np.all(np.diff(pulses.phase(t)) > 0.0)
    assert pulses.phase(times) == pytest.approx(TURN * np.arange(times.size), abs=1e-12)


@pytest.mark.slow
def test_orders_of_the_simulated_gearbox_agree_with_those_by_its_own_phase():
    """Accelerometers and tacho in wind: mesh lines of all stages, at their tooth counts and as by the true phase."""
    time, acceleration, pulses, true_angle = simulated_wind(seconds=14.0)
    tracked = read_pulses(pulses)
    assert tracked.faults == ()
    inside = (time >= pulses[0]) & (time <= pulses[-1])
    speed = np.diff(pulses)
    assert speed.max() / speed.min() > 1.03
    own = read_pulses(np.interp(np.arange(1, int(true_angle[-1] / TURN)) * TURN, true_angle, time))
    ratio = np.array([91.0, 91.0 / 22 * 83, 91.0 / 22 * 83 / 40 * 131]) / (91 / 22 * 83 / 40 * 131 / 20)
    for bearing, stages in (("pb1_1", (0, 1)), ("sb", (1,)), ("b21", (2,))):
        x = acceleration[f"ax_{bearing}"]
        by_tacho, by_phase = tacho_orders(tracked, time[inside], x[inside]), tacho_orders(own, time, x)
        for stage in stages:
            near = ratio[stage] - 0.05, ratio[stage] + 0.05
            found, expected = strongest(by_tacho, *near), strongest(by_phase, *near)
            assert found[0] == pytest.approx(expected[0], rel=1e-3)
            assert found[0] == pytest.approx(ratio[stage], rel=1e-3)
            assert found[1] == pytest.approx(expected[1], rel=0.02)


def simulated_wind(seconds):
    """Time, accelerations by column, pulses of the output shaft and its true angle, in a wind that sways."""
    from nw_gear_sim import config
    from nw_gear_sim.drives import WindDriven
    from nw_gear_sim.nodes.session import Session
    from nw_gear_sim.sensors.accelerometer import Accelerometers, Sensor
    from nw_gear_sim.sensors.path import housings_of
    from nw_gear_sim.sensors.tacho import Tacho

    base, bearings = config.load(), ("pb1_1", "sb", "b21")
    session = Session(base, WindDriven(base), "kinematic", "equilibrium", 5120.0, every_step=True)
    sensor = Sensor(5120.0, 490.0, 5e-4, 0.0102, 5.0, 24)
    sensors = Accelerometers(housings_of(base, bearings), sensor, session.fine_rate, 1)
    tacho, places = Tacho(1), [names.BEARINGS.index(bearing) for bearing in bearings]
    session.begin({"wind": 9.0})
    rows, pulses, angles = [], [], []
    while session.time < seconds:
        block = session.advance({"wind": 9.0 + 1.5 * math.sin(0.8 * session.time)})
        fine = session.fine
        rows.append(sensors.advance(fine.bearing_force[:, places, :2].reshape(len(fine.time), -1))[1])
        pulses.append(tacho.advance(fine.time, fine.shaft_angle[:, 3], fine.shaft_speed[:, 3]))
        angles.append((block.phase[:, 2]) / 20)
    samples = np.concatenate(rows)
    time = np.arange(len(samples)) / sensor.rate
    columns = names.acceleration_columns(bearings)[1:]
    true_angle = np.concatenate(angles)[: len(time)]
    return time, dict(zip(columns, samples.T, strict=True)), np.concatenate(pulses), true_angle
