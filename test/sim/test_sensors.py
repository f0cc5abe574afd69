"""Accelerometers on the housings: path, sensor, filter, converter, against closed forms."""

import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import welch

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_sim import config
from nw_gear_sim.drives import WindDriven
from nw_gear_sim.nodes.session import Session
from nw_gear_sim.params import Housing
from nw_gear_sim.sensors import kernels
from nw_gear_sim.sensors.accelerometer import ATTENUATION, PASS, STOP, Accelerometers, Sensor
from nw_gear_sim.sensors.path import housings_of, make_path, transfer

HOUSING = Housing(mass=400.0, frequency=900.0, damping_ratio=0.03)
OTHER = Housing(mass=1500.0, frequency=500.0, damping_ratio=0.04)
FORCE_RATE = 20480.0
QUIET = Sensor(rate=5120.0, range=1e6, noise=0.0, sensitivity=0.01, voltage=1e6, bits=0)


def sensor(**changes: object) -> Sensor:
    return Sensor(**{**vars(QUIET), **changes})  # type: ignore[arg-type]


def whole(accelerometers: Accelerometers, force: np.ndarray, cuts: list[int]) -> np.ndarray:
    parts, given_so_far = [], 0
    for piece in np.split(force, cuts):
        if len(piece):
            first, samples = accelerometers.advance(piece)
            assert first == given_so_far
            given_so_far += len(samples)
            parts.append(samples)
    return np.concatenate(parts)


def shaken(housing: Housing, force: np.ndarray, before: float, rate: float = FORCE_RATE) -> np.ndarray:
    out, rest = np.empty((len(force), 1)), np.zeros((1, 2))
    kernels.shake(make_path([housing], 1.0 / rate), force[:, None].copy(), np.array([before]), rest, 1, out)
    return np.asarray(out[:, 0])


@pytest.mark.parametrize("housing", [HOUSING, OTHER, Housing(10.0, 4000.0, 0.0), Housing(10.0, 20.0, 0.7)])
def test_a_step_of_the_force_gives_the_closed_form(housing: Housing) -> None:
    """a = F/m exp(-zeta w t) (cos w_d t - zeta w / w_d sin w_d t), from rest without force."""
    time = np.arange(1, 2001) / FORCE_RATE
    w, z = 2 * math.pi * housing.frequency, housing.damping_ratio
    w_d = w * math.sqrt(1 - z * z)
    exact = 1e4 / housing.mass * np.exp(-z * w * time) * (np.cos(w_d * time) - z * w / w_d * np.sin(w_d * time))
    found = shaken(housing, np.full(2000, 1e4), 1e4)
    assert found == pytest.approx(exact, abs=1e-9 * 1e4 / housing.mass)


def test_a_ramp_of_the_force_is_exact_whatever_the_rate() -> None:
    """a = s / (m w_d) exp(-zeta w t) sin w_d t for F = s t: the integral of the step's answer; dense or coarse."""
    w, z, slope = 2 * math.pi * HOUSING.frequency, HOUSING.damping_ratio, 1e6
    w_d = w * math.sqrt(1 - z * z)
    for rate in (1024.0, 5120.0, 81920.0):
        time = np.arange(1, 200) / rate
        found = shaken(HOUSING, slope * time, 0.0, rate)
        exact = slope / (HOUSING.mass * w_d) * np.exp(-z * w * time) * np.sin(w_d * time)
        assert found == pytest.approx(exact, abs=1e-9 * slope / (HOUSING.mass * w_d))


def test_a_constant_load_shakes_nothing() -> None:
    accelerometers = Accelerometers([HOUSING, OTHER], QUIET, FORCE_RATE, 1)
    _first, samples = accelerometers.advance(np.tile([8e5, -3e5], (4096, 1)))
    assert len(samples) > 900
    assert np.abs(samples).max() < 1e-9


@pytest.mark.parametrize("frequency", [26.0, 324.0, 900.0, 1500.0])
def test_a_sine_comes_out_as_the_transfer_function_says_in_time(frequency: float) -> None:
    """Straight lines between samples: sinc^2 of the sine and of its images; the filter's delay isn't in the stamps."""
    accelerometers = Accelerometers([HOUSING], QUIET, FORCE_RATE, 1)
    time = np.arange(int(0.8 * FORCE_RATE)) / FORCE_RATE
    out = accelerometers.advance(np.sin(2 * math.pi * frequency * time)[:, None] * 1e5)[1][:, 0]
    stamps = np.arange(len(out)) / QUIET.rate
    late = stamps > 0.4
    basis = np.exp(2j * math.pi * frequency * stamps[late])
    fit, *_ = np.linalg.lstsq(np.stack([basis.real, basis.imag], axis=1), out[late], rcond=None)
    seen = frequency + FORCE_RATE * np.arange(-3000, 3001)
    w, s = 2 * math.pi * HOUSING.frequency, 2j * math.pi * seen
    answer = 1e5 * s * s / (HOUSING.mass * (s * s + 2 * HOUSING.damping_ratio * w * s + w * w))
    exact = np.sum(answer * np.sinc(seen / FORCE_RATE) ** 2)
    found = fit[1] + 1j * fit[0]  # of a sine: Im(A exp(i w t)) = Re A sin + Im A cos
    assert abs(found - exact) < 2e-4 * abs(exact)
    alone = 1e5 * transfer(HOUSING, np.array([frequency]))[0]
    assert abs(answer[3000]) == pytest.approx(alone, rel=1e-12)
    assert abs(found) == pytest.approx(alone, rel=0.01)


