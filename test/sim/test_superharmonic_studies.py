"""Jumps, charts, sweeps in time, basins and the restoring forces behind `nw_gear study superharmonic`."""

from dataclasses import replace

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_sim.superharmonic import basins as basin_maps
from nw_gear_sim.superharmonic import gainmap, jumps, laws
from nw_gear_sim.superharmonic.contact import contacts
from nw_gear_sim.superharmonic.direct import integrate
from nw_gear_sim.superharmonic.exact import exact_branch, orbits_at
from nw_gear_sim.superharmonic.family import curves
from nw_gear_sim.superharmonic.firstorder import branches, coefficients
from nw_gear_sim.superharmonic.gainchecks import checks
from nw_gear_sim.superharmonic.harmonics import Balance, Orbit
from nw_gear_sim.superharmonic.lanes import advance, stepper
from nw_gear_sim.superharmonic.pair import gear_pair
from nw_gear_sim.superharmonic.question import ask
from nw_gear_sim.superharmonic.restoring import fit_cubic, interval_of, unit_backlash
from nw_gear_sim.superharmonic.sweeping import sweep

# --- restoring forces -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("interval", [1.3, 2.3, 3.0, 5.0, 20.0])
def test_errors_of_the_fit_are_those_of_a_dense_sample(interval):
    fit = fit_cubic(interval)
    x = np.linspace(-interval, interval, 400001)
    left = fit.delta_1 * x + fit.delta_2 * x**3 - unit_backlash(x)
    assert fit.greatest == pytest.approx(np.max(np.abs(left)), rel=1e-4)
    assert fit.rms == pytest.approx(np.sqrt(np.mean(left**2)), rel=1e-4)


@pytest.mark.parametrize("stage", ["I", "II", "III"])
def test_the_backlash_behind_the_cubic_has_that_cubic_as_its_fit(stage):
    pair = gear_pair(stage)
    fit, slope = laws.equivalent(pair)
    assert slope * fit.delta_1 == pytest.approx(pair.w0**2, rel=1e-12)
    assert slope * fit.delta_2 == pytest.approx(pair.eps * pair.q * pair.w0, rel=1e-9)
    again, _ = laws.fitted(pair, fit.interval, slope)
    assert (again.w0, again.q) == pytest.approx((pair.w0, pair.q), rel=1e-9)


def test_a_fit_replaces_w0_and_q():
    question = ask("II", "corrected", {}, fit=3.0, slope=2.0)
    assert question.pair.w0 == pytest.approx(np.sqrt(2.0 * 0.1728395), rel=1e-6)  # delta_1 of X = 3 is 14/81
    assert question.pair.eps * question.pair.q * question.pair.w0 == pytest.approx(2.0 * question.fit.delta_2)
    assert question.slope is None
    assert f"{question.fit.greatest:.4g}" in question.in_words()


def test_the_interval_of_a_ratio_is_where_the_fit_has_it():
    for interval in (2.3, 4.0, 30.0):
        fit = fit_cubic(interval)
        assert interval_of(fit.delta_2 / fit.delta_1) == pytest.approx(interval, rel=1e-9)


def test_contacts_of_a_cosine():
    """2 cos(theta) passes 1 at pi/3 and 5 pi/3, -1 at 2 pi/3 and 4 pi/3."""
    at = np.zeros(19)
    at[1] = 2.0
    angles, touching = contacts(Orbit(1.0, at))
    assert angles == pytest.approx(np.pi / 3.0 * np.array([1, 2, 4, 5]), abs=1e-12)
    assert not touching
    for size, expected in ((0.4, False), (9.0, True)):
        angles, touching = contacts(Orbit(1.0, np.r_[size * 0.5, 0.2 * size, np.zeros(17)]))
        assert (len(angles), touching) == (0, expected and size * 0.3 > 1.0)


# --- jumps ------------------------------------------------------------------------------------------------------------


def test_jumps_of_a_path_are_those_of_the_cubic():
    """omega = a^3 - 3 a has folds at a = -1 and 1; what leaves there lands at a = 2 and -2."""
    a = np.linspace(-2.5, 2.5, 401) + 1e-3
    up, down = jumps.of_path(a**3 - 3.0 * a, a + 5.0, [bool(abs(v) > 1.0) for v in a])
    assert (up.sweep, up.names, up.real) == ("up", ("A2", "A4"), True)
    assert (up.value, up.start, up.end) == pytest.approx((2.0, 4.0, 7.0), abs=1e-3)
    assert (down.sweep, down.names, down.real) == ("down", ("A3", "A1"), True)
    assert (down.value, down.start, down.end) == pytest.approx((-2.0, 6.0, 3.0), abs=1e-3)


