"""Exponents by twins: systems of the literature, the least damped mode of the gearbox, rattling."""

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_sim.config import load
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.linear import find_shapes, linearise
from nw_gear_sim.lyapunov import largest_exponent
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.simulation import Simulation


class System:
    """Anything with a state that is advanced, in the clothes of a simulation."""

    def __init__(self, x, step, sample_rate):
        self.x, self._step, self.sample_rate = np.array(x, dtype=float), step, sample_rate

    def state(self):
        return {"x": self.x.copy()}

    def take(self, state):
        self.x = state["x"].copy()

    def advance(self, samples, _drive):
        for _ in range(samples):
            self.x = self._step(self.x)


def henon(x):
    return np.array([1.0 - 1.4 * x[0] ** 2 + x[1], 0.3 * x[0]])


def lorenz(x, h=0.01):
    def slope(z):
        return np.array([10.0 * (z[1] - z[0]), z[0] * (28.0 - z[2]) - z[1], z[0] * z[1] - 8.0 / 3.0 * z[2]])

    a = slope(x)
    b = slope(x + 0.5 * h * a)
    c = slope(x + 0.5 * h * b)
    d = slope(x + h * c)
    return x + h * (a + 2 * b + 2 * c + d) / 6.0


@pytest.mark.parametrize(
    ("step", "rate", "start", "samples", "intervals", "known"),
    [(henon, 1.0, (0.1, 0.1), 5, 2000, 0.41922), (lorenz, 100.0, (1.0, 1.0, 20.0), 50, 400, 0.9056)],
)  # Sprott, Chaos and Time-Series Analysis (2003)
def test_exponents_of_known_systems(step, rate, start, samples, intervals, known):
    system = System(start, step, rate)
    system.advance(1000, None)
    found = largest_exponent(system, [(samples, None)] * intervals)
    assert found.rate == pytest.approx(known, rel=0.03)


def test_too_few_intervals():
    with pytest.raises(InputError, match="at least 8"):
        largest_exponent(System((0.1, 0.1), henon, 1.0), [(5, None)] * 3)


@pytest.mark.slow
def test_a_regular_gearbox_forgets_as_its_least_damped_mode_decays():
    configuration = load("rated")
    gearbox = Gearbox(configuration)
    speed, torque = gearbox.kinematics.ring_speed, gearbox.kinematics.input_torque
    q = find_equilibrium(gearbox, torque, speed=speed).q
    slowest = float(np.max(find_shapes(linearise(gearbox, q))[1].eigenvalues.real))
    drive = Drive(speed, speed, torque, torque)

    simulation = Simulation(configuration, drive)
    simulation.advance(2 * 5120, drive)
    found = largest_exponent(simulation, [(1024, drive)] * 60)
    assert found.rate == pytest.approx(slowest, abs=3.0 * found.error)
    assert found.error < 0.6


@pytest.mark.slow
def test_a_rattling_gearbox_is_chaotic():
    configuration = load("rattling")
    kinematics = Gearbox(configuration).kinematics
    speed, torque = kinematics.ring_speed, kinematics.input_torque
    drive = Drive(speed, speed, torque, torque)
    simulation = Simulation(configuration, drive)
    simulation.advance(5 * 5120, drive)
    found = largest_exponent(simulation, [(1024, drive)] * 60)
    assert found.rate > 10.0 * found.error
    assert found.rate > 10.0