def test_at_resonance_the_answer_is_one_over_two_zeta_m() -> None:
    assert transfer(HOUSING, np.array([900.0]))[0] == pytest.approx(1 / (2 * 0.03 * 400.0), rel=1e-12)
    assert transfer(HOUSING, np.array([9e6]))[0] == pytest.approx(1 / 400.0, rel=1e-6)


@pytest.mark.parametrize("rate", [2560.0, 5120.0, 10240.0])
def test_what_would_fold_is_kept_out_and_what_is_below_passes(rate: float) -> None:
    taps = Accelerometers([HOUSING], sensor(rate=rate), FORCE_RATE, 1)._taps
    response = np.abs(np.fft.rfft(taps, 1 << 16))
    frequency = np.arange(response.size) / (1 << 16) * FORCE_RATE
    assert response[frequency <= PASS * rate] == pytest.approx(1.0, abs=1.1 * 10 ** (-ATTENUATION / 20))
    assert response[frequency >= STOP * rate].max() < 1.1 * 10 ** (-ATTENUATION / 20)


@pytest.mark.parametrize("rate", [2560.0, 5120.0, 20480.0, 40960.0])
def test_the_noise_has_the_density_that_was_asked_for(rate: float) -> None:
    density = 3e-3
    accelerometers = Accelerometers([HOUSING] * 6, sensor(rate=rate, noise=density), FORCE_RATE, 5)
    samples = accelerometers.advance(np.zeros((int(6 * FORCE_RATE), 6)))[1]
    frequency, power = welch(samples, fs=rate, nperseg=512, axis=0)
    inside = (frequency > 0.02 * rate) & (frequency < PASS * rate)
    assert np.sqrt(power[inside].mean()) == pytest.approx(density, rel=0.01)
    assert np.sqrt(power[inside].mean(axis=1)) == pytest.approx(density, rel=0.12)
    assert np.abs(np.corrcoef(samples.T) - np.eye(6)).max() < 5 / math.sqrt(len(samples))


def test_the_seed_decides_the_noise() -> None:
    def draw(seed: int) -> np.ndarray:
        return Accelerometers([HOUSING], sensor(noise=1e-3), FORCE_RATE, seed).advance(np.zeros((2000, 1)))[1]

    assert np.array_equal(draw(7), draw(7))
    assert not np.array_equal(draw(7), draw(8))
    again = Accelerometers([HOUSING], sensor(noise=1e-3), FORCE_RATE, 7)
    again.advance(np.ones((777, 1)))
    again.forget()
    assert np.array_equal(again.advance(np.zeros((2000, 1)))[1], draw(7))


def test_beyond_the_range_it_clips_and_counts() -> None:
    """A sine of twice the range is beyond it for 2/3 of the time (|sin| > 1/2); what comes out stays inside."""
    time = np.arange(int(FORCE_RATE)) / FORCE_RATE
    force = np.sin(2 * math.pi * 50.0 * time)[:, None] * [1.0, 0.01]
    peak = float(transfer(HOUSING, np.array([50.0]))[0])
    accelerometers = Accelerometers([HOUSING, HOUSING], sensor(range=0.5 * peak), FORCE_RATE, 1)
    samples = accelerometers.advance(force)[1]
    assert np.abs(samples).max() <= 0.5 * peak
    assert accelerometers.clipped[0] / len(force) == pytest.approx(2 / 3, abs=0.01)
    assert accelerometers.clipped[1] == 0


def test_a_sensitive_sensor_meets_the_end_of_the_converter() -> None:
    assert sensor(range=490.0, sensitivity=0.0102, voltage=5.0).limit == pytest.approx(490.0)
    assert sensor(range=490.0, sensitivity=0.102, voltage=5.0).limit == pytest.approx(49.02, rel=1e-3)
    accelerometers = Accelerometers([HOUSING], sensor(sensitivity=1.0, voltage=2.0), FORCE_RATE, 1)
    samples = accelerometers.advance(np.sin(np.arange(4000) * 0.3)[:, None] * 1e5)[1]
    assert np.abs(samples).max() == 2.0


def test_the_converter_rounds_to_its_steps() -> None:
    force = np.sin(np.arange(4000) * 0.3)[:, None] * 1e4
    exact = Accelerometers([HOUSING], sensor(sensitivity=0.1, voltage=5.0), FORCE_RATE, 1).advance(force)[1]
    rough = Accelerometers([HOUSING], sensor(sensitivity=0.1, voltage=5.0, bits=12), FORCE_RATE, 1).advance(force)[1]
    step = 10.0 / 0.1 / 4096
    assert np.array_equal(rough, np.rint(exact / step) * step)
    assert 0.3 * step < np.abs(rough - exact).max() <= 0.5 * step * (1 + 1e-9)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.integers(1, 1499), max_size=12), st.sampled_from([1280.0, 5120.0, 20480.0, 40960.0]))
