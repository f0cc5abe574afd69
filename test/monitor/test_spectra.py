"""Amplitudes of known lines, over time and over mesh order."""

import numpy as np
import pytest

from nw_gear_monitor.indicators.mesh_harmonics import line_amplitudes
from nw_gear_monitor.signals.decimate import decimate, factor, half_length
from nw_gear_monitor.signals.spectrum import ORDER_CYCLES, amplitude_spectrum, order_spectrum, orders

RATE = 5120.0


def chirp(seconds, start_hz, end_hz):
    """Time, phase and rate of phase of a linear chirp."""
    time = np.arange(int(seconds * RATE)) / RATE
    slope = (end_hz - start_hz) / seconds
    return time, 2 * np.pi * (start_hz * time + 0.5 * slope * time**2), 2 * np.pi * (start_hz + slope * time)


def test_a_sine_on_a_bin_reads_its_amplitude():
    time = np.arange(4 * 5120) / RATE
    x = 7.0 + 3e-6 * np.sin(2 * np.pi * 99.0 * time + 0.4)
    frequency, amplitude = amplitude_spectrum(x[:, None], RATE)
    assert frequency[1] == 0.25
    assert frequency[-1] == RATE / 2
    assert amplitude[396, 0] == pytest.approx(3e-6, rel=1e-3)
    assert np.delete(amplitude[:, 0], [395, 396, 397]).max() < 3e-9


def test_between_two_bins_it_reads_at_most_fifteen_percent_less():
    time = np.arange(4 * 5120) / RATE
    _, amplitude = amplitude_spectrum(np.sin(2 * np.pi * 99.125 * time)[:, None], RATE)
    assert amplitude.max() == pytest.approx(0.849, abs=0.002)  # Hann: 1.42 dB


def test_order_spectrum_of_a_chirp_stays_sharp():
    time, phase, rate = chirp(6.0, 90.0, 110.0)
    x = 2e-6 * np.cos(phase) + 5e-7 * np.cos(1.5 * phase + 1.0)
    v = -2e-6 * rate * np.sin(phase) - 7.5e-7 * rate * np.sin(1.5 * phase + 1.0)
    amplitude = order_spectrum(phase, x[:, None], v[:, None], time[1])[:, 0]
    grid = orders()
    assert grid[ORDER_CYCLES] == 1.0
    assert amplitude[ORDER_CYCLES] == pytest.approx(2e-6, rel=1e-3)
    assert amplitude[3 * ORDER_CYCLES // 2] == pytest.approx(5e-7, rel=1e-3)
    away = (np.abs(grid - 1.0) > 2 / ORDER_CYCLES) & (np.abs(grid - 1.5) > 2 / ORDER_CYCLES)
    assert amplitude[away].max() < 2e-9
    _, smeared = amplitude_spectrum(x[:, None], RATE)
    assert smeared.max() < 0.5 * 2e-6  # what the resampling is for


def test_order_spectrum_with_few_cycles_keeps_grid_and_amplitude():
    time, phase, rate = chirp(2.0, 20.0, 20.0)
    amplitude = order_spectrum(phase, np.cos(phase)[:, None], (-rate * np.sin(phase))[:, None], time[1])[:, 0]
    assert amplitude.shape == orders().shape
    assert amplitude[ORDER_CYCLES] == pytest.approx(1.0, rel=2e-3)
    assert np.isnan(order_spectrum(phase[:1000], np.zeros((1000, 1)), np.zeros((1000, 1)), time[1])).all()


def test_line_amplitudes_follow_the_phase():
    _, phase, _ = chirp(4.0, 90.0, 110.0)
    x = 1e-4 + 2e-6 * np.cos(phase + 0.3) + 4e-7 * np.cos(2 * phase) + 1e-7 * np.cos(phase / 2)
    found = line_amplitudes(phase, x, (1, 2, 3, 0.5))
    assert found == pytest.approx((2e-6, 4e-7, 0.0, 1e-7), rel=1e-3, abs=1e-11)
    assert np.isnan(line_amplitudes(phase[:300], x[:300], (0.25,))[0])


def test_decimation_keeps_lines_below_and_removes_lines_above():
    every = factor(40960.0)
    assert (every, factor(5120.0), factor(10239.0)) == (8, 1, 1)
    n = np.arange(40960)
    below, above = np.cos(2 * np.pi * 1500.0 * n / 40960), np.cos(2 * np.pi * 4000.0 * n / 40960)
    out = decimate(np.column_stack([below, above]), every)
    at = half_length(every) + every * np.arange(len(out))
    assert out[:, 0] == pytest.approx(below[at], abs=2e-3)
    assert np.abs(out[:, 1]).max() < 1e-3