@pytest.mark.parametrize(("over", "omega"), [("omega", None), ("g_d", 0.1598), ("zeta", 0.1598)])
def test_jumps_of_the_first_order_are_roots_at_the_folds(over, omega):
    """The start is a double root of the frequency response, the end the third one; the paper's order of A1-A4."""
    pair = gear_pair("I").having(zeta=0.04)
    values = {"omega": None, "g_d": np.linspace(-0.4, 0.4, 401), "zeta": np.linspace(0.0, 0.12, 401)}[over]
    given = {} if over == "omega" else {"over": (over, values)}
    (curve,) = curves(pair, "corrected", None if omega is None else np.array([omega]), **given)
    assert len(curve.jumps) == len(curve.branches.folds) > 0
    for jump in curve.jumps:
        c = coefficients(pair, jump.value) if omega is None else coefficients(pair, omega, **{over: jump.value})
        mu, s, bend, drive = (float(np.ravel(value)[0]) for value in (c.mu, c.shift, c.bend, c.drive))
        for alpha in (jump.start, jump.end):
            square = alpha**2
            assert square * (mu**2 + (s - bend * square) ** 2) == pytest.approx(drive**2, rel=1e-4)
        a = jump.start**2
        slope = mu**2 + (s - bend * a) ** 2 - 2.0 * a * bend * (s - bend * a)
        assert abs(slope) < 1e-4 * (mu**2 + (s - bend * a) ** 2 + 2.0 * a * bend * abs(s - bend * a))
        assert jump.names == (("A3", "A1") if jump.start > jump.end else ("A2", "A4"))


# --- charts -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("stage", "seed"), [("I", 1), ("II", 2), ("III", 3)])
def test_a_chart_has_the_folds_of_each_curve(stage, seed):
    """Against the zeros of the discriminant along the frequency, and the largest of many amplitudes."""
    pair = gear_pair(stage)
    rng = np.random.default_rng(seed)
    g_d, g_v = (np.sort(rng.uniform(-0.4, 0.4, 4)) for _ in range(2))
    chart = gainmap.chart(pair, [("g_d", g_d), ("g_v", g_v)])
    for i, j in np.ndindex(4, 4):
        member = pair.having(g_d=g_d[i], g_v=g_v[j])
        found = branches(member, "omega", np.linspace(pair.w0 / 6.0, 0.4995 * pair.w0, 12001))
        folds = [chart.low[i, j], chart.high[i, j]]
        assert np.isfinite(folds).sum() == len(found.folds)
        assert np.array(folds)[np.isfinite(folds)] == pytest.approx(found.folds, abs=1e-10)
        if np.isfinite(chart.peak[i, j]):
            assert chart.peak[i, j] == pytest.approx(np.nanmax(found.alpha), rel=3e-3)
        assert chart.mu[i, j] == pytest.approx(float(coefficients(member, 0.3).mu), rel=1e-12)


def test_without_delay_the_border_of_stability_is_a_gain():
    """mu = c zeta - g_v/2 there: no stable amplitude beyond g_v = 2 c zeta, whatever g_d."""
    pair = gear_pair("II").having(tau_d=0.0, tau_v=0.0)
    g_v = np.linspace(-0.4, 0.4, 41)
    chart = gainmap.chart(pair, [("g_v", g_v), ("g_d", np.array([-0.3, 0.0, 0.3]))], omega=0.33)
    assert chart.mu == pytest.approx(np.repeat((pair.c * pair.zeta - 0.5 * g_v)[:, None], 3, axis=1))
    assert np.array_equal(chart.count > 0, np.repeat((g_v < 2.0 * pair.c * pair.zeta)[:, None], 3, axis=1))
    assert np.isnan(chart.largest[chart.count == 0]).all()


def test_tau_is_both_delays():
    pair, values = gear_pair("III"), np.linspace(0.0, 2.0, 5)
    chart = gainmap.chart(pair, [("tau", values), ("zeta", np.array([0.05, 0.1]))])
    for k, tau in enumerate(values):
        expected = float(coefficients(pair.having(tau_d=tau, tau_v=tau, zeta=0.1), 0.35).mu)
        assert chart.mu[k, 1] == pytest.approx(expected, rel=1e-12)


