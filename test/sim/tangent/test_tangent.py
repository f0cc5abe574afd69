"""The tangent of the motion against difference quotients, neighbouring motions and the modes at rest."""

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_sim import config
from nw_gear_sim.modal import stepping
from nw_gear_sim.modal.forces import mesh_rates
from nw_gear_sim.tangent import kernels
from nw_gear_sim.tangent.flow import Flow

QUOTIENT = 1e-10
"""Share of a deviation that difference quotients step by; forces are then of rounding 1e-9."""


def parts(flow):
    """What the kernels are called with at the start of an interval a little after the beginning."""
    interval = flow._over(1)._replace(angle=0.3)
    return flow._laws, flow._table, interval, flow._solver.instants, flow._solver.work


def shaken(flow, random):
    """A state about the equilibrium with some meshes open, some on their front and some on their back flanks."""
    x, _ = flow.state
    reach = flow._laws.reach
    return x + 1e-5 * reach * random.standard_normal(len(x)), 1e-2 * reach * random.standard_normal(len(x))


def quotient(flow, x, v, dx, dv):
    """The derivative of the forces per mass along (dx, dv), by central differences of the compiled forces."""
    laws, table, interval, instants, work = parts(flow)
    above, below = np.empty(len(x)), np.empty(len(x))
    for out, sign in ((above, QUOTIENT), (below, -QUOTIENT)):
        stepping.evaluate(laws, table, table, interval, x + sign * dx, v + sign * dv, instants, work, out)
    return (above - below) / (2 * QUOTIENT)


@pytest.mark.parametrize(
    ("ring", "gap"), [("rigid", True), ("rigid", False), ("flexible", True)], ids=["rigid", "undamped gap", "flexible"]
)
def test_tangent_is_the_derivative_of_the_forces(ring, gap):
    configuration = config.with_values({"mesh.damping_in_gap": gap}, config.load("rattling"))
    flow, random, worst, seen = Flow(configuration, 3, ring=ring), np.random.default_rng(1), 0.0, set()
    laws, table, interval, instants, work = parts(flow)
    slope, reach = flow._slope, laws.reach[:, None]
    for _ in range(6):
        x, v = shaken(flow, random)
        slope.here[:] = reach * random.standard_normal(slope.here.shape) * np.array([1.0, 1e3])[:, None, None]
        kernels.derivative(laws, table, interval, x, v, instants, work, slope)
        found, elastic = slope.push[0].copy(), work.contact.elastic.copy()
        seen |= set(np.sign(elastic))
        for k in range(3):
            wanted = quotient(flow, x, v, slope.here[0, :, k], slope.here[1, :, k])
            worst = max(worst, float(np.max(np.abs(found[:, k] - wanted)) / np.max(np.abs(wanted))))
    assert seen == {-1.0, 0.0, 1.0}
    assert worst < 1e-7


def test_divergence_is_the_trace():
    flow, random = Flow(config.load("rattling"), 1), np.random.default_rng(2)
    laws, table, interval, instants, work = parts(flow)
    x, v = shaken(flow, random)
    kernels.derivative(laws, table, interval, x, v, instants, work, flow._slope)
    trace, none = -float(np.sum(laws.damping)), np.zeros_like(x)
    for i in range(len(x)):
        unit = none.copy()
        unit[i] = 1e9  # 0.1 m/s, the forces are linear in velocities
        trace += quotient(flow, x, v, none, unit)[i] / unit[i]
    assert flow._slope.divergence[0] == pytest.approx(trace, rel=1e-7)


