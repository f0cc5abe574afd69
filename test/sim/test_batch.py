"""Many points at once are the same points one by one, whatever stands beside them."""

import math

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_sim.assembly import start_phases
from nw_gear_sim.batch.batch import Batch
from nw_gear_sim.config import load, with_values
from nw_gear_sim.kinematics import derive

STEP = 1 / 20480
FLOATS = ("section_time", "section_x", "section_v", "x", "force", "open_fraction", "back_fraction", "diverged")


def points(count):
    """Points which differ in operation, meshes and bearings, down to rattling ones."""
    base = load()
    return [
        with_values(
            {
                "operation.load": 0.03 + 0.06 * k,
                "operation.ring_speed": 1.2 + 0.05 * k,
                "mesh.II.backlash": 40e-6 + 1e-6 * k,
                "mesh.I.damping_ratio": 0.03 + 0.002 * k,
                "bearings.pb1.clearance": 30e-6 + 2e-6 * k,
            },
            base,
        )
        for k in range(count)
    ]


def same(span, other, of=slice(None), to=slice(None)):
    for name in FLOATS:
        a, b = getattr(span, name)[of], getattr(other, name)[to]
        width = min(a.shape[-1], b.shape[-1]) if name.startswith("section") else a.shape[-1]
        np.testing.assert_array_equal(a[..., :width], b[..., :width], err_msg=name)


@pytest.fixture(scope="module")
def sweep():
    configurations = points(18)
    return configurations, Batch(configurations, step=STEP, sample_rate=5120).advance(0.05)


def test_a_point_is_the_same_alone(sweep):
    configurations, span = sweep
    for k in (0, 7, 17):
        alone = Batch(configurations[k : k + 1], step=STEP, sample_rate=5120).advance(0.05)
        same(alone, span, of=[0], to=[k])


def test_equal_points_are_equal_in_every_lane():
    batch = Batch(points(3)[2:] * 16, step=STEP)
    batch.advance(0.01)
    for name, part in batch.end().parts.items():
        np.testing.assert_array_equal(part, np.repeat(part[:, :1], 16, axis=1), err_msg=name)


def test_order_and_threads_do_not_matter(sweep):
    configurations, span = sweep
    order = np.random.default_rng(1).permutation(len(configurations))
    mixed = Batch([configurations[k] for k in order], step=STEP, sample_rate=5120, threads=1).advance(0.05)
    same(mixed, span, to=order)


def test_a_neighbour_with_other_shafts_and_another_ring_does_not_matter(sweep):
    configurations, span = sweep
    other = with_values({"shafts.planet_radial": 4e9, "ring.radial_support": 4e9}, configurations[1])
    beside = Batch([configurations[0], other], step=STEP, sample_rate=5120).advance(0.05)
    same(beside, span, of=[0], to=[0])
    assert np.max(np.abs(beside.x[1] - span.x[1])) > 1e-8


def test_an_interval_in_pieces_is_the_same(sweep):
    configurations, span = sweep
    batch = Batch(configurations[:2], step=STEP, sample_rate=5120)
    parts = [batch.advance(steps * STEP) for steps in (1, 300, 723)]
    np.testing.assert_array_equal(np.concatenate([part.x for part in parts], axis=1), span.x[:2])
    for k, mesh in enumerate(names.MESHES):
        for field in ("time", "x", "v"):
            joined = np.concatenate([getattr(part.section(0, mesh), field) for part in parts])
            np.testing.assert_array_equal(joined, getattr(span.section(0, mesh), field), err_msg=f"{k} {field}")
    assert batch.time == pytest.approx(0.05)


def test_another_batch_goes_on_where_one_ended():
    configurations = points(3)
    batch = Batch(configurations, step=STEP, sample_rate=5120)
    batch.advance(0.02)
    end = batch.end()
    expected = batch.advance(0.01)
    turned = Batch([configurations[k] for k in (2, 0)], step=STEP, sample_rate=5120, start=end.take([2, 0]))
    found = turned.advance(0.01)
    first = 410 * STEP - batch.time  # samples are at whole multiples of the rate since the start
    assert first < 0
    x = CubicSpline(expected.time - 410 * STEP, expected.x[2], axis=0)(found.time[2:-2])
    assert np.max(np.abs(found.x[0, 2:-2] - x)) < 2e-8


