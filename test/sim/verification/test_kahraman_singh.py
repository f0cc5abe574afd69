"""The single gear pair with backlash of Kahraman and Singh, J. Sound Vib. 142 (1990) 49-75, in sweeps up and down.

    x'' + 2 zeta x' + f(x) = F_m + F_ah Omega^2 cos(Omega t)

with f the backlash of half width 1: unit mass and mesh stiffness, mean load and transmission error. Backlash and steps
are the product's. Held against the closed forms of the motion that keeps its flanks together, and where they part
against two harmonic balances: the describing functions of the gap (below, nothing shared with the product) and the
product's own with twelve harmonics. Its published curves weren't at hand, so that no figure is read off them.
"""

import math
from typing import NamedTuple

import numba
import numpy as np
import pytest
from scipy.optimize import brentq

from nw_gear_sim.integrator import rk4
from nw_gear_sim.physics.mesh import backlash_function
from nw_gear_sim.superharmonic.harmonics import Balance, NoOrbit
from nw_gear_sim.superharmonic.pair import GearPair
from nw_gear_sim.superharmonic.restoring import Backlash
from nw_gear_sim.tangent.benettin import spectrum

ZETA, MEAN, ERROR = 0.05, 0.1, 0.05
STEPS = 128
"""Of time in a period."""
SETTLING, RECORD = 40, 8
"""Periods."""
ORDER = 12
"""Harmonics of the product's balance."""
GRID = np.round(np.arange(0.40, 1.2001, 0.005), 6)
FROM_ABOVE = np.round(np.arange(1.6, 0.6, -0.005), 6)
"""Down to below the jump, from where flanks are together again."""


@numba.njit(cache=False)
def _periods(omega, zeta, mean, error, periods, state, least_most):
    """Integrate over some periods; the extremes of x on the way go to `least_most`."""
    q, v = state[:1], state[1:]
    slopes, q_next, v_next = np.empty((4, 1)), np.empty(1), np.empty(1)
    h = 2.0 * math.pi / omega / STEPS
    least_most[0], least_most[1] = math.inf, -math.inf
    for step in range(periods * STEPS):
        rk4.first(q, v, q_next, v_next)
        for stage in range(4):
            time = h * (step + (0.0 if stage == 0 else 1.0 if stage == 3 else 0.5))
            push = mean + error * omega**2 * math.cos(omega * time)
            slopes[stage, 0] = push - 2.0 * zeta * v_next[0] - backlash_function(q_next[0], 1.0)
            rk4.proceed(stage, h, q, v, slopes, q_next, v_next)
        least_most[0], least_most[1] = min(least_most[0], q[0]), max(least_most[1], q[0])


def sweep(grid, mean=MEAN):
    """Half the swing of x and its least value over frequencies in the order of `grid`, the state carried on."""
    state, found = np.array([1.0 + mean, 0.0]), []
    for omega in grid:
        extremes = np.empty(2)
        for count in (SETTLING, RECORD):
            _periods(omega, ZETA, mean, ERROR, count, state, extremes)
        found.append((0.5 * (extremes[1] - extremes[0]), extremes[0]))
    return np.array(found)


def steepest(grid, swing):
    """Where a sweep jumps: the frequency between the two points that differ most, and by how much."""
    k = int(np.argmax(np.abs(np.diff(swing))))
    return 0.5 * (grid[k] + grid[k + 1]), abs(swing[k + 1] - swing[k])


def linear(omega):
    """Amplitude while the flanks stay together."""
    return ERROR * omega**2 / np.hypot(1.0 - omega**2, 2.0 * ZETA * omega)


class Gap(NamedTuple):
    """Mean and first harmonic of f(m + A cos) with half gap 1, by describing functions."""

    mean: float
    first: float


def describe(m, a):
    """Integrals of (x - 1) where x > 1 and of (x + 1) where x < -1 over a period of x = m + a cos."""

    def side(offset):  # of max(offset + a cos, 0)
        if offset >= a:
            return offset, a
        if offset <= -a:
            return 0.0, 0.0
        angle = math.acos(-offset / a)
        mean = (offset * angle + a * math.sin(angle)) / math.pi
        first = 2.0 / math.pi * (offset * math.sin(angle) + 0.5 * a * (angle + math.sin(angle) * math.cos(angle)))
        return mean, first

    front, back = side(m - 1.0), side(-m - 1.0)
    return Gap(front[0] - back[0], front[1] + back[1])


def branches(mean=MEAN):
    """Frequencies at which the describing functions balance, over the amplitude: lower and upper root, NaN for none."""
    amplitudes = np.linspace(0.01, 1.6, 1600)
    roots = np.full((2, len(amplitudes)), np.nan)
    for k, a in enumerate(amplitudes):
        m = brentq(lambda at, a=a: describe(at, a).mean - mean, -3.0, 3.0)
        stiffness = describe(m, a).first / a
        # (stiffness - W)^2 a^2 + 4 zeta^2 W a^2 = (e W)^2 with W = Omega^2
        square = np.roots([a * a - ERROR**2, a * a * (4.0 * ZETA**2 - 2.0 * stiffness), (a * stiffness) ** 2])
        real = np.sort(square.real[(np.abs(square.imag) < 1e-12) & (square.real > 0.0)])
        roots[: len(real), k] = np.sqrt(real)
    return amplitudes, roots


def balance(omega):
    """The product's harmonic balance at one frequency."""
    pair = GearPair("I", 1.0, 1.0, 0.0, 1.0, ZETA, ERROR * omega**2, MEAN, 0.0, 0.0, 0.0, 0.0)
    return Balance(pair, Backlash(1.0), order=ORDER, samples=512)


def swing(orbit):
    """Half the swing of an orbit."""
    x = orbit.at(np.linspace(0.0, 2.0 * math.pi / orbit.omega, 1024))
    return 0.5 * float(np.ptp(x))