def test_the_damping_of_a_chart_is_that_of_the_delay_equation():
    pair = gear_pair("II")
    chart = gainmap.chart(pair, [("g_d", np.array([-0.3, -0.1])), ("g_v", np.array([0.0, 0.2]))])
    found = list(checks(pair, chart, "corrected", per_axis=1))
    assert len(found) == 1
    assert found[0].exact_mu == pytest.approx(found[0].mu, rel=0.02)
    assert found[0].exact_folds == found[0].folds
    assert found[0].exact_peak == pytest.approx(found[0].peak, rel=0.15)


# --- in time ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("slope", [None, 1.12])
def test_lanes_go_as_the_single_integration_does(slope):
    pair = gear_pair("II").having(tau_d=0.7, tau_v=1.3)
    step = stepper(pair, 0.33, slope, 800)
    rows = np.zeros((step.back + 1, 3))
    started = rows.copy()
    started[:, 1] = 2.0
    x, v, _ = advance(step, (started, rows, rows), 4)
    course = integrate(pair, 0.33, 4, slope=slope, steps_per_period=800)
    assert (x[-1, 0], v[-1, 0]) == pytest.approx((course.x[-1], course.v[-1]), abs=1e-6)
    assert x[-1, 2] == x[-1, 0]
    assert abs(x[-1, 1] - x[-1, 0]) > 1e-3


def test_feedback_without_delay_is_stiffness_and_damping():
    """g_d x moves w0^2, g_v x' moves the damping: the same motion."""
    pair = gear_pair("I").having(tau_d=0.0, tau_v=0.0)
    rows = np.zeros((3, 1))
    plain = pair.having(g_d=0.0, g_v=0.0, zeta=pair.zeta - 0.5 * pair.g_v / pair.c)
    moved = stepper(plain, 0.16)
    moved.law[0] -= pair.eps * pair.g_d
    ends = [advance(step, (rows, rows, rows), 3)[0][-1, 0] for step in (stepper(pair, 0.16), moved)]
    assert ends[0] == pytest.approx(ends[1], rel=1e-12)


@pytest.fixture(scope="module")
def hysteresis():
    """Stage I with folds at 0.158929 and 0.159604, swept through them in time."""
    pair = gear_pair("I").having(zeta=0.04)
    return pair, sweep(pair, np.linspace(0.1586, 0.1599, 7))


def test_a_sweep_in_time_jumps_at_the_folds_of_the_branch(hysteresis):
    pair, found = hysteresis
    exact = exact_branch(pair, np.array([0.1583, 0.1601]))
    assert [jump.sweep for jump in found.jumps] == ["up", "down"]
    for seen, jump in zip(found.jumps, exact.jumps, strict=True):
        assert (seen.sweep, seen.names) == (jump.sweep, jump.names)
        assert seen.value == pytest.approx(jump.value, abs=2e-6)
        assert seen.start == pytest.approx(jump.start, rel=0.02)


def test_each_step_of_a_sweep_is_an_orbit(hysteresis):
    """Its alpha is that of a stable orbit of the balance: the upper one on the way up, the lower one back."""
    pair, found = hysteresis
    assert all(step.settled for step in found.steps)
    inside = [step for step in found.steps if 0.15893 < step.omega < 0.1596]
    assert len(inside) == 6
    known = {step.omega: orbits_at(pair, step.omega, 0.1583, 0.1601, None) for step in inside[:3]}
    for step in inside:
        stable = [orbit for orbit, safe in known[step.omega] if safe]
        assert len(stable) == 2
        assert step.alpha == pytest.approx(stable[1 if step.direction == "up" else 0].amplitude(3), rel=2e-3)


def test_a_motion_that_repeats_itself_after_several_periods_is_told():
    """Linear, undamped, from rest: a free motion at w0 = 4/3 omega stays beside the forced one; then at 5/4 omega."""
    pair = replace(gear_pair("II"), q=0.0).having(zeta=0.0, g_d=0.0, g_v=0.0)
    found = sweep(pair, pair.w0 * np.array([0.75, 0.8]), periods=60)
    assert [step.repeats for step in found.steps] == [3, 4, 4, 3]
    assert not any(step.settled for step in found.steps)
    assert found.jumps == ()
    for step in found.steps:  # there is nothing at 3 omega
        assert step.alpha < 1e-3
        assert step.high > 0.1


# --- basins -----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def two_motions():
    pair = gear_pair("I").having(zeta=0.04)
    return pair, orbits_at(pair, 0.1593, 0.157, 0.162, None)


