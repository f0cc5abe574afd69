"""The lanes hold the same gearbox as the full model."""

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_sim.batch.batch import Batch
from nw_gear_sim.batch.beginning import resting_state
from nw_gear_sim.batch.constants import block_laws, places
from nw_gear_sim.batch.lanes import LANES
from nw_gear_sim.batch.points import make_points, ring_keys
from nw_gear_sim.batch.rollers import power_law, raise_all
from nw_gear_sim.config import load, with_values
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.kinematics import derive
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.simulation import Simulation

RATE = 20480.0


def reference(configuration, samples, rate, start="zero", **numerics):
    values = {f"numerics.{key}": value for key, value in numerics.items()}
    kinematics = derive(configuration)
    speed, torque = kinematics.ring_speed, kinematics.input_torque
    drive = Drive(speed, speed, torque, torque)
    return (
        Simulation(with_values(values, configuration), drive, start=start, sample_rate=rate).advance(samples, drive).x
    )


@pytest.mark.parametrize("exponent", [1.0, 10 / 9, 1.5, 2.0])
def test_power_keeps_its_bound(exponent):
    depth = np.concatenate([10 ** np.linspace(-12, 0, 200001)[:-1], 2.0 ** np.arange(-39.0, 0.0)])
    found = depth.copy()
    raise_all(power_law(exponent), found)
    assert np.max(np.abs(found / depth**exponent - 1)) < 1e-6
    zero = np.zeros(LANES)
    raise_all(power_law(exponent), zero)
    assert not zero.any()


@pytest.mark.parametrize(("friction", "bound"), [(False, 1e-10), (True, 5e-8)])
def test_rest_is_that_of_the_full_model_where_planets_meet_centroids(friction, bound):
    """With M a multiple of 3 all planets touch at a centroid at angle 0, where both rules for the ring are the same.

    Friction on the modes that are left out isn't taken to their flexibility, hence the larger bound.
    """
    values = {"ring.segments": 99, "gravity.direction": 0.3, "friction.enabled": friction, "bearings.pb1.rollers": 27}
    configuration = with_values(values, load())
    points = make_points([configuration] * LANES, "kinematic", "flexible")
    state, residual = resting_state(block_laws(points, 1 / RATE, np.zeros(LANES), ring_keys(points)))
    assert np.max(residual) < 1e-3
    gearbox = Gearbox(configuration)
    full = find_equilibrium(gearbox, points[0].torque, speed=points[0].speed).q
    of = places(99)[1]
    there = of >= 0
    assert np.count_nonzero(there) == gearbox.layout.size - 4 * 99
    found = state.x.reshape(-1, LANES)[there]
    assert np.max(np.abs(found - full[4 * 99 :][of[there], None])) < bound


def test_rigid_ring_follows_the_full_model_with_order_2():
    """Against a method of order 4 with the same four motions of the ring; the start is an impact from rest."""
    configuration = load()
    exact = reference(configuration, 205, RATE, ring="rigid", integrator="etdrk4", step=1 / 163840)
    worst = []
    for step in (1 / 40960, 1 / 81920, 1 / 163840):
        found = Batch([configuration], ring="rigid", step=step, sample_rate=RATE, start="zero").advance(0.01).x[0]
        worst.append(np.max(np.abs(found[:205] - exact[: len(found)]), axis=0))
    assert np.max(worst[-1]) < 0.15e-6
    order = np.log2(np.max(worst[0]) / np.max(worst[1])), np.log2(np.max(worst[1]) / np.max(worst[2]))
    assert 1.8 < min(order) < max(order) < 2.4


def test_all_ring_modes_follow_the_full_model_at_standstill_with_order_2():
    """With M a multiple of 3 and the ring standing still the contacts are the same; the scheme has all modes."""
    values = {"ring.segments": 99, "operation.ring_speed": 0.0, "numerics.ring_bandwidth": 1e6}
    configuration = with_values(values, load())
    exact = reference(configuration, 80, RATE, integrator="rk4", step=1 / 163840)
    worst = []
    for step in (1 / 81920, 1 / 163840):
        found = Batch([configuration], step=step, sample_rate=RATE, start="zero").advance(80 / RATE).x[0]
        worst.append(np.max(np.abs(found[:80] - exact)))
    assert worst[-1] < 0.15e-6
    assert 1.8 < np.log2(worst[0] / worst[1]) < 2.4


@pytest.mark.slow
def test_at_rated_the_frame_changes_little():
    """Trigonometric interpolation against the blend of two segments, 2 s after the start: 0.23 um at most."""
    configuration = load()
    exact = reference(configuration, 3 * 5120, 5120.0, "equilibrium", integrator="rk4", step=1 / 40960)[2 * 5120 :]
    for step in (1 / 20480, 1 / 40960):
        found = Batch([configuration], step=step, sample_rate=5120.0).advance(3.0).x[0, 2 * 5120 :]
        assert np.max(np.abs(found - exact)) < 0.35e-6
        assert np.max(np.sqrt(np.mean((found - exact) ** 2, axis=0))) < 0.12e-6
        assert np.max(np.abs(found.std(axis=0) / exact.std(axis=0) - 1)) < 5e-3


def test_tied_excitation_runs_all_meshes_at_the_frequency_of_stage_two():
    configuration = with_values({"operation.load": 0.5}, load())
    span = Batch([configuration], excitation="tied", step=1 / RATE).advance(0.1)
    periods = np.array([np.nanmean(np.diff(span.section_time[0, k])) for k in range(len(names.MESHES))])
    np.testing.assert_allclose(
        periods, 1 / derive(configuration).mesh_frequency_hz("II", derive(configuration).ring_speed)
    )
