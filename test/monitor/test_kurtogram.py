"""Spectral kurtosis and kurtogram against closed forms."""

from itertools import pairwise

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.signals.kurtogram import kurtogram, most_impulsive, spectral_kurtosis

RATE = 8192.0
NOISE = np.random.default_rng(4).standard_normal(1 << 17)
TIME = np.arange(NOISE.size) / RATE


def test_stationary_noise_has_none():
    frequency, kurtosis = spectral_kurtosis(NOISE, RATE, 128)
    assert frequency[0] == 2 * 64.0
    assert frequency[-1] == 62 * 64.0
    assert np.mean(kurtosis) == pytest.approx(0.0, abs=0.03)
    assert np.max(np.abs(kurtosis)) < 0.4


def test_a_steady_tone_has_minus_one():
    frequency, kurtosis = spectral_kurtosis(np.cos(2 * np.pi * 1024 * TIME) + 1e-3 * NOISE, RATE, 128)
    assert kurtosis[frequency == 1024.0] == pytest.approx([-1.0], abs=1e-3)


def test_bursts_have_the_kurtosis_of_their_share():
    """A tone that is on for a share p of the time: <a^4>/<a^2>^2 - 2 = 1/p - 2; the ends of bursts count little."""
    p = 1 / 16
    on = np.arange(TIME.size) % 16384 < 16384 * p
    frequency, kurtosis = spectral_kurtosis(on * np.cos(2 * np.pi * 1024 * TIME) + 1e-3 * NOISE, RATE, 64)
    assert kurtosis[frequency == 1024.0] == pytest.approx([1 / p - 2], rel=0.05)


def test_modulated_noise_in_a_band_is_found_with_its_kurtosis():
    """Normal noise times (1 + cos): 2 <e^4> / <e^2>^2 - 2 with <e^2> = 3/2, <e^4> = 35/8 is 17/9."""
    spectrum = np.fft.rfft(np.random.default_rng(8).standard_normal(NOISE.size))
    frequency = np.fft.rfftfreq(NOISE.size, 1 / RATE)
    spectrum[(frequency < 1024) | (frequency > 1536)] = 0.0
    burst = (1 + np.cos(2 * np.pi * 3 * TIME)) * np.fft.irfft(spectrum)
    bands = kurtogram(burst + 0.02 * NOISE, RATE, levels=4)
    (exact,) = [band for band in bands if (band.low, band.high) == (1024.0, 1536.0)]
    assert exact.kurtosis == pytest.approx(17 / 9, rel=0.15)
    assert exact.score > 20
    best = most_impulsive(bands)
    assert best.low < 1536.0
    assert best.high > 1024.0


def test_noise_scores_chance_only():
    bands = kurtogram(NOISE, RATE)
    assert max(abs(band.score) for band in bands) < 6.0
    assert np.std([band.score for band in bands]) == pytest.approx(1.0, abs=0.25)


def test_tones_that_dont_fit_the_record_leave_no_impulse_at_its_ends():
    tones = np.cos(2 * np.pi * 501.3 * TIME + 1.0) + np.cos(2 * np.pi * 20.17 * TIME) + 3.0 * TIME
    bands = kurtogram(tones + 1e-6 * NOISE, RATE)
    quiet = [band for band in bands if band.low > 1000.0]
    assert max(band.score for band in quiet) < 6.0
    assert np.mean([band.kurtosis for band in quiet]) == pytest.approx(0.0, abs=0.03)


def test_the_bands_of_each_level_tile_the_range():
    bands = kurtogram(NOISE[:8192], RATE, levels=3)
    levels = {}
    for band in bands:
        levels.setdefault(round(RATE / 2 / (band.high - band.low)), []).append(band)
    assert sorted(levels) == [1, 2, 3, 4, 6, 8]
    for number, level in levels.items():
        assert len(level) == number
        assert level[0].low == 0.0
        assert level[-1].high == RATE / 2
        assert all(a.high == b.low for a, b in pairwise(level))


@pytest.mark.parametrize("size", [1e-150, 1e150])
def test_the_unit_doesnt_matter(size):
    small, large = NOISE[:8192], size * NOISE[:8192]
    assert [b.kurtosis for b in kurtogram(large, RATE)] == pytest.approx([b.kurtosis for b in kurtogram(small, RATE)])
    np.testing.assert_allclose(spectral_kurtosis(large, RATE, 64), spectral_kurtosis(small, RATE, 64))


def bent(at, value):
    changed = NOISE[:4096].copy()
    changed[at] = value
    return changed


@pytest.mark.parametrize(
    "x", [bent(3, np.nan), bent(3, np.inf), np.ones(4096), NOISE[:100], NOISE[:4096].reshape(2, -1)]
)
def test_bad_signals_are_refused(x):
    for call in (lambda: kurtogram(x, RATE), lambda: spectral_kurtosis(x, RATE, 64)):
        with pytest.raises(InputError) as caught:
            call()
        assert caught.value.place == "x"


def test_bad_settings_are_refused():
    for call in (
        lambda: kurtogram(NOISE, -1.0),
        lambda: kurtogram(NOISE[:4096], RATE, levels=9),
        lambda: kurtogram(NOISE, RATE, levels=0),
        lambda: spectral_kurtosis(NOISE, np.inf, 64),
        lambda: spectral_kurtosis(NOISE, RATE, 4),
        lambda: most_impulsive(()),
    ):
        with pytest.raises(InputError):
            call()