def test_flanks_that_meet_or_part_give_the_impulse_of_the_saltation_matrix():
    """dv+ = dv- + (f+ - f-) dX / X', with the jump f+ - f- as the forces with and without damping in the gap differ."""
    rattling = config.load("rattling")
    undamped, damped = (Flow(config.with_values({"mesh.damping_in_gap": g}, rattling), 1) for g in (False, True))
    random, slope = np.random.default_rng(3), undamped._slope
    x, v = shaken(undamped, random)
    force = []
    for flow in (damped, undamped):
        laws, table, interval, instants, work = parts(flow)
        kernels.derivative(laws, table, interval, x, v, instants, work, flow._slope)
        force.append(work.slopes[0].copy())
    still = work.contact.elastic == 0.0
    assert 0 < np.count_nonzero(still) < 7
    mesh_rates(laws, instants, 0, x, v, work)
    rate, dx = work.contact.rate.copy(), laws.reach * random.standard_normal(len(x))
    ends = []
    for sign in (1e-9, -1e-9):
        stepping.evaluate(laws, table, table, interval, x + sign * dx, v, instants, work, np.empty(len(x)))
        ends.append(work.contact.x.copy())
    elongation, jump = (ends[0] - ends[1]) / 2e-9, np.zeros(len(x))
    for mesh in np.flatnonzero(still):
        for before, after, sign in ((0.0, 1.0, 1.0), (1.0, 0.0, -1.0)):
            slope.carrying[:] = np.where(np.arange(7) == mesh, before, 1.0)
            elastic = np.where(np.arange(7) == mesh, after, 1.0)
            dv = np.zeros((len(x), 1))
            kernels.meet(laws, elastic, slope, dx[:, None].copy(), dv)
            if sign > 0.0:
                jump += dv[:, 0] * rate[mesh] / elongation[mesh]
                met = dv
        assert np.array_equal(dv, -met)
    assert np.max(np.abs(jump - (force[0] - force[1]))) < 1e-6 * np.max(np.abs(jump))


def apart(configuration, steps, separation, ring="rigid"):
    """Deviations after some steps by the tangent, and by a neighbouring motion `separation` m away."""
    flow, twin = (Flow(configuration, 1, ring=ring) for _ in range(2))
    start = flow.beginning()
    for each in (flow, twin):
        each.settle(0.2)
    state = twin._solver.state()
    moved = separation * (start.reshape(2, -1, 1) / flow._weight)[:, :, 0]
    twin._solver.restore({"x": state["x"] + moved[0], "v": state["v"] + moved[1]})
    carried, _ = flow.carry(start, steps)
    twin.settle(steps * twin.step)
    difference = np.stack([there - here for here, there in zip(flow.state, twin.state, strict=True)])
    return carried.ravel(), (difference[:, :, None] * flow._weight).ravel() / separation


def test_deviation_follows_a_neighbouring_motion():
    """At rated load, where flanks stay in contact, up to what a step of the difference leaves."""
    carried, wanted = apart(config.load("rated"), 400, 1e-4)
    assert np.max(np.abs(carried - wanted)) < 1e-4 * np.max(np.abs(wanted))


@pytest.mark.slow
def test_deviation_follows_a_neighbour_through_rattling():
    """Flanks that meet and part twenty times in 10 ms, with damping inside the gap."""
    fine = config.with_values({"numerics.step": 1 / 81920}, config.load("rattling"))
    carried, wanted = apart(fine, 819, 1e-5)
    assert np.max(np.abs(carried - wanted)) < 2e-3 * np.max(np.abs(wanted))


@pytest.mark.slow
def test_all_deviations_shrink_by_the_divergence():
    """log |det| of the map of some steps is the integral of the trace; off by the fifth power of the step."""
    off = []
    for step, steps in ((1 / 20480, 20), (1 / 40960, 40), (1 / 81920, 80)):
        flow = Flow(config.load("rattling"), 134, step=step)
        carried, divergence = flow.carry(np.eye(134), steps)
        grown = float(np.linalg.slogdet(carried)[1]) / (steps * step)
        off.append(abs(grown / divergence - 1))
    assert off[0] < 2e-3
    assert off[2] < 1e-5
    assert off[0] / off[1] > 12


@pytest.mark.parametrize(
    ("change", "named"),
    [({"ring": "elastic"}, "ring"), ({"excitation": "none"}, "excitation"), ({"count": 135}, "count")],
)
def test_refused(change, named):
    with pytest.raises(InputError, match=named):
        Flow(config.load("rated"), **{"count": 1, **change})
