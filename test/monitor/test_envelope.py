"""Envelope spectra and the lines of bearings in them, against closed forms and impulse trains of known rate."""

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.indicators.bearing_lines import bearing_lines
from nw_gear_monitor.indicators.bearing_orders import from_cage, from_geometry
from nw_gear_monitor.signals.envelope import OrderSpectrum, envelope, envelope_spectrum
from nw_gear_monitor.signals.kurtogram import kurtogram, most_impulsive

RATE = 20_000.0
BEARING = from_geometry(9, 7.94e-3, 39.04e-3)


def turning(seconds, spread=0.0, speed=25.0):
    """Time and phase of a shaft that speeds up by `spread` of its mean over the record."""
    t = np.arange(round(seconds * RATE)) / RATE
    return t, 2 * np.pi * speed * t * (1 - spread / 2 + spread / 2 * t / seconds)


def knocking(t, phase, order, slip=0.0):
    """Decaying oscillations at 4 kHz, one whenever order * phase passes a whole turn; slip scatters their moments."""
    rng = np.random.default_rng(11)
    knocks = np.arange(1, int(order * phase[-1] / (2 * np.pi))) + slip * rng.standard_normal(
        int(order * phase[-1] / (2 * np.pi)) - 1
    )
    moments = np.interp(2 * np.pi * knocks / order, phase, t)
    train = np.zeros(t.size)
    train[np.minimum(np.rint(moments * RATE).astype(int), t.size - 1)] = 1.0
    ringing = np.arange(200) / RATE
    return np.convolve(train, np.exp(-800 * ringing) * np.sin(2 * np.pi * 4000 * ringing))[: t.size]


@pytest.mark.parametrize("spread", [0.0, 0.2])
def test_the_envelope_of_a_modulated_carrier(spread):
    """A (1 + m cos 3.2 theta) times a carrier reads m A at order 3.2, whatever the speed does."""
    t, phase = turning(4.0, spread)
    x = 2.0 * (1 + 0.4 * np.cos(3.2 * phase)) * np.cos(2 * np.pi * 4000 * t) + 5.0 * np.cos(23 * phase)
    spectrum = envelope_spectrum(x, RATE, phase, (3000.0, 5000.0))
    at = int(np.argmax(spectrum.amplitude))
    assert spectrum.order[at] == pytest.approx(3.2, abs=0.6 / spectrum.turns)
    assert 0.84 * 0.8 < spectrum.amplitude[at] <= 0.8 * 1.001  # Hann reads up to 15 % less between two bins
    far = np.abs(spectrum.order - 3.2) > 10 / spectrum.turns
    assert spectrum.amplitude[far].max() < 2e-3


@pytest.mark.parametrize("band", [(0.0, 10_000.0), (0.0, 2000.0), (500.0, 10_000.0), (900.0, 1100.0)])
def test_the_envelope_of_a_tone_is_its_amplitude(band):
    x = 3.0 * np.cos(2 * np.pi * 1000 * np.arange(20_000) / RATE + 0.3)
    inner = envelope(x, RATE, band)[1000:-1000]
    assert inner == pytest.approx(np.full(inner.size, 3.0), rel=0.01)


def test_at_the_limits_of_the_band_half_is_left():
    x = 3.0 * np.cos(2 * np.pi * 1000 * np.arange(20_000) / RATE)
    for band in ((1000.0, 3000.0), (400.0, 1000.0), (1000.0, 10_000.0), (0.0, 1000.0)):
        assert np.median(envelope(x, RATE, band)[2000:-2000]) == pytest.approx(1.5, rel=0.01)


@pytest.mark.parametrize(("part", "spread"), [("outer", 0.0), ("inner", 0.1), ("roller", 0.05)])
def test_knocks_in_noise_are_found_at_their_order(part, spread):
    """The knocks are drowned: their rms is a third of the noise's; band from the kurtogram of a louder record."""
    t, phase = turning(8.0, spread)
    knocks = knocking(t, phase, BEARING.lines()[part], slip=0.01)
    noise = np.random.default_rng(5).standard_normal(t.size)
    x = knocks / np.std(knocks) + 3.0 * noise + 4.0 * np.cos(31 * phase)
    lines = bearing_lines(envelope_spectrum(x, RATE, phase, (3000.0, 5000.0)), BEARING)
    first = {line.part: line for line in lines if line.harmonic == 1}
    assert first[part].order == pytest.approx(BEARING.lines()[part], rel=3e-3)
    assert first[part].prominence > 6.0
    others = [line.prominence for name, line in first.items() if name != part]
    assert max(others) < 4.5


