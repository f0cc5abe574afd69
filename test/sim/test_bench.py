"""The benchmark's own measures: errors fall with the step, peers solve the same equations, statistics compare."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from nw_gear_sim.bench import accuracy, peers
from nw_gear_sim.bench.accuracy import Statistics
from nw_gear_sim.bench.cases import PIECE, RATE, REFERENCE, Method, cases
from nw_gear_sim.bench.problem import Problem
from nw_gear_sim.config import load, with_values
from nw_gear_sim.kinematics import derive
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.simulation import Simulation

CONFIGURATION = load()
CASES = {case.name: case for case in cases(CONFIGURATION, 1)}


def test_a_step_four_times_smaller_has_a_smaller_error():
    """Also than the error of the torque's jump, which is large against everything that the model leaves out."""
    case = CASES["torque_step"]
    exact = case.run(CONFIGURATION, REFERENCE)
    coarse = accuracy.errors(CONFIGURATION, case, exact, Method("rk4", 1 / 40960))
    fine = accuracy.errors(CONFIGURATION, case, exact, Method("rk4", 1 / 163840))
    assert 0 < fine.first < coarse.first / 16
    assert 0 < fine.later < coarse.later / 16


@pytest.mark.slow
def test_scipy_solves_the_same_equations():
    """Both right-hand sides, from the same equilibrium: that of the reference's equations shares no code with ours."""
    seconds = 0.003
    exact = CASES["rated"].run(CONFIGURATION, REFERENCE)
    for solve in (peers.compiled, peers.with_numpy):
        solved = solve(CONFIGURATION, seconds, exact)
        assert solved.error < 2e-8
        assert solved.calls_per_second > 6 / seconds


def test_cases_drive_what_they_say():
    names = ("rated", "light", "torque_step", "wind", "speed_ramp")
    assert tuple(CASES) == names
    long = {case.name: case for case in cases(CONFIGURATION, 4)}
    for case in long.values():
        assert all(a.speed_end == b.speed_start for a, b in zip(case.drives, case.drives[1:], strict=False))
    rated = long["rated"].start
    assert long["light"].start.torque_end == pytest.approx(0.1 * rated.torque_end)
    assert long["torque_step"].start.torque_end == pytest.approx(0.5 * rated.torque_end)
    assert long["torque_step"].drives[0].torque_start == pytest.approx(rated.torque_end)
    assert long["wind"].drives[-1].torque_end == pytest.approx(rated.torque_end)
    assert long["speed_ramp"].drives[-1].speed_end == pytest.approx(1.1 * rated.speed_end)
    assert len(CASES["rated"].run(CONFIGURATION, Method("rk4", 1 / 40960))) == PIECE
    assert PIECE / RATE > accuracy.SETTLE


def test_statistics_are_compared_by_their_largest_difference():
    ones = np.ones(7)
    here = Statistics(ones.copy(), 0.2 * ones)
    here.deviation[3], here.opened[5] = 1.1, 0.15
    deviation, opened = here.against(Statistics(ones, 0.2 * ones))
    assert deviation == pytest.approx(0.1)
    assert opened == pytest.approx(0.05)


@pytest.mark.slow
@pytest.mark.parametrize("ring", ["flexible", "rigid"])
def test_scipy_solves_the_diagrams_equations(ring):
    """Tied excitation, both kinds of ring: against the exponential method with all the ring's modes."""
    values = {"operation.drive": "fixed", "excitation.omega_e": 0.21, "numerics.ring": ring}
    configuration = with_values({**values, "numerics.integrator": "etdrk4", "numerics.step": 1 / 163840}, load())
    fixed, rate = derive(configuration), 10240
    drive = Drive(fixed.ring_speed, fixed.ring_speed, fixed.input_torque, fixed.input_torque)
    problem = Problem(configuration, "tied", ring)
    block = Simulation(configuration, drive, excitation="tied", sample_rate=rate).advance(20, drive)
    moments = np.arange(20) / rate
    solved = solve_ivp(problem.slope, (0.0, moments[-1]), problem.start, t_eval=moments, rtol=1e-6, atol=1e-10)
    found = np.array([problem.elongation(t, y) for t, y in zip(moments, solved.y.T, strict=True)])
    assert np.ptp(block.x, axis=0).max() > 1e-7
    assert np.max(np.abs(found - block.x)) < 3e-8
