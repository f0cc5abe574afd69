"""Orbits whose exponents and dimensions are known, and the peer that some indicators are compared with."""

import types
import warnings
from collections.abc import Callable

import numpy as np

from nw_gear_common.tables import Array

State = tuple[float, ...]


def peer() -> types.ModuleType:
    """nolds 0.6.2; it imports a part of setuptools that warns of its end."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import nolds
    return nolds


def henon(size: int) -> Array:
    """Points (x, y) of the Hénon map, a = 1.4, b = 0.3."""
    x, y = 0.1, 0.1
    orbit = np.empty((size, 2))
    for step in range(-1000, size):
        x, y = 1.0 - 1.4 * x * x + y, 0.3 * x
        orbit[max(step, 0)] = x, y
    return orbit


def flow(rate_of_change: Callable[..., State], start: State, step: float, size: int) -> Array:
    """States of a flow of three coordinates at equal steps (Runge-Kutta of order 4), after 5000 steps."""
    s = start
    half = 0.5 * step
    orbit = np.empty((size, 3))
    for number in range(-5000, size):
        a = rate_of_change(*s)
        b = rate_of_change(s[0] + half * a[0], s[1] + half * a[1], s[2] + half * a[2])
        c = rate_of_change(s[0] + half * b[0], s[1] + half * b[1], s[2] + half * b[2])
        d = rate_of_change(s[0] + step * c[0], s[1] + step * c[1], s[2] + step * c[2])
        s = tuple(s[k] + step / 6.0 * (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]) for k in range(3))
        orbit[max(number, 0)] = s
    return orbit


def lorenz(size: int, step: float = 0.01) -> Array:
    """Lorenz' flow, sigma = 10, rho = 28, beta = 8/3."""
    return flow(
        lambda x, y, z: (10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z), (1.0, 1.0, 20.0), step, size
    )


def roessler(size: int, step: float = 0.05) -> Array:
    """Rössler's flow, a = b = 0.2, c = 5.7."""
    return flow(lambda x, y, z: (-y - z, x + 0.2 * y, 0.2 + z * (x - 5.7)), (1.0, 1.0, 0.0), step, size)


def shuffled(size: int) -> Array:
    """Numbers from 0 to 1 by a linear congruential generator, the same on every machine and in every program.

    s(n + 1) = (1103515245 s(n) + 12345) mod 2^31 from s(0) = 1; the number is s(n + 1) / 2^31.
    """
    values, state = np.empty(size), 1
    for n in range(size):
        state = (1103515245 * state + 12345) % 2**31
        values[n] = state / 2**31
    return values
