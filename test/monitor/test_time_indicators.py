"""Indicators of single signals against closed forms."""

import numpy as np
import pytest

from nw_gear_monitor.indicators import registry
from nw_gear_monitor.indicators.crest_factor import crest_factor
from nw_gear_monitor.indicators.kurtosis import kurtosis
from nw_gear_monitor.indicators.mean import mean
from nw_gear_monitor.indicators.mesh_harmonics import harmonic_amplitudes
from nw_gear_monitor.indicators.off_line_ratio import off_line_ratio
from nw_gear_monitor.indicators.peak_to_peak import peak_to_peak
from nw_gear_monitor.indicators.rms import rms
from nw_gear_monitor.indicators.tonal_share import tonal_share
from nw_gear_monitor.indicators.window import MeshWindow
from nw_gear_monitor.indicators.zero_one import zero_one
from test.monitor.gear_signal import logistic

SINE = 5.0 + 2.0 * np.sin(2 * np.pi * np.arange(10_000) / 100)


def test_sine():
    assert mean(SINE) == pytest.approx(5.0)
    assert rms(SINE) == pytest.approx(2.0 / np.sqrt(2))
    assert peak_to_peak(SINE) == pytest.approx(4.0)
    assert crest_factor(SINE) == pytest.approx(np.sqrt(2))
    assert kurtosis(SINE) == pytest.approx(1.5)


def test_normal_noise_has_kurtosis_three():
    assert kurtosis(np.random.default_rng(2).standard_normal(400_000)) == pytest.approx(3.0, abs=0.03)


def test_a_constant_has_no_shape():
    assert np.isnan(crest_factor(np.ones(10)))
    assert np.isnan(kurtosis(np.ones(10)))


def test_energy_outside_the_mesh_lines():
    phase = 2 * np.pi * np.arange(20_000) / 50
    own, foreign = np.cos(phase), 0.5 * np.cos(1.31 * phase)
    assert off_line_ratio(harmonic_amplitudes(phase, own), own) == pytest.approx(0.0, abs=1e-4)
    both = own + foreign
    assert off_line_ratio(harmonic_amplitudes(phase, both), both) == pytest.approx(0.2, abs=2e-3)


@pytest.mark.parametrize(
    ("series", "low", "high"),
    [
        (logistic(3.55, 1000), -0.05, 0.05),
        (logistic(4.0, 1000), 0.98, 1.0),
        (np.cos(2 * np.pi * (np.sqrt(5) - 1) / 2 * np.arange(1000)), -0.05, 0.05),
    ],
    ids=["period 8", "chaos", "golden torus"],
)
def test_zero_one_test_of_known_motions(series, low, high):
    """Gottwald and Melbourne 2009: 0 for regular, 1 for chaotic motion; 0.997 for the logistic map at r = 4."""
    assert low < zero_one(series) < high


def test_zero_one_test_does_not_depend_on_scale_and_offset():
    series = logistic(4.0, 1000)
    assert zero_one(1e-6 * series) == pytest.approx(zero_one(series), abs=1e-9)
    assert zero_one(series + 10.0) == pytest.approx(zero_one(series), abs=0.02)


def test_zero_one_test_needs_a_series():
    assert np.isnan(zero_one(np.ones(1000)))
    assert np.isnan(zero_one(logistic(4.0, 50)))


def test_tonal_share():
    n = np.arange(4000)
    noise = np.random.default_rng(4).standard_normal(n.size)
    share, frequency, amplitude = tonal_share(np.cos(2 * np.pi * 0.12345 * n))
    assert share == pytest.approx(1.0, abs=1e-3)
    assert frequency == pytest.approx(0.12345, abs=1e-5)
    assert amplitude == pytest.approx(1.0, rel=0.16)
    assert tonal_share(noise)[0] == 0.0
    assert tonal_share(np.cos(2 * np.pi * 0.12345 * n) + np.sqrt(0.5) * noise)[0] == pytest.approx(0.5, abs=0.05)
    assert tonal_share(logistic(4.0, 4000))[0] == 0.0
    assert tonal_share(np.ones(4000)) == (0.0, 0.0, 0.0)


def test_a_row_has_every_column_once_and_nan_without_a_window():
    names = [column.name for column in registry.COLUMNS]
    assert len(set(names)) == len(names)
    empty = registry.evaluate(3.0, None)
    assert empty.columns == ("time", *names)
    assert empty.data[0, 0] == 3.0
    assert np.isnan(empty.data[0, 1:]).all()
    phase = 2 * np.pi * np.arange(10_000) / 100
    row = registry.evaluate(4.0, MeshWindow("III", 5120.0, phase, SINE, np.gradient(SINE), None))
    assert row.column("rms")[0] == pytest.approx(np.sqrt(2))
    assert row.column("harmonic_1")[0] == pytest.approx(2.0, rel=1e-3)
    assert row.column("subharmonic_2")[0] == pytest.approx(0.0, abs=1e-3)