def test_the_samples_dont_depend_on_how_the_forces_are_cut(cuts: list[int], rate: float) -> None:
    force = np.random.default_rng(3).normal(8e5, 1e4, (1500, 2))
    kind = sensor(rate=rate, noise=1e-3, range=30.0, bits=16, voltage=5.0)
    at_once = Accelerometers([HOUSING, OTHER], kind, FORCE_RATE, 2)
    in_parts = Accelerometers([HOUSING, OTHER], kind, FORCE_RATE, 2)
    assert np.array_equal(whole(at_once, force, []), whole(in_parts, force, sorted(cuts)))
    assert np.array_equal(at_once.clipped, in_parts.clipped)


@pytest.mark.parametrize("rate", [5120.0, 40960.0])
def test_a_checkpoint_goes_on_bit_for_bit(rate: float) -> None:
    force = np.random.default_rng(3).normal(8e5, 1e4, (1500, 2))
    kind = sensor(rate=rate, noise=1e-3, range=20.0)
    first = Accelerometers([HOUSING, OTHER], kind, FORCE_RATE, 2)
    first.advance(force[:707])
    saved = first.state()
    numbers = json.loads(json.dumps({k: v for k, v in saved.items() if not isinstance(v, np.ndarray)}))
    second = Accelerometers([HOUSING, OTHER], kind, FORCE_RATE, 99)
    second.restore({**saved, **numbers})
    expected, found = first.advance(force[707:]), second.advance(force[707:])
    assert expected[0] == found[0] > 0
    assert np.array_equal(expected[1], found[1])
    assert np.array_equal(first.clipped, second.clipped)


def test_the_state_of_other_sensors_is_refused() -> None:
    saved = Accelerometers([HOUSING], QUIET, FORCE_RATE, 2).state()
    with pytest.raises(InputError, match="channels"):
        Accelerometers([HOUSING, OTHER], QUIET, FORCE_RATE, 2).restore(saved)
    with pytest.raises(InputError, match="rate: expected 2560 Hz, got 5120"):
        Accelerometers([HOUSING], sensor(rate=2560.0), FORCE_RATE, 2).restore(saved)
    for name in saved:
        with pytest.raises(InputError, match="checkpoint"):
            Accelerometers([HOUSING], QUIET, FORCE_RATE, 2).restore({k: v for k, v in saved.items() if k != name})


@pytest.mark.parametrize("rate", [5000.0, 12800.0, 30720.0])
def test_a_rate_that_does_not_fit_is_refused(rate: float) -> None:
    with pytest.raises(InputError, match="acceleration_rate: expected 20480 Hz times or over a whole number"):
        Accelerometers([HOUSING], sensor(rate=rate), FORCE_RATE, 1)


def test_faster_sensors_agree_with_slower_ones_where_both_see() -> None:
    """What is slow comes out the same at every rate: sines of 26 and 400 Hz at common times."""
    time = np.arange(int(0.5 * FORCE_RATE)) / FORCE_RATE
    force = 1e5 * (np.sin(2 * math.pi * 26 * time) + 0.1 * np.sin(2 * math.pi * 400 * time))[:, None]
    found = {
        rate: Accelerometers([HOUSING], sensor(rate=rate), FORCE_RATE, 1).advance(force)[1]
        for rate in (5120.0, 20480.0, 40960.0)
    }
    slow = found[5120.0][:, 0]
    middle = slice(len(slow) // 2, None)
    for rate in (20480.0, 40960.0):
        every = int(rate / 5120.0)
        assert found[rate][::every, 0][: len(slow)][middle] == pytest.approx(slow[middle], abs=2e-4 * np.ptp(slow))


def test_each_kind_of_bearing_has_its_housing() -> None:
    base = config.load()
    found = housings_of(base, ("pb2_3", "b21"))
    assert found == [base.housing.pb2, base.housing.pb2, base.housing.b21, base.housing.b21]
    assert names.acceleration_columns(("pb2_3", "b21")) == ("time", "ax_pb2_3", "ay_pb2_3", "ax_b21", "ay_b21")


def test_the_waveform_is_the_same_bit_for_bit_with_a_sample_of_every_step() -> None:
    def run(every_step: bool) -> list[np.ndarray]:
        session = Session(BASE, WindDriven(BASE), "kinematic", "equilibrium", 5120.0, every_step=every_step)
        session.begin({"wind": 11.0})
        out = []
        for _ in range(12):
            block = session.advance({"wind": 11.0 + math.sin(40.0 * session.time)})
            assert session.fine is not None
            assert len(session.fine.time) == len(block.time) * (4 if every_step else 1)
            out += [block.time, block.phase, block.x, block.v, block.force, block.bearing_force, block.shaft_torque]
        return out

    for plain, fine in zip(run(False), run(True), strict=True):
        assert np.array_equal(plain, fine)


BASE = config.load()
