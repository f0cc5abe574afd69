"""The integrator on equations that aren't gears."""

import itertools
import math

import numpy as np
import pytest

from nw_gear_common.tables import Array
from nw_gear_sim.integrator import rk4


def slope(t: float, q: Array, v: Array) -> Array:
    """A driven, damped, coupled Duffing pair."""
    spring = np.array([-q[0] - q[0] ** 3 + 0.5 * q[1], -2.0 * q[1] + 0.5 * q[0]])
    return spring - 0.1 * v * (1 + q**2) + np.array([math.cos(1.3 * t), 0.0])


def step(t: float, h: float, q: Array, v: Array) -> None:
    size = len(q)
    a, q_stage, v_stage = np.zeros((4, size)), np.zeros(size), np.zeros(size)
    rk4.first(q, v, q_stage, v_stage)
    for stage, node in enumerate((0, 0.5, 0.5, 1)):
        a[stage] = slope(t + node * h, q_stage, v_stage)
        rk4.proceed(stage, h, q, v, a, q_stage, v_stage)


def textbook_step(t: float, h: float, y: Array) -> Array:
    """Classical method on the first-order system."""

    def f(t: float, y: Array) -> Array:
        return np.concatenate([y[2:], slope(t, y[:2], y[2:])])

    k1 = f(t, y)
    k2 = f(t + h / 2, y + h / 2 * k1)
    k3 = f(t + h / 2, y + h / 2 * k2)
    k4 = f(t + h, y + h * k3)
    return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def solve(steps: int) -> Array:
    q, v = np.array([1.0, -0.3]), np.array([0.2, 0.1])
    h = 4.0 / steps
    for k in range(steps):
        step(k * h, h, q, v)
    return np.concatenate([q, v])


def test_is_the_classical_method() -> None:
    q, v = np.array([1.0, -0.3]), np.array([0.2, 0.1])
    expected = textbook_step(0.7, 0.2, np.concatenate([q, v]))
    step(0.7, 0.2, q, v)
    assert np.concatenate([q, v]) == pytest.approx(expected, rel=1e-14)


def test_order_is_four() -> None:
    reference = solve(3200)
    errors = [np.linalg.norm(solve(n) - reference) for n in (50, 100, 200)]
    assert [math.log2(a / b) for a, b in itertools.pairwise(errors)] == pytest.approx([4, 4], abs=0.15)
    assert rk4.ORDER == 4


def test_stability_bounds() -> None:
    """On the negative axis 2.7853, on the imaginary axis 2 sqrt 2 (Hairer, Norsett, Wanner)."""
    assert rk4.largest_stable_step(np.array([-10.0 + 0j])) == pytest.approx(0.27853, rel=1e-4)
    oscillating = np.array([-1e-6 + 100j, -1e-6 - 100j])
    assert rk4.largest_stable_step(oscillating) == pytest.approx(2 * math.sqrt(2) / 100, rel=1e-4)
    assert rk4.largest_stable_step(np.array([1.0 + 5j])) == math.inf
