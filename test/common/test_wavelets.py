"""Wavelet maps of signals whose frequency and amplitude over time are known."""

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_common.wavelets import wavelet_map

RATE = 2048.0


def test_a_sine_has_its_ridge_at_its_frequency_and_its_amplitude_there():
    time = np.arange(4096) / RATE
    found = wavelet_map(3e-6 * np.sin(2.0 * np.pi * 99.0 * time), RATE, low=20.0, high=500.0)
    inside = (found.time > 0.2) & (found.time < 1.8)
    ridge = found.frequency[np.argmax(found.amplitude[:, inside], axis=0)]
    step = found.frequency[1] / found.frequency[0]
    assert np.all(np.abs(np.log(ridge / 99.0)) <= 0.51 * np.log(step))
    assert found.amplitude[:, inside].max(axis=0) == pytest.approx(3e-6, rel=0.01)
    for away in (0.9063, 1.0937):  # half as large where the docstring says so
        line = np.argmin(np.abs(found.frequency - 99.0 * away))
        expected = np.exp(-(np.pi**2) * 8.0 * (99.0 / found.frequency[line] - 1.0) ** 2)
        assert found.amplitude[line, inside].mean() == pytest.approx(3e-6 * expected, rel=0.02)


def test_the_ridge_follows_a_rising_frequency():
    time = np.arange(8192) / RATE
    phase = 2.0 * np.pi * (60.0 * time + 0.5 * 30.0 * time**2)
    found = wavelet_map(np.cos(phase), RATE, low=30.0, high=400.0, lines=160)
    inside = (found.time > 0.3) & (found.time < 3.7)
    ridge = found.frequency[np.argmax(found.amplitude[:, inside], axis=0)]
    assert ridge == pytest.approx(60.0 + 30.0 * found.time[inside], rel=0.02)


def test_a_short_burst_stays_where_it_is():
    x = np.zeros(4096)
    x[2000:2100] = np.sin(2.0 * np.pi * 200.0 * np.arange(100) / RATE)
    found = wavelet_map(x, RATE, low=50.0, high=800.0, columns=256)
    assert found.amplitude.shape == (96, 256)
    column = np.argmax(found.amplitude.max(axis=0))
    assert found.time[column] == pytest.approx(2050 / RATE, abs=0.02)


@pytest.mark.parametrize(
    ("x", "low", "high"),
    [
        (np.zeros(100), 0.0, 10.0),
        (np.zeros(100), 10.0, 1025.0),
        (np.zeros(100), 20.0, 10.0),
        (np.zeros(10), 10.0, 20.0),
        (np.full(100, np.nan), 10.0, 20.0),
    ],
)
def test_what_has_no_map_is_refused(x, low, high):
    with pytest.raises(InputError):
        wavelet_map(x, RATE, low=low, high=high)