def test_noise_shows_no_bearing_line():
    """The largest of n Rayleigh values has about 1.2 sqrt(ln n) times their median."""
    t, phase = turning(8.0)
    worst = 0.0
    for seed in range(8):
        x = np.random.default_rng(seed).standard_normal(t.size)
        lines = bearing_lines(envelope_spectrum(x, RATE, phase, (3000.0, 5000.0)), BEARING)
        assert len(lines) == 12
        worst = max(worst, *(line.prominence for line in lines))
    assert worst < 5.0


def test_the_kurtogram_chooses_the_band_that_shows_the_knocks():
    t, phase = turning(8.0, 0.05)
    knocks = knocking(t, phase, BEARING.outer, slip=0.01)
    x = knocks / np.std(knocks) + 1.5 * np.random.default_rng(6).standard_normal(t.size)
    band = most_impulsive(kurtogram(x, RATE, levels=4))
    assert band.low < 4000.0 < band.high
    lines = bearing_lines(envelope_spectrum(x, RATE, phase, (band.low, band.high)), BEARING)
    strongest = max(lines, key=lambda line: line.prominence)
    assert strongest.part == "outer"
    assert strongest.prominence > 6.0


def test_a_line_beyond_the_spectrum_is_left_out():
    spectrum = OrderSpectrum(np.arange(400) / 40, 1.0 + 0.1 * np.sin(np.arange(400.0)), 40)
    assert [(line.part, line.harmonic) for line in bearing_lines(spectrum, from_cage(12, 0.4))] == [
        ("outer", 1),
        ("inner", 1),
        ("cage", 1),
        ("cage", 2),
        ("cage", 3),
    ]


def test_prominence_is_over_the_noise_around():
    amplitude = np.full(4000, 9.0)
    amplitude[960 - 60 : 960 + 60] = 2.0  # order 24 stands at bin 960
    amplitude[965] = 40.0
    lines = bearing_lines(
        OrderSpectrum(np.arange(4000) / 40, amplitude, 40), from_cage(60, 0.4), harmonics=1, slip=0.01
    )
    (outer,) = [line for line in lines if line.part == "outer"]
    assert (outer.expected, outer.order, outer.amplitude) == (24.0, 965 / 40, 40.0)
    assert outer.prominence == pytest.approx(20.0)


T, PHASE = turning(1.0)
GOOD = np.random.default_rng(0).standard_normal(T.size)


def bent(values, at, value):
    changed = values.copy()
    changed[at] = value
    return changed


@pytest.mark.parametrize(
    ("x", "rate", "phase", "band", "place"),
    [
        (bent(GOOD, 5, np.nan), RATE, PHASE, (3000.0, 5000.0), "x"),
        (bent(GOOD, 5, -np.inf), RATE, PHASE, (3000.0, 5000.0), "x"),
        (np.full(T.size, 2.0), RATE, PHASE, (3000.0, 5000.0), "x"),
        (GOOD[:100], RATE, PHASE[:100], (3000.0, 3010.0), "x"),
        (GOOD, np.nan, PHASE, (3000.0, 5000.0), "rate"),
        (GOOD, 0.0, PHASE, (3000.0, 5000.0), "rate"),
        (GOOD, RATE, PHASE, (5000.0, 3000.0), "band"),
        (GOOD, RATE, PHASE, (3000.0, 11_000.0), "band"),
        (GOOD, RATE, PHASE, (np.nan, 5000.0), "band"),
        (GOOD, RATE, PHASE[::-1], (3000.0, 5000.0), "phase"),
        (GOOD, RATE, PHASE[:-1], (3000.0, 5000.0), "phase"),
        (GOOD, RATE, PHASE / 20, (3000.0, 5000.0), "phase"),
    ],
)
def test_bad_input_is_refused(x, rate, phase, band, place):
    with pytest.raises(InputError) as caught:
        envelope_spectrum(x, rate, phase, band)
    assert caught.value.place == place


def test_bad_spectra_and_settings_are_refused():
    good = OrderSpectrum(np.arange(400) / 40, 1.0 + 0.1 * np.sin(np.arange(400.0)), 40)
    for spectrum in (
        OrderSpectrum(good.order, bent(good.amplitude, 7, np.nan), 40),
        OrderSpectrum(good.order, np.zeros(400), 40),
        OrderSpectrum(good.order, bent(np.zeros(400), 300, 1.0), 40),
        OrderSpectrum(good.order, good.amplitude, 4),
    ):
        with pytest.raises(InputError, match="spectrum"):
            bearing_lines(spectrum, from_cage(12, 0.4))
    for keywords in ({"slip": np.nan}, {"slip": 0.5}, {"harmonics": 0}):
        with pytest.raises(InputError):
            bearing_lines(good, from_cage(12, 0.4), **keywords)
