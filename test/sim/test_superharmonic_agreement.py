"""First order, harmonic balance with exponents, and integration against each other and against closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from nw_gear_sim.superharmonic.direct import integrate
from nw_gear_sim.superharmonic.exact import exact_branch
from nw_gear_sim.superharmonic.family import usual_frequencies
from nw_gear_sim.superharmonic.firstorder import TRUSTED, amplitudes, branches, coefficients, critical_damping
from nw_gear_sim.superharmonic.floquet import exponents
from nw_gear_sim.superharmonic.harmonics import Balance
from nw_gear_sim.superharmonic.laws import balance_of, equivalent, first_orbit
from nw_gear_sim.superharmonic.pair import STAGES, gear_pair
from nw_gear_sim.superharmonic.variation import exponents_in_time


def folded(stage, eps=None):
    """A gear pair with its feedback and two folds: mu = 0.6 mu_c."""
    pair = gear_pair(stage) if eps is None else replace(gear_pair(stage), eps=eps)
    c = coefficients(pair, pair.w0 / 3.0)
    return pair.having(zeta=pair.zeta + (0.6 * float(critical_damping(c)) - float(c.mu)) / pair.c)


def compared(pair):
    """The exact branch; which of its points the first order calls otherwise; which lie between the folds of both."""
    axis = usual_frequencies(pair, "corrected")
    exact, first = exact_branch(pair, axis), branches(pair, "omega", axis)
    assert len(first.folds) == len(exact.jumps) == 2
    omega, alpha = (np.array([getattr(point, name) for point in exact.points]) for name in ("omega", "alpha"))
    stable = np.array([point.stable for point in exact.points])
    found, said = amplitudes(coefficients(pair, omega))
    nearest = np.nanargmin(np.abs(found - alpha[:, None]), axis=1)
    differs = said[np.arange(len(omega)), nearest] != stable
    moved = np.zeros(len(omega), dtype=bool)
    for a, b in zip(first.folds, sorted(jump.value for jump in exact.jumps), strict=True):
        moved |= np.abs(omega - b) < 1.2 * abs(a - b)
    return exact, first, stable, differs, moved


def agrees(stage, eps):
    pair = folded(stage, eps)
    exact, first, stable, differs, moved = compared(pair)
    assert not np.any(differs & ~moved)  # they differ only where the first order puts a fold beside its place
    assert np.count_nonzero(~moved & ~stable) > 20
    assert np.count_nonzero(~moved & stable) > 50
    width = first.folds[1] - first.folds[0]
    at = sorted(jump.value for jump in exact.jumps)
    for a, b in zip(first.folds, at, strict=True):
        assert abs(a - b) < 0.7 * width * float(np.max(first.trust)) / TRUSTED
    return np.count_nonzero(~moved), np.count_nonzero(differs)


def test_folds_and_stability_of_the_first_order_agree_with_exponents():
    """On 338 points of two gear pairs at small eps; the few that differ lie between the folds of both."""
    counts = [agrees(stage, 0.0003) for stage in ("II", "III")]
    assert sum(same for same, _ in counts) > 300
    assert sum(differ for _, differ in counts) < 10


@pytest.mark.slow
@pytest.mark.parametrize("eps", [0.0003, 0.001])
def test_folds_and_stability_agree_for_all_gear_pairs(eps):
    counts = [agrees(stage, eps) for stage in STAGES]
    assert sum(same for same, _ in counts) > 400


@pytest.mark.slow
def test_at_the_base_eps_they_differ_on_the_unstable_stretch_alone():
    """There the first order has its folds elsewhere, and takes what is unstable for a stable amplitude nearby."""
    for stage in STAGES:
        _, _, stable, differs, _ = compared(folded(stage))
        assert np.count_nonzero(differs) > 20
        assert not np.any(differs & stable)


@pytest.mark.parametrize("stage", STAGES)
def test_an_orbit_stays_itself_in_time(stage):
    """Harmonic balance started and integrated over 100 periods: within 1e-5 of the orbit."""
    pair = folded(stage)
    balance = Balance(pair, order=15)
    orbit = balance.solve(pair.w0 / 3.0 * 0.997)
    assert exponents(balance, orbit)[0].real < 0.0
    steps = 800
    past = 2.0 * np.pi / orbit.omega / steps * np.arange(-steps, 1)
    speed = (orbit.at(past + 1e-4) - orbit.at(past - 1e-4)) / 2e-4
    course = integrate(pair, orbit.omega, 100, start=(orbit.at(past), speed), steps_per_period=steps)
    assert np.max(np.abs(course.x - orbit.at(course.time))) < 1e-5


def test_all_amplitudes_without_delay_obey_the_duffing_oscillators_response():
    """Nayfeh and Mook (1979), Eq. (4.1.45): [mu^2 + (sigma - 3 a L^2/w0 - 3 a A^2/(8 w0))^2] A^2 = a^2 L^6/w0^2.

    For u'' + w0^2 u + 2 eps mu u' + eps a u^3 = K cos(nu t), L = K/(2 (w0^2 - nu^2)).
    """
    pair = replace(gear_pair("II"), eps=0.004).having(g_d=0.0, g_v=0.0, mean_force=0.0, zeta=0.02)
    a, mu = pair.q * pair.w0, pair.c * pair.zeta
    omega = np.linspace(0.326, 0.331, 301)
    forced = pair.force / (2.0 * (pair.w0**2 - omega**2))
    sigma = (3.0 * omega - pair.w0) / pair.eps
    alpha, _ = amplitudes(coefficients(pair, omega))
    assert np.isfinite(alpha[:, 2]).sum() > 20
    detuning = (sigma - 3.0 * a * forced**2 / pair.w0)[:, None] - 3.0 * a * alpha**2 / (8.0 * pair.w0)
    left = (mu**2 + detuning**2) * alpha**2 / (a**2 * forced**6 / pair.w0**2)[:, None]
    assert left[np.isfinite(alpha)] == pytest.approx(1.0, rel=1e-6)


# --- exponents integrated in time -------------------------------------------------------------------------------------


@pytest.mark.parametrize("tau", [0.0, 0.4, 30.0])
def test_integrated_exponents_of_a_linear_delay_equation(tau):
    """They are roots of s^2 + w0^2 + eps (2 c zeta s - (g_d + g_v s) exp(-s tau)), shifted by i nu."""
    pair = replace(gear_pair("I"), q=0.0).having(tau_d=tau, tau_v=tau)
    omega = pair.w0 / 3.0 * 1.01
    balance = Balance(pair)
    for value in exponents_in_time(balance, balance.solve(omega)):
        s = min((value + 1j * k * omega for k in range(-4, 5)), key=lambda s: abs(abs(s.imag) - pair.w0))
        feedback = (pair.g_d + pair.g_v * s) * np.exp(-s * tau)
        assert abs(s**2 + pair.w0**2 + pair.eps * (2 * pair.c * pair.zeta * s - feedback)) < 1e-8


def test_integrated_exponents_are_hills():
    pair = folded("II")
    balance = Balance(pair)
    path = list(balance.follow(balance.solve(0.3285), 0.3325, 0.4))
    seen = []
    for orbit in path[::6]:
        hill, time = exponents(balance, orbit), exponents_in_time(balance, orbit)
        assert np.sort(time.real) == pytest.approx(np.sort(hill.real), abs=1e-8)
        assert np.abs(time.imag) == pytest.approx(np.abs(hill.imag), abs=1e-8)
        seen.append(hill[0].real < 0.0)
    assert {*seen} == {True, False}


@pytest.fixture(scope="module")
def gapped():
    """Stage II with the backlash behind its cubic: the equation and orbits along its branch."""
    pair = gear_pair("II")
    balance = balance_of(pair, equivalent(pair)[1])
    path = balance.follow(first_orbit(balance, 0.31), 0.36, 0.5)
    return balance, [orbit for _, orbit in zip(range(26), path, strict=False)]


def test_with_the_backlash_hill_and_integration_agree(gapped, monkeypatch):
    """Hill's series converges slowly there: 40 harmonics more bring it within 2e-4 of the integration."""
    balance, orbits = gapped
    monkeypatch.setattr("nw_gear_sim.superharmonic.floquet.MARGIN", 40)
    seen = []
    for orbit in (orbits[0], orbits[12], orbits[-1]):
        hill, time = exponents(balance, orbit), exponents_in_time(balance, orbit)
        assert np.sort(time.real) == pytest.approx(np.sort(hill.real), abs=2e-4)
        seen.append(bool(time[0].real < 0.0))
    assert {*seen} == {True, False}


