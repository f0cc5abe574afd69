"""Measured order of each integrator, on stiff oscillators with a smooth nonlinear force, against scipy's DOP853."""

import itertools
import math
from collections.abc import Callable

import numpy as np
import pytest
import scipy.integrate

from nw_gear_common.tables import Array
from nw_gear_sim.config import load, with_values
from nw_gear_sim.integrator import etdrk4, gautschi, rk4
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.simulation import Simulation
from test.sim.gearboxes import RATED_TORQUE

SQUARE = np.array([0.0, 9.0, 400.0])
DAMPING = np.array([0.02, 0.1, 0.5])
END = 4.0
START = np.array([0.4, -0.3, 0.05]), np.array([0.1, 0.5, 0.0])


def force(t: float, x: Array, v: Array) -> Array:
    """A smooth coupling, cubic in the differences, with damping that depends on the displacement, and a drive."""
    first, second = x[0] - x[1], x[1] - x[2]
    push = np.array([-first - first**3, first + first**3 - 2 * second, 2 * second])
    return push - 0.05 * v * (1 + x**2) + np.array([0.0, math.cos(1.3 * t), 0.2])


def whole(t: float, x: Array, v: Array) -> Array:
    return force(t, x, v) - SQUARE * x - DAMPING * v


def exact() -> Array:
    def slope(t: float, y: Array) -> Array:
        return np.concatenate([y[3:], whole(t, y[:3], y[3:])])

    found = scipy.integrate.solve_ivp(slope, (0, END), np.concatenate(START), "DOP853", rtol=1e-13, atol=1e-14)
    return np.asarray(found.y[:3, -1])


def by_rk4(steps: int) -> Array:
    (x, v), h = (part.copy() for part in START), END / steps
    slopes, x_stage, v_stage = np.zeros((4, 3)), np.zeros(3), np.zeros(3)
    for k in range(steps):
        rk4.first(x, v, x_stage, v_stage)
        for stage, node in enumerate((0, 0.5, 0.5, 1)):
            slopes[stage] = whole((k + node) * h, x_stage, v_stage)
            rk4.proceed(stage, h, x, v, slopes, x_stage, v_stage)
    return x


def by_etdrk4(steps: int) -> Array:
    (x, v), h = (part.copy() for part in START), END / steps
    data = etdrk4.coefficients(SQUARE, DAMPING, h)
    forces = np.zeros((4, 3))
    x_stage, v_stage = x.copy(), v.copy()
    for k in range(steps):
        x_stage[:], v_stage[:] = x, v
        for stage, node in enumerate((0, 0.5, 0.5, 1)):
            forces[stage] = force((k + node) * h, x_stage, v_stage)
            etdrk4.proceed(stage, data, forces, x, v, x_stage, v_stage)
    return x


def by_gautschi(steps: int) -> Array:
    (x, v), h = (part.copy() for part in START), END / steps
    data = gautschi.coefficients(SQUARE, DAMPING, h)
    u, before = np.zeros(3), np.zeros(3)
    gautschi.start(x, v, whole(0.0, x, v), h, u, before)
    for k in range(steps):
        gautschi.extrapolate(u, before, v)
        gautschi.proceed(data, force(k * h, x, v), x, u, before, v)
    return x


METHODS = {
    "rk4": (by_rk4, rk4.ORDER, 4),
    "etdrk4": (by_etdrk4, etdrk4.ORDER, 4),
    "gautschi": (by_gautschi, gautschi.ORDER, 2),
}


@pytest.mark.parametrize("name", METHODS)
def test_order(name: str, figure: Callable[[str, float], float]) -> None:
    """Errors fall by 2^order where the step is halved, three times in a row."""
    solve, stated, expected = METHODS[name]
    truth = exact()
    errors = [float(np.linalg.norm(solve(steps) - truth)) for steps in (200, 400, 800, 1600)]
    orders = [math.log2(a / b) for a, b in itertools.pairwise(errors)]
    assert stated == expected
    assert figure(f"order of {name}", orders[-1]) == pytest.approx(expected, abs=0.1)
    assert orders == pytest.approx([expected] * 3, abs=0.35)


def test_exponential_methods_follow_the_linear_part_exactly() -> None:
    """Without a force both give e^(-gamma t / 2) cos(omega_d t), whatever the step: no stiffness limits them."""
    square, damping, h, steps = np.array([1e6]), np.array([20.0]), 0.05, 7
    x, v = np.array([1.0]), np.array([0.0])
    data = etdrk4.coefficients(square, damping, h)
    forces, x_stage, v_stage = np.zeros((4, 1)), np.zeros(1), np.zeros(1)
    for _ in range(steps):
        for stage in range(4):
            etdrk4.proceed(stage, data, forces, x, v, x_stage, v_stage)
    swing = math.sqrt(1e6 - 100)
    time = steps * h
    closed = math.exp(-10 * time) * (math.cos(swing * time) + 10 / swing * math.sin(swing * time))
    assert x[0] == pytest.approx(closed, rel=1e-9, abs=1e-12)

    def at(t: float) -> float:
        return math.exp(-10 * t) * math.cos(swing * t)

    position, u, before = np.array([at(0.0)]), np.array([(at(0.0) - at(-h)) / h]), np.zeros(1)
    coefficients = gautschi.coefficients(square, damping, h)
    for _ in range(steps):
        gautschi.proceed(coefficients, np.zeros(1), position, u, before, v)
    assert position[0] == pytest.approx(at(time), rel=1e-9, abs=1e-9)


def swung(integrator: str, rate: float) -> Array:
    """Elongations of the meshes 2 ms after a step of the torque from 80 to 100 % of rated, at standstill."""
    values = {
        "numerics.integrator": integrator,
        "numerics.step": 1 / rate,
        "friction.enabled": False,
        "bearings.exponent": 2.0,
    }
    low, high, samples = 0.8 * RATED_TORQUE, RATED_TORQUE, 10
    simulation = Simulation(with_values(values, load()), Drive(0.0, 0.0, low, low), sample_rate=5120.0)
    simulation.advance(samples, Drive(0.0, 0.0, high, high))
    return np.asarray(simulation.advance(1, Drive(0.0, 0.0, high, high)).x[0])


@pytest.mark.parametrize(("integrator", "order"), [("rk4", 4), ("etdrk4", 4), ("gautschi", 2)])
def test_order_on_the_gearbox(integrator: str, order: int, figure: Callable[[str, float], float]) -> None:
    """On the whole gearbox where it is smooth: nothing passes at standstill, teeth stay closed, rollers load as d^2.

    Against a run with a sixteenth of the largest step. With passing segments and d^(10/9) the kinks show instead, at
    errors below 1e-12 m.
    """
    finest = swung(integrator, 16 * 40960.0)
    coarse, fine = (float(np.max(np.abs(swung(integrator, k * 40960.0) - finest))) for k in (1, 2))
    assert figure(f"order of {integrator} on the gearbox", math.log2(coarse / fine)) == pytest.approx(order, abs=0.25)
    assert figure(f"error of {integrator} at 1/40960 s after 2 ms, m", coarse) < 1e-7
