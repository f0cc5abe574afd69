"""Spectra of systems of the literature, and what has to hold for any: sums, dimensions, blocks."""

import math

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_sim.tangent.benettin import BLOCKS, kaplan_yorke, spectrum, summary


class System:
    """A flow x' = f(x) with its tangent, by the classical Runge-Kutta method; or a map."""

    def __init__(self, start, slope, jacobian, step, steps):
        self.x, self.slope, self.jacobian, self.step, self.steps = np.array(start), slope, jacobian, step, steps
        self.time = 0.0

    def both(self, time, x, deviations):
        return self.slope(time, x), self.jacobian(time, x) @ deviations

    def carry(self, y):
        total, h = 0.0, self.step
        for _ in range(self.steps):
            x, t = self.x, self.time
            total += np.trace(self.jacobian(t, x))
            a, ya = self.both(t, x, y)
            b, yb = self.both(t + h / 2, x + h / 2 * a, y + h / 2 * ya)
            c, yc = self.both(t + h / 2, x + h / 2 * b, y + h / 2 * yb)
            d, yd = self.both(t + h, x + h * c, y + h * yc)
            self.x, y = x + h / 6 * (a + 2 * b + 2 * c + d), y + h / 6 * (ya + 2 * yb + 2 * yc + yd)
            self.time += h
        return y, total / self.steps


LORENZ = (
    (1.0, 1.0, 20.0),
    lambda t, x: np.array([10 * (x[1] - x[0]), x[0] * (28 - x[2]) - x[1], x[0] * x[1] - 8 / 3 * x[2]]),
    lambda t, x: np.array([[-10.0, 10.0, 0.0], [28 - x[2], -1.0, -x[0]], [x[1], x[0], -8 / 3]]),
)
UEDA = (
    (2.5, 0.0),
    lambda t, x: np.array([x[1], 7.5 * math.sin(t) - 0.05 * x[1] - x[0] ** 3]),
    lambda t, x: np.array([[0.0, 1.0], [-3 * x[0] ** 2, -0.05]]),
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("system", "step", "steps", "intervals", "known", "dimension"),
    [
        (LORENZ, 0.01, 25, 2400, (0.9056, 0.0, -14.5723), 2.0621),
        (UEDA, 0.02, 50, 3000, (0.1034, -0.1534), 1.674),  # the phase of the force, with its 0, isn't counted
    ],
    ids=["Lorenz", "Ueda"],
)  # Sprott, Chaos and Time-Series Analysis (2003), appendix A
def test_spectra_of_known_flows(system, step, steps, intervals, known, dimension):
    flow = System(*system, step, steps)
    flow.carry(np.eye(len(known)))
    found = spectrum(flow.carry, np.eye(len(known)), step * steps, intervals)
    for k, value in enumerate(known):
        assert found.rate[k] == pytest.approx(value, abs=4 * found.error[k] + 0.003 * abs(value) + 1e-3)
    assert found.rate.sum() == pytest.approx(found.divergence, rel=1e-3)
    assert found.dimension == pytest.approx(dimension, abs=0.05)


def test_spectrum_of_a_map():
    """Henon: 0.41922 and -1.62319 (Sprott 2003); their sum is the logarithm of the determinant, 0.3."""
    point = np.array([0.1, 0.1])

    def carry(y):
        for _ in range(4):
            y = np.array([[-2.8 * point[0], 1.0], [0.3, 0.0]]) @ y
            point[:] = 1.0 - 1.4 * point[0] ** 2 + point[1], 0.3 * point[0]
        return y, math.log(0.3)

    found = spectrum(carry, np.eye(2), 4.0, 4000)
    assert found.rate[0] == pytest.approx(0.41922, abs=4 * found.error[0])
    assert found.rate[1] == pytest.approx(-1.62319, abs=4 * found.error[1])
    assert found.error[0] < 0.01
    assert found.rate.sum() == pytest.approx(math.log(0.3), rel=1e-12)
    assert found.history[-1] == pytest.approx(found.rate)
    assert len(found.time) == 200
    assert found.time[-1] == found.duration == 4.0 * 3200


def test_spectrum_of_a_constant_system():
    """Real parts of the eigenvalues, whatever the start."""
    matrix = np.array([[-0.5, 3.0, 0.0], [-3.0, -0.5, 1.0], [0.0, 0.0, -2.0]])
    values, vectors = np.linalg.eig(matrix / 8)
    step = np.real(vectors @ np.diag(np.exp(values)) @ np.linalg.inv(vectors))
    start = np.linalg.qr(np.random.default_rng(0).standard_normal((3, 3)))[0]
    found = spectrum(lambda y: (step @ y, float(np.trace(matrix))), start, 0.125, 2000)
    assert found.rate == pytest.approx([-0.5, -0.5, -2.0], abs=5e-3)
    assert found.rate.sum() == pytest.approx(-3.0, rel=1e-12)


def test_error_is_that_of_independent_blocks():
    """White noise of deviation 3: the mean of n numbers is off by 3 / sqrt n."""
    growth = 3.0 * np.random.default_rng(0).standard_normal((16000, 400)) - 1.0
    found = summary(growth, np.zeros(16000), 0.1)
    expected = 3.0 / math.sqrt(16000)
    assert np.sqrt(np.mean(found.error**2)) == pytest.approx(expected, rel=0.05)
    assert np.std(found.rate) == pytest.approx(expected, rel=0.1)
    assert BLOCKS == 16


@pytest.mark.parametrize(
    ("rates", "dimension"),
    [((0.9056, 0.0, -14.5723), 2.06215), ((0.5, -0.2, -0.6), 2.5), ((-1.0, -2.0), 0.0), ((1.0, -1.0, -3.0), 2.0)],
)
def test_kaplan_yorke(rates, dimension):
    assert kaplan_yorke(np.array(rates)) == pytest.approx(dimension, abs=1e-5)


def test_kaplan_yorke_needs_a_negative_sum():
    assert math.isnan(kaplan_yorke(np.array([0.9, 0.0])))


def test_too_few_intervals():
    with pytest.raises(InputError, match="at least 40"):
        spectrum(lambda y: (y, 0.0), np.eye(2), 1.0, 39)