def test_points_of_a_section_lie_where_the_phase_passes_zero(sweep):
    configurations, span = sweep
    dense = Batch(configurations[3:4], step=STEP, sample_rate=1 / STEP).advance(0.05)
    curve = CubicSpline(dense.time, dense.x[0], axis=0)
    kinematics = derive(configurations[3])
    for k, mesh in enumerate(names.MESHES):
        stage = names.STAGES.index(names.STAGE_OF_MESH[mesh])
        section = span.section(3, mesh)
        phase = (
            start_phases(kinematics)[stage] + kinematics.stages[stage].mesh_ratio * kinematics.ring_speed * section.time
        )
        assert np.max(np.abs(np.remainder(phase + 1, 2 * math.pi) - 1)) < 1e-9
        assert len(section.time) >= 0.05 * kinematics.mesh_frequency_hz(mesh, kinematics.ring_speed) - 2
        inner = (section.time > 10 * STEP) & (section.time < 0.05 - 10 * STEP)
        assert inner.any()
        scale = np.ptp(dense.x[0, :, k])
        assert np.max(np.abs(section.x[inner] - curve(section.time[inner])[:, k])) < 3e-4 * scale
        rate = curve(section.time[inner], 1)[:, k]
        assert np.max(np.abs(section.v[inner] - rate)) < 0.02 * np.max(np.abs(curve(dense.time, 1)[:, k]))


def test_one_stage_sets_all_sections():
    span = Batch(points(1), step=STEP, section="I").advance(0.1)
    np.testing.assert_array_equal(span.section_time[0, 0], span.section_time[0, 6])


def test_fractions_count_what_the_waveform_shows(sweep):
    configurations, _ = sweep
    span = Batch(configurations[:1], step=STEP, sample_rate=1 / STEP).advance(0.05)
    backlash = [derive(configurations[0]).stage(mesh).mesh.backlash for mesh in names.MESHES]
    np.testing.assert_allclose(span.open_fraction[0], np.mean(np.abs(span.x[0]) <= backlash, axis=0), atol=2e-3)
    np.testing.assert_allclose(span.back_fraction[0], np.mean(span.x[0] < -np.array(backlash), axis=0), atol=2e-3)


def test_a_point_that_diverges_is_told_and_leaves_the_others_alone(sweep):
    configurations, span = sweep
    wild = with_values({"mesh.III.stiffness": 1e12}, configurations[1])
    found = Batch([configurations[0], wild, configurations[2]], step=STEP, sample_rate=5120).advance(0.05)
    assert np.isnan(found.diverged[[0, 2]]).all()
    assert 0 < found.diverged[1] < 0.05
    assert np.isnan(found.x[1][found.time >= found.diverged[1]]).all()
    same(found, span, of=[0, 2], to=[0, 2])


def test_bad_input_is_one_line():
    base = load()

    def refused(place, configurations, **more):
        with pytest.raises(InputError) as caught:
            Batch(configurations, **more)
        assert caught.value.place == place

    refused("configurations", [])
    refused("ring.segments", [base, with_values({"ring.segments": 90}, base)])
    refused("bearings.sb.rollers", [base, with_values({"bearings.sb.rollers": 31}, base)])
    refused("bearings.exponent", [base, with_values({"bearings.exponent": 1.5}, base)])
    refused("numerics.step", [base, with_values({"numerics.step": 1e-5}, base)])
    refused("ring", [base], ring="soft")
    refused("excitation", [base], excitation="random")
    refused("section", [base], section="IV")
    refused("start", [base], start="somewhere")
    refused("threads", [base], threads=0)
    refused("sample_rate", [base], sample_rate=5000.0)
    refused("step", [base], step=1e-3)
    batch = Batch([base], step=STEP, start="zero")
    for bad in ({}, {"seconds": 1.0, "periods": 2.0}, {"seconds": 1e-9}, {"seconds": math.inf}):
        with pytest.raises(InputError):
            batch.advance(**bad)
    with pytest.raises(InputError):
        batch.period("IV")
    with pytest.raises(InputError):
        Batch([base, base], step=STEP, start=batch.end())
    with pytest.raises(InputError):
        Batch([base], step=STEP / 2, start=batch.end())
    with pytest.raises(InputError):
        Batch([base], step=STEP, ring="rigid", start=batch.end())