def follow(grid):
    """Half swings of the product's balance over a grid, each from the one before, NaN from where there is none."""
    found, start = np.full(len(grid), np.nan), np.eye(1, 2 * ORDER + 1)[0] * (1.0 + MEAN)  # in contact at rest
    for k, omega in enumerate(grid):
        try:
            orbit = balance(omega).solve(omega, start)
        except NoOrbit:
            break
        start, found[k] = orbit.coefficients, swing(orbit)
    return found


@pytest.fixture(scope="module")
def sweeps():
    return sweep(GRID), sweep(GRID[::-1])[::-1]


def test_flanks_that_stay_together_move_as_the_linear_pair(sweeps, figure):
    """They stay together up to where the linear amplitude reaches the mean deflection, a closed form."""
    grazing = brentq(lambda omega: linear(omega) - MEAN, 0.4, 1.0)
    swings, least = sweeps[0].T
    together = grazing - GRID > 0.0
    assert np.all(least[together] > 1.0)
    assert np.all(least[figure("flanks part at", grazing) - GRID < -0.01] < 1.0)
    assert figure("swing over the linear one, off", float(np.max(np.abs(swings / linear(GRID) - 1)[together]))) < 1e-3


def test_both_sweeps_jump_apart(sweeps, figure):
    """The flanks' parting softens: up sweeps jump up where flanks begin to part, down sweeps jump down lower."""
    up, down = (steepest(GRID, found[:, 0]) for found in sweeps)
    assert figure("jump up", up[0]) > figure("jump down", down[0]) + 0.05
    assert min(up[1], down[1]) > 0.1
    apart = np.abs(sweeps[0][:, 0] - sweeps[1][:, 0]) > 0.05
    assert np.array_equal(apart, np.logical_and(down[0] < GRID, up[0] > GRID))


def test_jumps_lie_at_the_folds_of_the_describing_functions(sweeps, figure):
    amplitudes, (lower, upper) = branches()
    parting = amplitudes > 0.9 * MEAN
    jump_up = float(np.nanmax(lower[parting & (amplitudes < 0.5)]))
    jump_down = float(np.nanmin(upper[parting]))
    found_up, found_down = (steepest(GRID, found[:, 0])[0] for found in sweeps)
    assert figure("jump up over the fold", found_up / jump_up) == pytest.approx(1.0, abs=0.02)
    assert figure("jump down over the fold", found_down / jump_down) == pytest.approx(1.0, abs=0.05)


def test_branches_are_those_of_twelve_harmonics(sweeps, figure):
    """Swings on both branches, and where these end: within the step of the grid in which the sweeps jump."""
    for name, found, grid in (("up", sweeps[0], GRID), ("down", sweeps[1], FROM_ABOVE)):
        branch = follow(grid)
        known = grid[np.isfinite(branch)]
        jump = steepest(GRID, found[:, 0])[0]
        assert figure(f"end of the branch on the way {name}", float(known[-1])) == pytest.approx(jump, abs=0.0026)
        both, here, there = np.intersect1d(GRID, known, return_indices=True)
        assert len(both) > 80
        assert figure(f"swing on the way {name}, off", float(np.max(np.abs(found[here, 0] / branch[there] - 1)))) < 1e-3


@pytest.mark.slow
def test_exponents_sum_up_to_the_damping(figure):
    """Whatever the flanks do; and both are -zeta where they stay together."""
    for omega, together in ((0.45, True), (0.62, False)):
        state, steps = np.array([1.0 + MEAN, 0.0]), 16
        _periods(omega, ZETA, MEAN, ERROR, SETTLING, state, np.empty(2))
        time = np.zeros(1)

        def carry(deviations, omega=omega, state=state, time=time, steps=steps):
            h = 2.0 * math.pi / omega / STEPS
            return _deviate(omega, h, steps, state, time, np.ascontiguousarray(deviations)), -2.0 * ZETA

        found = spectrum(carry, np.eye(2), 2.0 * math.pi / omega * steps / STEPS, 600)
        assert figure("sum", found.rate.sum()) == pytest.approx(-2.0 * ZETA, rel=1e-4)
        assert found.divergence == pytest.approx(-2.0 * ZETA)
        if together:
            assert found.rate == pytest.approx([-ZETA, -ZETA], abs=2e-3)


@numba.njit(cache=False)
def _deviate(omega, h, steps, state, time, deviations):
    """Carry state and deviations over some steps of the classical Runge-Kutta method."""
    q, v, y, w = state[:1], state[1:], deviations[0].copy(), deviations[1].copy()
    count = len(y)
    slopes, q_next, v_next = np.empty((4, 1)), np.empty(1), np.empty(1)
    pushes, y_next, w_next = np.empty((4, count)), np.empty(count), np.empty(count)
    for _ in range(steps):
        rk4.first(q, v, q_next, v_next)
        rk4.first(y, w, y_next, w_next)
        for stage in range(4):
            at = time[0] + h * (0.0 if stage == 0 else 1.0 if stage == 3 else 0.5)
            push = MEAN + ERROR * omega**2 * math.cos(omega * at)
            slopes[stage, 0] = push - 2.0 * ZETA * v_next[0] - backlash_function(q_next[0], 1.0)
            touching = 1.0 if abs(q_next[0]) > 1.0 else 0.0
            for k in range(count):
                pushes[stage, k] = -2.0 * ZETA * w_next[k] - touching * y_next[k]
            rk4.proceed(stage, h, q, v, slopes, q_next, v_next)
            rk4.proceed(stage, h, y, w, pushes, y_next, w_next)
        time[0] += h
    carried = np.empty_like(deviations)
    carried[0], carried[1] = y, w
    return carried
