"""The classifier of signals of unknown origin: states that are known by other means, and what must never be chaos."""

import sys
from pathlib import Path

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_monitor.states import noise
from nw_gear_monitor.states.classifier import classify
from test.monitor.chaotic import lorenz, roessler
from test.monitor.gear_signal import logistic

BENCHMARK = Path(__file__).parents[2] / "benchmark"
STROBES = 600
PER_CYCLE = 21.37
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0
CYCLES = np.arange(int(STROBES * PER_CYCLE)) / PER_CYCLE
PHASE = 2.0 * np.pi * CYCLES
SINE = np.sin(PHASE) + 0.2 * np.sin(3.0 * PHASE + 0.7)


def white(size=PHASE.size, seed=5):
    return np.random.default_rng(seed).standard_normal(size)


def noisy(x, decibels, seed=5):
    return x + np.std(x) * 10.0 ** (-decibels / 20.0) * white(x.size, seed)


def coloured(memory, size, seed=7):
    steps, out = white(size, seed), np.zeros(size)
    for k in range(1, size):
        out[k] = memory * out[k - 1] + steps[k]
    return out / out.std()


def pink(size, seed=9):
    frequency = np.fft.rfftfreq(size)
    frequency[0] = 1.0
    out = np.fft.irfft(np.fft.rfft(white(size, seed)) / np.sqrt(frequency), size)
    return out / out.std()


# --- known states ---


@pytest.mark.parametrize("decibels", [np.inf, 40.0, 20.0])
@pytest.mark.parametrize(
    ("r", "label"),
    [(3.2, "period-2"), (3.5, "period-4"), (3.55, "period-8"), (3.83, "period-3"), (3.9, "chaotic"), (4.0, "chaotic")],
)
def test_logistic_map(r, label, decibels):
    """Period doublings at 3, 3.4495, 3.5441; the window of period 3 from 3.8284 to 3.8415; ln 2 at 4."""
    verdict = classify(noisy(logistic(r, STROBES), decibels))
    assert verdict.label == label
    assert verdict.period == (names.PERIODS.index(label) + 1 if label in names.PERIODS else None)


@pytest.mark.parametrize("decibels", [np.inf, 40.0, 20.0])
def test_torus(decibels):
    """Two lines with the golden ratio between them, as points and as a strobed signal."""
    angle = 2.0 * np.pi * GOLDEN * np.arange(STROBES)
    assert classify(noisy(np.cos(angle) + 0.3 * np.cos(2.0 * angle), decibels)).label == names.QUASI_PERIODIC
    assert classify(noisy(SINE + 0.5 * np.sin(GOLDEN * PHASE), decibels), strobe=PHASE).label == names.QUASI_PERIODIC


@pytest.mark.parametrize("per_cycle", [20.0, 23.7, 24.5, 25.6, 8.0 * np.pi])
@pytest.mark.parametrize("period", [1, 2, 3, 5])
def test_weak_subharmonic_at_any_sample_rate(period, per_cycle):
    """A tenth of the amplitude at f/n, 40 dB, also where samples fall on the same places every few cycles."""
    phase = 2.0 * np.pi * np.arange(int(300 * per_cycle)) / per_cycle
    x = np.sin(phase) + (0.1 * np.cos(phase / period + 0.4) if period > 1 else 0.0)
    assert classify(noisy(x, 40.0), strobe=phase).period == period


def test_noise_level_is_found():
    """Of a periodic and a quasi-periodic flow, with nothing given; a steep waveform hides noise below 57 dB here."""
    for decibels, off in ((60.0, 3.0), (40.0, 0.5), (20.0, 0.5)):
        assert classify(noisy(SINE, decibels), strobe=PHASE).noise_db == pytest.approx(decibels, abs=off)
        torus = noisy(SINE + 0.5 * np.sin(GOLDEN * PHASE), decibels)
        assert classify(torus, strobe=PHASE).noise_db == pytest.approx(decibels, abs=3.0)
    assert noise.floor(white(20000)) == pytest.approx(1.0, rel=0.15)
    assert noise.scatter(noisy(SINE, 30.0), PHASE, 1) == pytest.approx(np.std(SINE) * 10**-1.5, rel=0.05)


def test_speed_that_changes_by_five_percent_keeps_its_label_without_a_strobe():
    phase = PHASE * (1.0 + 0.025 * CYCLES / CYCLES[-1])
    for x in (np.sin(phase), np.sin(phase) + 0.3 * np.sin(2.0 * phase)):
        assert classify(noisy(x, 40.0), rate=1000.0).label == "period-1"


@pytest.mark.parametrize("drift", [0.02, 0.1, 0.3])
def test_amplitude_that_changes_slowly_keeps_its_label(drift):
    verdict = classify(noisy((1.0 + drift * CYCLES / CYCLES[-1]) * SINE, 40.0), strobe=PHASE)
    assert verdict.label == "period-1"


def test_a_state_that_changes_within_the_window_is_transient():
    doubled = noisy(np.sin(PHASE) + np.where(CYCLES > STROBES / 2, 0.4, 0.0) * np.sin(PHASE / 2.0 + 0.3), 40.0)
    assert classify(doubled, strobe=PHASE).label == names.TRANSIENT


def test_flows_without_a_strobe_are_cut_at_their_maxima():
    assert classify(lorenz(20000)[:, 2], rate=100.0).label == names.CHAOTIC
    assert classify(roessler(24000)[:, 0], rate=20.0).label == names.CHAOTIC


