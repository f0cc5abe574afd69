"""A machine that isn't ours: a spur gear pair with backlash and a bearing with a damaged outer race.

The pair is that of Kahraman and Singh (1990, "Non-linear dynamics of a spur gear pair", J. Sound Vib. 142, eq. 10 in
dimensionless form, from memory): x'' + 2 zeta x' + f(x) = F_m + F_a Omega^2 cos(Omega t), f a spring of unit stiffness
with a gap of +-1. SciPy's LSODA integrates it; nothing of this project's model is in it.
"""

from collections.abc import Mapping
from functools import cache
from math import cos
from pathlib import Path

import numpy as np
from scipy.integrate import odeint

from nw_gear_common.tables import Array, Table

RATE = 5120
MESH = 100.0
TEETH = 20
"""Mesh frequency (Hz) and teeth of the pinion, whose phase is measured: it makes 5 turns a second."""
HALF_GAP = 50e-6
DAMPING, MEAN, ALTERNATING = 0.05, 0.1, 0.2
OMEGA = {"period-1": 0.7, "period-2": 0.85, "period-4": 0.9, "chaotic": 1.4}
SETTLING = 200
OUTER = 9 / 2 * (1 - 7.94 / 39.04)
"""Rollers that pass a spot of the outer race per turn, 6205 bearing."""


def acceleration(x: float, v: float, t: float, omega: float) -> float:
    """x'' of the pair."""
    spring = x - 1.0 if x > 1.0 else x + 1.0 if x < -1.0 else 0.0
    return MEAN + ALTERNATING * omega**2 * cos(omega * t) - 2.0 * DAMPING * v - spring


def integrate(start: tuple[float, float] | Array, times: Array, omega: float) -> Array:
    """States (times, 2) of the pair."""

    def rate(state: Array, t: float) -> tuple[float, float]:
        return state[1], acceleration(state[0], state[1], t, omega)

    states: Array = odeint(rate, start, times, rtol=1e-9, atol=1e-10, hmax=0.1 * np.pi / omega, mxstep=200_000)
    return states


@cache
def settled(omega: float) -> tuple[float, float]:
    """A state on the attractor at t = 0 (mod 2 pi / Omega)."""
    x, v = integrate((1.1, 0.0), np.array([0.0, SETTLING * 2.0 * np.pi / omega]), omega)[-1]
    return float(x), float(v)


def largest_exponent(omega: float, periods: int = 300) -> float:
    """Largest Lyapunov exponent per mesh period, by a twin that is brought back to a distance of 1e-7 each period."""
    period = np.array([0.0, 2.0 * np.pi / omega])
    first, second = np.array(settled(omega)), np.array(settled(omega)) + np.array([1e-7, 0.0])
    growth = []
    for _ in range(periods):
        first, second = integrate(first, period, omega)[-1], integrate(second, period, omega)[-1]
        apart = second - first
        growth.append(np.log(np.linalg.norm(apart) / 1e-7))
        second = first + apart * (1e-7 / np.linalg.norm(apart))
    return float(np.mean(growth[periods // 4 :]))


def pair(omega: float, seconds: float, noise: float = 0.01, seed: int = 3) -> tuple[Array, Array, Array]:
    """Time (s), displacement (m) with noise (share of the standard deviation), and angle of the pinion (rad)."""
    time = np.arange(round(seconds * RATE)) / RATE
    x = HALF_GAP * integrate(settled(omega), 2.0 * np.pi * MESH / omega * time, omega)[:, 0]
    x += noise * x.std() * np.random.default_rng(seed).standard_normal(x.size)
    return time, x, 2.0 * np.pi * MESH / TEETH * time


def bearing(time: Array, angle: Array, knock: float = 1.0, seed: int = 4) -> Array:
    """Acceleration (m/s^2): white noise of 0.3, and a ringing of 1.2 kHz at each roller on a spot of the outer race."""
    a = 0.3 * np.random.default_rng(seed).standard_normal(time.size)
    knocks = np.interp(np.arange(1.0, OUTER * angle[-1] / (2.0 * np.pi)), OUTER * angle / (2.0 * np.pi), time)
    for moment in knocks:
        since = time - moment
        near = (since >= 0.0) & (since < 0.02)
        a[near] += knock * np.exp(-since[near] / 2e-3) * np.sin(2.0 * np.pi * 1200.0 * since[near])
    return a


def tacho(angle: Array) -> Array:
    """One pulse of 5 V and an eighth of a turn per turn, with soft edges."""
    level: Array = 2.5 + 2.5 * np.tanh(20.0 * (np.cos(angle - 1.0) - np.cos(np.pi / 8)))
    return level


def write_csv(path: Path, columns: Mapping[str, Array], digits: str = "%.9g") -> None:
    """A CSV file as a data logger writes it."""
    np.savetxt(path, np.column_stack(list(columns.values())), digits, ",", header=",".join(columns), comments="")


def table(data: Array) -> Table:
    """Columns time, angle, displacement, acceleration as a waveform of `config/machine_example.yaml`."""
    return Table("sample", ("time", "phase_pinion", "x_mesh", "a_front"), data)