@pytest.mark.parametrize("history", basin_maps.HISTORIES)
def test_every_start_ends_where_the_integration_does(two_motions, history):
    pair, orbits = two_motions
    assert [stable for _, stable in orbits] == [True, False, True]
    x, v = np.array([-9.0, -2.0, 8.0]), np.array([-3.0, 1.0])
    found = basin_maps.basins(pair, 0.1593, x, v, orbits, history=history, workers=2)
    assert {*found.ends.ravel().tolist()} == {0, 2}
    assert sum(found.shares) == 1.0
    steps, back = 400, 200
    for i, j in np.ndindex(3, 2):
        past = 2.0 * np.pi / 0.1593 / steps * np.arange(-back, 1)
        if history == "free":
            angle = pair.w0 * past
            begin = (x[i] * np.cos(angle) + v[j] / pair.w0 * np.sin(angle),
                     v[j] * np.cos(angle) - x[i] * pair.w0 * np.sin(angle))  # fmt: skip
        else:
            begin = np.full(back + 1, x[i]), np.r_[np.zeros(back), v[j]]
        course = integrate(pair, 0.1593, 300, start=begin, steps_per_period=steps)
        orbit = orbits[found.ends[i, j]][0]
        assert np.max(np.abs(course.x[-steps:] - orbit.at(course.time[-steps:]))) < 0.05


def test_an_unstable_orbit_lies_on_the_border(two_motions):
    """Starts on both sides of it along a line between the stable orbits end in different motions."""
    pair, orbits = two_motions
    saddle = np.array(basin_maps.state(orbits[1][0]))
    for k in (0, 2):
        towards = np.array(basin_maps.state(orbits[k][0])) - saddle
        place = saddle + 0.1 * towards
        found = basin_maps.basins(pair, 0.1593, place[:1], place[1:], orbits, history="free", workers=1)
        assert found.ends.ravel().tolist() == [k]


def test_a_motion_that_was_not_known_is_found(two_motions):
    """With the lower orbit kept from it, the map finds it by itself."""
    pair, orbits = two_motions
    x, v = np.array([8.0, 4.0]), np.array([-0.3, -2.5])
    found = basin_maps.basins(pair, 0.1593, x, v, orbits[1:], periods=600, workers=1)
    assert len(found.orbits) == 3
    assert found.orbits[2][0].amplitude(3) == pytest.approx(orbits[0][0].amplitude(3), rel=1e-9)
    assert found.elsewhere == 0.0
    assert {*found.ends.ravel().tolist()} == {1, 2}


def test_the_branch_with_backlash_agrees_with_time():
    """A stable orbit of the balance with the gap, gone on with in time, stays itself."""
    pair = gear_pair("III")
    slope = laws.equivalent(pair)[1]
    balance = laws.balance_of(pair, slope)
    orbit = laws.first_orbit(balance, 0.35)
    assert np.min(np.abs(orbit.at(np.linspace(0.0, 18.0, 400)))) < 1.0 < orbit.amplitude(1)
    past = 2.0 * np.pi / 0.35 / 1600 * np.arange(-1600, 1)
    speed = (orbit.at(past + 1e-4) - orbit.at(past - 1e-4)) / 2e-4
    course = integrate(pair, 0.35, 40, start=(orbit.at(past), speed), steps_per_period=1600, slope=slope)
    assert np.max(np.abs(course.x - orbit.at(course.time))) < 2e-3


# --- what is refused --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: interval_of(-1.0), "delta_2/delta_1"),
        (lambda: laws.fitted(gear_pair("I"), 2.0, 1.0), "2.2433"),
        (lambda: laws.fitted(gear_pair("I"), 3.0, 0.0), "above 0"),
        (lambda: ask("I", "corrected", {}, slope=1.0), "--slope"),
        (lambda: ask("I", "corrected", {}, restoring="steel"), "cubic or backlash"),
        (lambda: exact_branch(gear_pair("I"), np.array([0.15])), "a range"),
        (lambda: orbits_at(gear_pair("I"), 0.2, 0.15, 0.16, None), "between"),
        (lambda: stepper(gear_pair("I").having(tau_d=1e-9), 0.15), "tau_d"),
        (lambda: stepper(gear_pair("I"), -1.0), "above 0"),
        (lambda: sweep(gear_pair("I"), np.array([0.15])), "a range"),
        (lambda: sweep(gear_pair("I"), np.array([0.15, 0.16]), periods=5), "--periods"),
    ],
)
def test_refusals(call, match):
    with pytest.raises(InputError, match=match):
        call()


def test_the_cubic_is_the_default_law():
    balance = laws.balance_of(gear_pair("I"), None)
    assert isinstance(balance, Balance)
    assert laws.first_orbit(balance, 0.15).omega == 0.15