# --- never chaos ---

NOT_CHAOS = {
    "white points": (lambda: white(STROBES), None),
    "coloured points": (lambda: coloured(0.9, STROBES), None),
    "coloured points, squared": (lambda: coloured(0.9, STROBES) ** 2, None),
    "exponential of coloured points": (lambda: np.exp(0.5 * coloured(0.8, STROBES)), None),
    "random walk": (lambda: np.cumsum(white(STROBES)), None),
    "1/f points": (lambda: pink(STROBES), None),
    "oversampled sine": (lambda: noisy(np.sin(0.02 * np.arange(2000)), 40.0), None),
    "quantised torus": (lambda: np.round(8.0 * np.sin(2.0 * np.pi * GOLDEN * np.arange(STROBES))) / 8.0, None),
    "white samples": (white, PHASE),
    "noise about a constant": (lambda: 5.0 + 1e-3 * white(), PHASE),
    "1/f samples": (lambda: pink(PHASE.size), PHASE),
    "sine and 1/f": (lambda: SINE + 0.2 * pink(PHASE.size), PHASE),
    "sine and coloured noise": (lambda: SINE + 0.1 * coloured(0.99, PHASE.size), PHASE),
    "drifting sine": (lambda: noisy((1.0 + CYCLES / CYCLES[-1]) * SINE, 30.0), PHASE),
    "growing sine": (lambda: np.exp(3.0 * CYCLES / CYCLES[-1]) * SINE, PHASE),
    "amplitude modulated": (lambda: noisy((1.0 + 0.5 * np.sin(0.0371 * PHASE)) * SINE, 40.0), PHASE),
    "frequency modulated": (lambda: noisy(np.sin(PHASE + 0.5 * np.sin(0.0371 * PHASE)), 40.0), PHASE),
    "square": (lambda: np.sign(np.sin(PHASE + 0.1)), PHASE),
    "noisy square": (lambda: noisy(np.sign(np.sin(PHASE + 0.1)), 40.0), PHASE),
    "pulses": (lambda: noisy(np.where(np.mod(CYCLES, 1.0) < 0.06, 1.0, 0.0), 40.0), PHASE),
    "quantised": (lambda: np.round(32.0 * SINE) / 32.0, PHASE),
    "outliers": (lambda: noisy(SINE, 40.0) + 5.0 * (np.random.default_rng(3).random(SINE.size) < 1e-3), PHASE),
    "step": (lambda: np.where(CYCLES > STROBES / 2, 1.0, 0.0) + 0.01 * white(), PHASE),
}


@pytest.mark.parametrize("name", NOT_CHAOS)
def test_never_chaotic(name):
    made, phase = NOT_CHAOS[name]
    x = made()
    assert classify(x, strobe=phase).label != names.CHAOTIC
    if phase is not None:
        assert classify(x, rate=1000.0).label != names.CHAOTIC


def test_nothing_to_label():
    assert classify(np.ones(1000)).label == names.UNKNOWN
    assert classify(np.ones(1000), rate=100.0).label == names.UNKNOWN
    assert classify(logistic(4.0, 127)).label == names.UNKNOWN
    assert classify(SINE[:2000], strobe=PHASE[:2000]).label == names.UNKNOWN
    assert classify(white(STROBES)).label == names.UNKNOWN


def test_unit_and_offset_do_not_matter():
    x = noisy(SINE + 0.2 * np.sin(PHASE / 2.0 + 0.3), 30.0)
    one, other = classify(x, strobe=PHASE), classify(1e-6 * x + 3e-4, strobe=PHASE)
    assert (one.label, one.period) == (other.label, other.period) == ("period-2", 2)
    assert other.noise_db == pytest.approx(one.noise_db, abs=1e-3)


def test_bad_input_is_refused():
    x = logistic(4.0, 300)
    for given, expected in (
        ({"x": np.where(x > 0.99, np.nan, x)}, "finite"),
        ({"x": x, "v": x[:-1]}, "one value for each"),
        ({"x": x, "strobe": np.zeros(300)}, "always grows"),
        ({"x": x, "rate": -1.0}, "above zero"),
        ({"x": x, "strobe": 6.0 * np.arange(300.0)}, "samples to a cycle"),
    ):
        with pytest.raises(InputError, match=expected):
            classify(**given)


# --- the benchmark ---


@pytest.fixture(scope="module")
def cases():
    """The benchmark's own package of cases."""
    sys.path.insert(0, str(BENCHMARK))
    from states import cases

    yield cases
    sys.path.remove(str(BENCHMARK))


def test_cases_of_the_benchmark(cases):
    """Every 60th held-out case at 40 dB, exactly."""
    chosen = cases.read("held-out")[3::60]
    assert len(chosen) >= 10
    seen = [cases.signal(case, 40.0) for case in chosen]
    found = [classify(s.x, strobe=s.phase, v=s.v).label for s in seen]
    assert found == [case.label for case in chosen]


@pytest.mark.slow
@pytest.mark.parametrize(("decibels", "least"), [(40.0, 0.98), (30.0, 0.97), (20.0, 0.94)])
def test_rates_of_the_benchmark(cases, decibels, least):
    """About 100 held-out cases, of every family and state."""
    chosen = cases.read("held-out")[::7]
    seen = [cases.signal(case, decibels) for case in chosen]
    right = [classify(s.x, strobe=s.phase, v=s.v).label == c.label for s, c in zip(seen, chosen, strict=True)]
    assert np.mean(right) >= least
