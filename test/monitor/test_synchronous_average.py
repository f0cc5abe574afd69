"""Resampling over phase, the synchronous average and its parts, against closed forms."""

import numpy as np
import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.signals.average import mesh_amplitudes, separate, synchronous_average
from nw_gear_monitor.signals.resample import whole_turns

TURN = 2 * np.pi
TEETH = 23


def chirped(turns=40.0, samples=20_000, spread=0.3):
    """Phase of a shaft whose speed rises by `spread` of its mean while it is sampled at equal steps of time."""
    t = np.linspace(0.0, 1.0, samples)
    return TURN * turns * ((1 - spread / 2) * t + spread / 2 * t * t)


@pytest.mark.parametrize("degree", [1, 3, 5])
def test_the_error_of_the_spline_falls_with_its_order(degree):
    def error(per_cycle):
        phase = TURN * (np.arange(100 * per_cycle) / per_cycle + 0.37 / per_cycle)
        turns = whole_turns(phase, np.sin(phase + 0.4), per_turn=64, degree=degree)
        truth = np.sin(TURN * np.arange(64) / 64 + 0.4)
        return np.max(np.abs(turns.values[10:-10] - truth))

    assert np.log2(error(12) / error(24)) == pytest.approx(degree + 1, abs=0.5)
    assert error(10) < {1: 5e-2, 3: 5e-4, 5: 5e-6}[degree]
    assert error(5) < {1: 0.2, 3: 1e-2, 5: 6e-4}[degree]


def test_turns_begin_at_whole_multiples_of_the_phase():
    phase = TURN * (3.4 + np.arange(5001) / 500)
    turns = whole_turns(phase, np.cos(phase), per_turn=8)
    assert (turns.first, turns.turns) == (4, 9)
    np.testing.assert_allclose(turns.values, np.tile(np.cos(TURN * np.arange(8) / 8), (9, 1)), atol=1e-9)


def test_a_whole_turn_in_samples_is_a_whole_turn():
    phase = TURN * np.arange(640) / 64
    assert whole_turns(phase, np.cos(phase), per_turn=64).turns == 10


def test_orders_stay_orders_while_the_speed_rises():
    phase = chirped()
    x = 3.0 * np.cos(TEETH * phase + 0.2) + 0.5 * np.cos((TEETH + 2) * phase) + 0.1 * np.cos(2 * TEETH * phase)
    average = synchronous_average(phase, x)
    amplitude = 2 * np.abs(np.fft.rfft(average.values)) / average.values.size
    assert amplitude[[TEETH, TEETH + 2, 2 * TEETH]] == pytest.approx([3.0, 0.5, 0.1], rel=1e-4)
    assert np.delete(amplitude, [TEETH, TEETH + 2, 2 * TEETH]).max() < 1e-4
    over_time = 2 * np.abs(np.fft.rfft(x)) / x.size
    assert over_time.max() < 1.5  # without the phase the line is smeared


@pytest.mark.parametrize("turns", [16, 64, 256])
def test_noise_falls_with_the_root_of_the_turns(turns):
    rng = np.random.default_rng(turns)
    phase = TURN * np.arange(turns * 128) / 128
    wave = np.cos(5 * phase)
    average = synchronous_average(phase, wave + rng.standard_normal(phase.size), per_turn=128)
    assert average.turns == turns
    noise = average.values - np.cos(5 * TURN * np.arange(128) / 128)
    assert np.std(noise) * np.sqrt(turns) == pytest.approx(1.0, abs=0.2)


def test_a_foreign_line_is_combed_out_by_the_known_factor():
    phase = TURN * np.arange(10 * 256) / 256
    order = 7.23
    average = synchronous_average(phase, np.cos(order * phase), per_turn=256)
    factor = abs(np.sin(np.pi * 10 * order) / (10 * np.sin(np.pi * order)))
    assert np.sqrt(2) * np.sqrt(np.mean(average.values**2)) == pytest.approx(factor, rel=0.05)