def test_disturbances_of_an_orbit_with_backlash_grow_as_its_exponents_say(gapped):
    """Three motions close to each other over two periods: the eigenvalues of what becomes of their differences."""
    balance, orbits = gapped
    found, orbit = max(((exponents_in_time(balance, o).real, o) for o in orbits), key=lambda pair: pair[0][0])
    assert found[0] > 0.005
    steps = 12800  # a step with a contact in it has one stiffness or the other
    past = 2.0 * np.pi / orbit.omega / steps * np.arange(-steps, 1)
    speed = (orbit.at(past + 1e-4) - orbit.at(past - 1e-4)) / 2e-4
    motions = []
    for dx, dv in ((0.0, 0.0), (1e-5, 0.0), (0.0, 1e-5)):
        begin = orbit.at(past) + dx, speed + dv
        slope = balance.restoring.slope
        course = integrate(balance.pair, orbit.omega, 3, start=begin, steps_per_period=steps, slope=slope)
        motions.append(np.stack([course.x, course.v])[:, steps::steps])
    apart = np.stack([motions[1] - motions[0], motions[2] - motions[0]], axis=1)
    multipliers = np.linalg.eigvals(apart[:, :, 2] @ np.linalg.inv(apart[:, :, 0]))
    rates = np.sort(np.log(np.abs(multipliers)) / (4.0 * np.pi / orbit.omega))[::-1]
    assert rates == pytest.approx(found, rel=0.03)
