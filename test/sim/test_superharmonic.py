"""Superharmonic resonance: first order, harmonic balance and exponents against closed forms, each other and time."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nw_gear_common.errors import InputError
from nw_gear_sim.superharmonic import claims
from nw_gear_sim.superharmonic.direct import integrate
from nw_gear_sim.superharmonic.firstorder import (
    MODES,
    Coefficients,
    amplitudes,
    branches,
    coefficients,
    critical_damping,
    peak,
    trust,
)
from nw_gear_sim.superharmonic.floquet import exponents
from nw_gear_sim.superharmonic.harmonics import Balance, basis
from nw_gear_sim.superharmonic.pair import STAGES, GearPair, gear_pair
from nw_gear_sim.superharmonic.restoring import Backlash, fit_cubic, unit_backlash

small = st.floats(0.02, 2.0)


def linear_response(pair: GearPair, omega: float) -> float:
    """Amplitude of the linear oscillator with delayed feedback."""
    s = 1j * omega
    feedback = pair.g_d * np.exp(-s * pair.tau_d) + s * pair.g_v * np.exp(-s * pair.tau_v)
    return abs(pair.force / (pair.w0**2 + s**2 + pair.eps * (2 * pair.c * pair.zeta * s - feedback)))


# --- first order ------------------------------------------------------------------------------------------------------


@given(mu=small, shift=st.floats(-3.0, 3.0), bend=small, drive=small)
@settings(max_examples=200, deadline=None)
def test_amplitudes_are_all_roots_of_the_frequency_response(mu, shift, bend, drive):
    alpha, _ = amplitudes(Coefficients(mu, shift, bend, drive, 1.0))
    found = alpha[0][np.isfinite(alpha[0])] ** 2
    left = found * (mu**2 + (shift - bend * found) ** 2)
    assert left == pytest.approx(drive**2, rel=1e-6)
    a = np.linspace(0.0, 2.0345 * max(found), 20001)
    crossings = np.count_nonzero(np.diff(np.sign(a * (mu**2 + (shift - bend * a) ** 2) - drive**2)))
    assert crossings in (len(found), len(found) - 2)  # two that are closer than the grid aren't seen


def test_stability_is_that_of_the_modulation_equations():
    """Eigenvalues of the Jacobian of (alpha', phi'), by differences."""
    pair = gear_pair("I").having(zeta=0.03)
    c = coefficients(pair, np.linspace(0.155, 0.162, 40))
    alpha, stable = amplitudes(c)
    seen = set()
    for k, j in itertools.product(range(40), range(3)):
        if not np.isfinite(alpha[k, j]):
            continue
        mu, s, bend, drive = (float(np.asarray(x)[k]) for x in (c.mu, c.shift, c.bend, c.drive))
        phase = np.arctan2(-mu * alpha[k, j] / drive, alpha[k, j] * (s - bend * alpha[k, j] ** 2) / drive)

        def slope(z, mu=mu, s=s, bend=bend, drive=drive):
            return np.array([-mu * z[0] - drive * np.sin(z[1]), s - bend * z[0] ** 2 - drive * np.cos(z[1]) / z[0]])

        z = np.array([alpha[k, j], phase])
        assert slope(z) == pytest.approx(0.0, abs=1e-9)
        jacobian = np.column_stack([(slope(z + d) - slope(z - d)) / 2e-6 for d in 1e-6 * np.eye(2)])
        assert stable[k, j] == (np.linalg.eigvals(jacobian).real.max() < 0.0)
        seen.add(bool(stable[k, j]))
    assert seen == {True, False}


def test_without_delay_it_is_the_duffing_oscillator_of_nayfeh_and_mook():
    """Nonlinear Oscillations (1979), Sec. 4.1.3: peak eps alpha Lam^3/(mu w0) at sigma = 3 (1 + Lam^4/..) ...

    For u'' + w0^2 u + 2 eps mu u' + eps a u^3 = K cos(nu t): peak amplitude a Lam^3/(mu w0) where
    sigma = 3 a Lam^2/w0 + 3 a^3 Lam^6/(8 mu^2 w0^3).
    """
    pair = gear_pair("II").having(g_d=0.0, g_v=0.0, mean_force=0.0)
    a, mu = pair.q * pair.w0, pair.c * pair.zeta
    omega = pair.w0 / 3.0
    for _ in range(50):  # Lam depends on nu
        forced = pair.force / (2.0 * (pair.w0**2 - omega**2))
        sigma = 3.0 * a * forced**2 / pair.w0 + 3.0 * a**3 * forced**6 / (8.0 * mu**2 * pair.w0**3)
        omega = (pair.w0 + pair.eps * sigma) / 3.0
    alpha, _ = amplitudes(coefficients(pair, omega))
    assert np.nanmax(alpha) == pytest.approx(a * forced**3 / (mu * pair.w0), rel=1e-9)


def test_folds_come_with_the_critical_damping():
    """With Lam constant over the resonance, two folds where |mu| < mu_c, none where it is larger."""
    for factor, folds in ((0.98, 2), (1.02, 0)):
        pair = replace(gear_pair("II"), eps=1e-6)  # so narrow that Lam doesn't change
        limit = float(critical_damping(coefficients(pair, pair.w0 / 3.0)))
        excess = factor * limit - float(coefficients(pair, pair.w0 / 3.0).mu)
        pair = pair.having(zeta=pair.zeta + excess / pair.c)
        around = pair.w0 / 3.0 + pair.eps * np.linspace(0.0, 2.0, 4001)
        assert len(branches(pair, "omega", around).folds) == folds


@pytest.mark.parametrize(("mode", "count"), [("corrected", 107), ("paper_eq75", 93)])
def test_claims_that_hold(mode, count):
    """Two independent countings by the same rules gave these numbers of 131."""
    outcomes = claims.judge(mode)
    assert len(outcomes) == 131
    assert claims.held(outcomes) == count


def test_the_third_pair_contradicts_itself():
    """Its base point must have no unstable branch (Fig. 29) and must have one (Fig. 30)."""
    outcomes = {outcome.claim.id: outcome for outcome in claims.judge()}
    assert [name for name, outcome in outcomes.items() if outcome.holds == "contradicts"] == ["30a.0"]
    pair = gear_pair("III")
    assert (pair.g_d, pair.g_v) == (0.2, 0.1)
    mus = [float(coefficients(pair.having(g_v=g), pair.w0 / 3.0).mu) for g in (0.0, 0.1, 0.2)]
    assert mus[1] == pytest.approx(0.5 * (mus[0] + mus[2]))
    for outcome in outcomes.values():
        assert outcome.claim.text
        assert outcome.value


# --- restoring force --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("interval", [1.5, 3.0, 4.0, 5.0])
def test_the_cubic_fits_the_backlash_best(interval):
    fit = fit_cubic(interval)
    x = np.linspace(-interval, interval, 400001)
    columns = np.stack([x, x**3], axis=1)
    best, *_ = np.linalg.lstsq(columns, unit_backlash(x), rcond=None)
    assert (fit.delta_1, fit.delta_2) == pytest.approx(tuple(best), abs=1e-5)
    left = unit_backlash(x) - columns @ best
    assert fit.error == pytest.approx(np.sqrt(np.mean(left**2) / np.mean(unit_backlash(x) ** 2)), rel=1e-4)


def test_a_fit_within_the_gap_is_refused():
    with pytest.raises(InputError, match="half the backlash"):
        fit_cubic(0.9)


# --- the delay equation -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("stage", STAGES)
def test_without_cubic_the_response_is_the_transfer_function(stage):
    pair = replace(gear_pair(stage), q=0.0)
    for omega in (0.2 * pair.w0, 0.9 * pair.w0, 1.3 * pair.w0):
        orbit = Balance(pair).solve(omega)
        assert orbit.amplitude(1) == pytest.approx(linear_response(pair, omega), rel=1e-12)
        assert orbit.amplitude(3) < 1e-12


def test_exponents_of_the_linear_delay_equation():
    """They are roots of s^2 + w0^2 + eps (2 c zeta s - g_d exp(-s tau_d) - g_v s exp(-s tau_v))."""
    pair = replace(gear_pair("I"), q=0.0)
    omega = pair.w0 / 3.0 * 1.01
    balance = Balance(pair)
    for value in exponents(balance, balance.solve(omega)):
        shifted = [value + 1j * k * omega for k in (-3, 3)]
        left = [
            s**2
            + pair.w0**2
            + pair.eps
            * (2 * pair.c * pair.zeta * s - pair.g_d * np.exp(-s * pair.tau_d) - pair.g_v * s * np.exp(-s * pair.tau_v))
            for s in shifted
        ]
        assert min(abs(rest) for rest in left) < 1e-10


def test_harmonic_balance_agrees_with_integration():
    pair = gear_pair("II")
    orbit = Balance(pair, order=13).solve(0.3297)
    course = integrate(pair, 0.3297, 900, steps_per_period=800)
    last = slice(-800, None)
    assert np.max(np.abs(course.x[last] - orbit.at(course.time[last]))) < 1e-5


def history(orbit, steps):
    """Displacement and velocity of an orbit over some steps before time 0."""
    past = 2.0 * np.pi / orbit.omega / steps * np.arange(-steps, 1)
    return orbit.at(past), (orbit.at(past + 1e-4) - orbit.at(past - 1e-4)) / 2e-4


def test_integration_is_of_fourth_order():
    pair = gear_pair("I")
    orbit = Balance(pair, order=13).solve(0.159)
    ends = [integrate(pair, 0.159, 2, start=history(orbit, n), steps_per_period=n).x[-1] for n in (200, 400, 800, 6400)]
    errors = np.abs(np.array(ends[:3]) - ends[3])
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx(4.0, abs=0.4)


def test_backlash_by_balance_and_by_integration():
    """With the gap itself, at an amplitude that separates the flanks."""
    pair, slope = replace(gear_pair("II"), eps=0.03).having(zeta=0.8), 1.1
    course = integrate(pair, 0.45, 300, slope=slope, steps_per_period=1024)
    last = slice(-1024, None)
    balance = Balance(pair, Backlash(slope), order=25, samples=1024)
    near = np.linalg.lstsq(basis(25, 0.45 * course.time[last]), course.x[last], rcond=None)[0]
    orbit = balance.solve(0.45, np.round(near, 1))
    assert np.min(np.abs(course.x[last])) < 1.0 < np.max(np.abs(course.x[last]))
    assert np.max(np.abs(course.x[last] - orbit.at(course.time[last]))) < 1e-3 * np.max(np.abs(course.x))


@pytest.mark.parametrize("stage", ["II", "III"])
def test_the_error_of_the_first_order_falls_with_eps(stage):
    errors = []
    for eps in (0.001, 0.003, 0.01):
        pair = replace(gear_pair(stage), eps=eps)
        low, high = pair.w0 / 3.0 * (1.0 - 4.0 * eps), pair.w0 / 3.0 * (1.0 + 8.0 * eps)
        balance = Balance(pair)
        exact = max(orbit.amplitude(3) for orbit in balance.follow(balance.solve(low), high, 0.05))
        first = np.nanmax(branches(pair, "omega", np.linspace(low, high, 20001)).alpha)
        errors.append(first / exact - 1.0)
        if trust(pair, coefficients(pair, pair.w0 / 3.0)) < 0.005:
            assert abs(errors[-1]) < 0.05
    assert errors[2] / errors[1] == pytest.approx(10.0 / 3.0, rel=0.25)
    assert errors[1] / errors[0] == pytest.approx(3.0, rel=0.25)


@pytest.mark.parametrize("stage", STAGES)
def test_exponents_change_sign_at_the_folds_and_nowhere_else(stage):
    """A branch through both folds: unstable exactly while the frequency goes back."""
    pair = replace(gear_pair(stage), eps=0.001).having(g_d=0.0, g_v=0.0)
    pair = pair.having(zeta=0.5 * float(critical_damping(coefficients(pair, pair.w0 / 3.0))) / pair.c)
    low, high = pair.w0 / 3.0 * 0.997, pair.w0 / 3.0 * 1.01
    balance = Balance(pair)
    orbits = list(balance.follow(balance.solve(low), high, 0.15))
    omega = np.array([orbit.omega for orbit in orbits])
    forward = np.sign(np.diff(omega))
    clear = np.ones(len(orbits), dtype=bool)  # not next to a fold
    for fold in np.flatnonzero(np.diff(forward)):
        clear[fold - 1 : fold + 4] = False
    assert np.count_nonzero(np.diff(forward)) == 2
    assert np.count_nonzero(clear) > 50
    largest = np.array([exponents(balance, orbit)[0].real for orbit in orbits])
    assert np.array_equal((largest > 0.0)[clear], np.append(forward, 1.0)[clear] < 0.0)
    alpha, stable = amplitudes(coefficients(pair, omega))
    compared = 0
    for k in np.flatnonzero(clear):  # first order says the same of its nearest amplitude
        apart = np.sort(np.abs(alpha[k] / orbits[k].amplitude(3) - 1.0))
        if apart[0] < 0.05 and not apart[1] < 0.2:
            nearest = int(np.nanargmin(np.abs(alpha[k] / orbits[k].amplitude(3) - 1.0)))
            assert stable[k, nearest] == (largest[k] < 0.0)
            compared += 1
    assert compared > 50


def test_an_unstable_orbit_is_left_as_its_exponent_says():
    pair = replace(gear_pair("II"), eps=0.01).having(zeta=0.02, g_d=0.0, g_v=0.0)
    balance = Balance(pair, order=13)
    orbits = list(balance.follow(balance.solve(0.325), 0.335, 0.1))
    values = [exponents(balance, orbit)[0] for orbit in orbits]
    k = int(np.argmax([value.real for value in values]))
    orbit, rate = orbits[k], values[k].real
    assert rate > 0.0
    assert abs(values[k].imag) < 1e-9
    x, v = history(orbit, 1600)
    course = integrate(pair, orbit.omega, 250, start=(x + 1e-4, v), steps_per_period=1600)
    apart = np.abs(course.x[::1600] - orbit.at(np.zeros(1)))
    growth = np.polyfit(course.time[::1600][120:], np.log(apart[120:]), 1)[0]
    assert growth == pytest.approx(rate, rel=0.02)


# --- what is refused --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: gear_pair("IV"), "stage: expected one of I, II, III"),
        (lambda: gear_pair("I").having(zeta=float("nan")), "zeta"),
        (lambda: gear_pair("I").having(tau_d=-1.0), "tau_d"),
        (lambda: gear_pair("I").having(stiffness=1.0), "stiffness"),
        (lambda: coefficients(gear_pair("I"), 0.1, "paper"), "corrected or paper_eq75"),
        (lambda: branches(gear_pair("I"), "zeta", np.linspace(0, 1, 3)), "omega"),
        (lambda: branches(gear_pair("I"), "mass", np.linspace(0, 1, 3)), "axis"),
        (lambda: branches(gear_pair("I"), "omega", np.array([])), "values of omega"),
        (lambda: integrate(gear_pair("I"), 0.1, 0), "above 0"),
        (lambda: integrate(gear_pair("I").having(tau_d=1e-9), 0.1, 1), "tau_d"),
    ],
)
def test_refusals(call, match):
    with pytest.raises(InputError, match=match):
        call()


def test_both_modes_give_the_same_without_velocity_gain():
    pair = gear_pair("I").having(g_v=0.0)
    a, b = (coefficients(pair, 0.155, mode) for mode in MODES)
    assert float(a.shift) == float(b.shift)
    assert float(peak(a)) == float(peak(b))