def test_the_average_comes_apart_by_orders():
    theta = TURN * np.arange(512) / 512
    lines = {1: 2.0, 2: 1.0, 5: 0.3, TEETH: 4.0, TEETH + 1: 0.7, TEETH - 2: 0.2, 3 * TEETH - 1: 0.1}
    one = {order: amplitude * np.cos(order * theta + order) for order, amplitude in lines.items()}
    parts = separate(sum(one.values()) + 11.0, TEETH)
    regular = one[1] + one[2] + one[TEETH] + one[TEETH + 1] + one[3 * TEETH - 1]
    np.testing.assert_allclose(parts.regular, regular, atol=1e-12)
    np.testing.assert_allclose(parts.difference, one[5] + one[TEETH - 2], atol=1e-12)
    kept = one[5] + one[TEETH - 2] + one[TEETH + 1] + one[3 * TEETH - 1]
    np.testing.assert_allclose(parts.residual, kept, atol=1e-12)
    assert mesh_amplitudes(sum(one.values()), TEETH, 3) == pytest.approx([4.0, 0.0, 0.0], abs=1e-12)


def test_what_counts_as_regular_can_be_chosen():
    theta = TURN * np.arange(512) / 512
    first, third = np.cos(theta), np.cos((TEETH + 3) * theta)
    mesh = np.cos(TEETH * theta)
    parts = separate(first + third + mesh, TEETH, shaft_harmonics=0, sidebands=3)
    np.testing.assert_allclose(parts.difference, first, atol=1e-12)
    np.testing.assert_allclose(parts.residual, first + third, atol=1e-12)


def test_points_are_no_coarser_than_the_samples_of_the_slowest_turn():
    phase = chirped()
    slowest = TURN / np.diff(phase).min()
    points = whole_turns(phase, np.cos(phase)).per_turn
    assert slowest <= points < 2 * slowest
    assert points == 1024
    phase = chirped(turns=56.0, spread=0.8)  # 357 samples in a mean turn, 595 in the slowest
    assert whole_turns(phase, np.cos(phase)).per_turn == 1024


GOOD = TURN * np.arange(1000) / 50
WAVE = np.cos(GOOD)


def bent(values, at, value):
    changed = values.copy()
    changed[at] = value
    return changed


@pytest.mark.parametrize(
    ("phase", "x", "place"),
    [
        (GOOD, bent(WAVE, 10, np.nan), "x"),
        (GOOD, bent(WAVE, 10, np.inf), "x"),
        (GOOD, np.full(1000, 3.3), "x"),
        (GOOD, np.zeros(1000), "x"),
        (GOOD[:5], WAVE[:5], "x"),
        (GOOD, np.ones((1000, 2)), "x"),
        (GOOD, np.exp(1j * GOOD), "x"),
        (GOOD, np.full(1000, "1.0"), "x"),
        (bent(GOOD, 10, np.nan), WAVE, "phase"),
        (bent(GOOD, 10, GOOD[9]), WAVE, "phase"),
        (-GOOD, WAVE, "phase"),
        (np.mod(GOOD, TURN), WAVE, "phase"),
        (GOOD[:-1], WAVE, "phase"),
        (GOOD / 30, WAVE, "phase"),
        (np.cumsum(np.r_[np.full(500, 0.1), np.full(500, 1e-3)]), WAVE, "phase"),
    ],
)
def test_bad_input_is_refused(phase, x, place):
    with pytest.raises(InputError) as caught:
        synchronous_average(phase, x)
    assert caught.value.place == place
    assert caught.value.expected
    assert caught.value.got


def test_bad_settings_are_refused():
    for keywords in ({"degree": 2}, {"per_turn": 1}, {"per_turn": 2.5}, {"least": 100}, {"least": 0}):
        with pytest.raises(InputError):
            synchronous_average(GOOD, WAVE, **keywords)
    for arguments in ((WAVE, 2), (WAVE[:40], 23), (bent(WAVE, 3, np.nan), 23)):
        with pytest.raises(InputError):
            separate(*arguments)
    with pytest.raises(InputError):
        separate(WAVE, 23, sidebands=12)
    with pytest.raises(InputError):
        mesh_amplitudes(WAVE[:50], 23, 2)
