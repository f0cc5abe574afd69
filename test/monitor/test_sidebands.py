"""Sidebands of modulated mesh lines against closed forms."""

import numpy as np
import pytest
from scipy.special import jv

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.sidebands import sideband_energy_ratio, sidebands

TEETH = (37, 24)
TURN = 2 * np.pi


def steady(turns=8, per_mesh=40):
    """Mesh phase over whole turns of the driver at constant speed."""
    return TURN * np.arange(turns * TEETH[0] * per_mesh) / per_mesh


def rising(turns=12, samples=40_000):
    """Mesh phase while the speed rises by a fifth."""
    t = np.linspace(0.0, 1.0, samples)
    return TURN * turns * TEETH[0] * (0.9 * t + 0.1 * t * t)


@pytest.mark.parametrize("phase", [steady(), rising()], ids=["steady", "rising"])
def test_amplitude_modulation_by_either_gear(phase):
    """(1 + m cos s theta) A cos(phi) has two sidebands of m A / 2."""
    x = 2.0 * (1 + 0.3 * np.cos(phase / TEETH[0]) + 0.1 * np.cos(phase / TEETH[1] + 1.0)) * np.cos(phase)
    x += 0.5 * np.cos(2 * phase) + 0.2 * np.cos(3 * phase) + 7.0
    found = sidebands(phase, x, TEETH)
    assert found.mesh == pytest.approx([2.0, 0.5, 0.2], rel=1e-3)
    assert found.driver[0, 0] == pytest.approx([0.3, 0.3], rel=1e-3)
    assert found.driven[0, 0] == pytest.approx([0.1, 0.1], rel=0.01)
    others = np.concatenate([found.driver[0, 1:].ravel(), found.driven[0, [2, 3, 4]].ravel(), found.driver[1:].ravel()])
    assert others.max() < 2e-3
    assert sideband_energy_ratio(found.driver, found.mesh) == pytest.approx([0.3, 0.0, 0.0], abs=0.01)
    assert sideband_energy_ratio(found.driven, found.mesh) == pytest.approx([0.1, 0.0, 0.0], abs=0.01)


def test_phase_modulation_has_the_sidebands_of_bessel():
    """cos(phi + b sin theta) = sum_s J_s(b) cos(phi + s theta)."""
    b = 0.8
    phase = steady(turns=24)
    found = sidebands(phase, np.cos(phase + b * np.sin(phase / TEETH[1])), TEETH, harmonics=1)
    assert found.mesh == pytest.approx([jv(0, b)], rel=1e-3)
    for s in range(1, 5):
        assert found.driven[0, s - 1] == pytest.approx([jv(s, b)] * 2, abs=2e-4)
    ser = 2 * sum(jv(s, b) for s in range(1, 7)) / jv(0, b)
    assert sideband_energy_ratio(found.driven, found.mesh) == pytest.approx([ser], rel=2e-3)


def test_both_modulations_together_make_the_sidebands_unequal():
    """With m cos and b sin in step one side has (m + b) / 2, the other (m - b) / 2 for small m and b."""
    m, b = 0.02, 0.01
    phase = steady()
    turn = phase / TEETH[0]
    found = sidebands(phase, (1 + m * np.cos(turn)) * np.cos(phase + b * np.sin(turn)), TEETH, harmonics=1)
    assert found.driver[0, 0] == pytest.approx([(m - b) / 2, (m + b) / 2], rel=0.02)


def test_sidebands_that_two_gears_share_are_named():
    """3/37 and 2/24 of a mesh order are 1/444 apart: 888 cycles part them, 296 don't."""
    for turns, alone in ((8, False), (25, True)):
        phase = steady(turns)
        found = sidebands(phase, np.cos(phase) * (1 + 0.1 * np.cos(2 * phase / TEETH[1])), TEETH, harmonics=1)
        assert (found.driver_alone[2], found.driven_alone[1]) == (alone, alone)
        assert found.driver_alone[0]
        assert (found.driver[0, 2].max() < 0.005) == alone
        assert found.driven[0, 1] == pytest.approx([0.05, 0.05], rel=0.01)


def test_noise_reads_in_every_sideband_what_it_must():
    phase = steady()
    x = np.cos(phase) + 0.1 * np.random.default_rng(1).standard_normal(phase.size)
    found = sidebands(phase, x, TEETH, harmonics=1)
    assert found.mesh == pytest.approx([1.0], abs=0.01)
    # Each of the 12 sidebands reads about 0.1 sqrt(pi) sqrt(1.5 / N).
    assert found.driver.sum() == pytest.approx(12 * 0.1 * np.sqrt(np.pi * 1.5 / x.size), rel=0.5)


PHASE = steady()
WAVE = np.cos(PHASE) + 0.1 * np.cos(2 * PHASE) + 0.1 * np.cos(3 * PHASE)


@pytest.mark.parametrize(
    ("arguments", "keywords", "place"),
    [
        ((PHASE, np.where(PHASE > 9, np.nan, WAVE), TEETH), {}, "x"),
        ((PHASE, np.where(PHASE > 9, np.inf, WAVE), TEETH), {}, "x"),
        ((PHASE, np.ones_like(WAVE), TEETH), {}, "x"),
        ((PHASE[:3000], WAVE[:3000], TEETH), {}, "phase"),
        ((np.minimum(PHASE, 9.0), WAVE, TEETH), {}, "phase"),
        ((PHASE[::6], WAVE[::6], TEETH), {}, "x"),
        ((PHASE, WAVE, (37, 2)), {}, "teeth"),
        ((PHASE, WAVE, (37, 10)), {}, "count"),
        ((PHASE, WAVE, TEETH), {"harmonics": 0}, "harmonics"),
        ((PHASE, np.cos(PHASE / TEETH[0]), TEETH), {}, "x"),
    ],
)
def test_bad_input_is_refused(arguments, keywords, place):
    with pytest.raises(InputError) as caught:
        sidebands(*arguments, **keywords)
    assert caught.value.place == place


def test_a_ratio_needs_a_mesh_line():
    for amplitudes, mesh in (
        (np.ones((1, 6, 2)), np.zeros(1)),
        (np.ones((1, 6, 2)), np.array([np.nan])),
        (np.full((1, 6, 2), np.nan), np.ones(1)),
        (np.ones((2, 6, 2)), np.ones(1)),
    ):
        with pytest.raises(InputError):
            sideband_energy_ratio(amplitudes, mesh)
