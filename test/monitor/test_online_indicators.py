"""Indicators of turns, sections, contact and bearings through the whole pipeline, against closed forms."""

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.pipeline import Pipeline
from nw_gear_monitor.signals.cycles import mean_turn, whole_cycles
from test.monitor.gear_signal import blocks, paper

RATE = 5120
LEVEL = 1e-4
AMPLITUDE = 5e-6
BEARINGS = names.WAVEFORM_BEARINGS


def lines(parts, phase, omega):
    """Sum of a cos(q phi + p) and its derivative; parts are (a, q, p)."""
    x = sum(a * np.cos(q * phase + p) for a, q, p in parts)
    v = sum(-a * q * omega * np.sin(q * phase + p) for a, q, p in parts)
    return x, v


MESH = [(AMPLITUDE, 1, 0.0), (AMPLITUDE / 4, 2, 0.5), (AMPLITUDE / 8, 3, 1.0)]


def record(seconds, parts=None, *, noise=0.0, force=None, speed=1.0, rise=0.0, seed=1):
    """A waveform: the same lines (or `parts` of a stage) in every mesh; forces of noise, or `force` of a bearing.

    Args:
        parts: stage -> lines over its mesh phase, or a function of phase and angular frequency.
        noise: standard deviation of noise below 2 kHz that is added, m, with its exact derivative.
        force: bearing -> function of time and shaft phase giving two directions, N.
        speed, rise: share of the rated speed at the start, and what is added to it by the end.
    """
    gears, parts, force = paper(), parts or {}, force or {}
    time = np.arange(round(seconds * RATE)) / RATE
    turn = speed + rise * time / seconds
    cycles = speed * time + 0.5 * rise * time**2 / seconds
    phase = 2 * np.pi * np.outer(cycles, gears.rated_frequency) + 0.3
    omega = 2 * np.pi * np.outer(turn, gears.rated_frequency)
    rng = np.random.default_rng(seed)
    columns = names.waveform_columns()
    data = np.zeros((time.size, len(columns)))
    data[:, 0], data[:, 1:4] = time, phase
    for number, channel in enumerate(gears.channels):
        stage = names.STAGES.index(channel.stage)
        given = parts.get(channel.stage, MESH)
        own = phase[:, stage] + channel.planet_phase
        x, v = given(own, omega[:, stage]) if callable(given) else lines(given, own, omega[:, stage])
        more, its_rate = smooth_noise(time.size, noise, rng)
        data[:, 4 + number], data[:, 11 + number] = LEVEL + x + more, v + its_rate
    for number, bearing in enumerate(BEARINGS):
        shaft = gears.shaft(next(b.shaft for b in gears.bearings if b.name == bearing))
        angle = phase[:, names.STAGES.index(shaft.stage)] / shaft.teeth
        first = 1e4 + 10.0 * rng.standard_normal(time.size)
        both = force[bearing](time, angle) if bearing in force else (0.0, 0.0)
        data[:, 18 + 2 * number], data[:, 19 + 2 * number] = first + both[0], both[1]
    return Table(names.ROW_SAMPLE, columns, data)


def smooth_noise(size, deviation, rng, highest=2000.0):
    """Normal noise up to a frequency, and its derivative."""
    spectrum = np.fft.rfft(rng.standard_normal(size))
    frequency = np.fft.rfftfreq(size, 1 / RATE)
    spectrum[frequency > highest] = 0.0
    x = np.fft.irfft(spectrum, size)
    v = np.fft.irfft(2j * np.pi * frequency * spectrum, size)
    return deviation / x.std() * x, deviation / x.std() * v


def hops(table, rows=2560):
    pipeline = Pipeline(paper())
    return [hop for block in blocks(table, rows) for hop in pipeline.feed(block)]


def value(table, column):
    return float(table.column(column)[0])


@pytest.mark.parametrize("rise", [0.0, pytest.param(0.05, marks=pytest.mark.slow)], ids=["steady", "rising"])
def test_an_amplitude_modulated_mesh_line_has_its_sideband_energy_ratio(rise):
    """A (1 + m cos theta) cos(phi) has two sidebands of m A / 2; theta is the shaft of the 83 teeth."""
    m, z = 0.3, 83
    modulated = [*MESH, (AMPLITUDE * m / 2, 1 + 1 / z, 0.2), (AMPLITUDE * m / 2, 1 - 1 / z, -0.2)]
    hop = hops(record(6.0, {"II": modulated}, rise=rise))[-1]
    for mesh in ("II_1", "II_2", "II_3"):
        row = hop.indicators[mesh]
        assert value(row, "sideband_ratio_driver_1") == pytest.approx(m, rel=0.01)
        assert value(row, "sideband_driver") == pytest.approx(AMPLITUDE * m / 2, rel=0.01)
        assert value(row, "sideband_ratio_driver_2") < 0.02
        assert value(row, "sideband_ratio_driven_1") < 0.02
    assert value(hop.indicators["III"], "sideband_ratio_driver_1") < 0.02


def test_fm0_of_mesh_lines_and_fm4_of_normal_noise():
    """FM0 is peak-to-peak over the mesh lines; the noise that an average leaves is normal: FM4 = 3 +- sqrt(24 / n)."""
    fine = np.linspace(0, 2 * np.pi, 20_001)
    height = np.ptp(lines(MESH, fine, 1.0)[0]) / (AMPLITUDE * (1 + 1 / 4 + 1 / 8))
    quiet = hops(record(5.0, noise=1e-12))[-1].indicators["II_1"]
    assert value(quiet, "fm0_driver") == pytest.approx(height, rel=1e-3)
    assert value(quiet, "fm0_driven") == pytest.approx(height, rel=1e-3)
    row = hops(record(5.0, noise=2e-7))[-1].indicators["II_1"]
    for gear, teeth in (("driver", 83), ("driven", 40)):
        independent = 2 * 2000.0 / RATE * teeth * RATE / paper().rated_frequency[1]
        error = np.sqrt(24 / (0.9 * independent))  # two lines and two sidebands of each mesh harmonic are gone
        assert value(row, f"fm4_{gear}") == pytest.approx(3.0, abs=4 * error)
        assert value(row, f"na4_{gear}") == pytest.approx(3.0, abs=6 * error)


@pytest.mark.slow
def test_na4_rises_with_damage_and_stays_up_while_fm4_falls_back():
    """Noise that grows threefold in every tooth alike: FM4 doesn't see it, NA4 divides by what was before."""
    calm, rough = record(8.0, noise=1e-7), record(14.0, noise=3e-7, seed=2)
    data = calm.data.copy()
    rows = slice(8 * RATE, None)
    both = np.concatenate([data, rough.data[rows]])
    found = hops(Table(calm.row, calm.columns, both))
    before, after = (found[k].indicators["II_1"] for k in (7, 13))
    assert value(after, "na4_driven") > 3 * value(before, "na4_driven")
    assert value(after, "fm4_driven") == pytest.approx(3.0, abs=0.6)


def test_a_residual_of_next_to_nothing_is_no_damage():
    """One spike in a billionth of the signal has a kurtosis of thousands; under the floor NA4 is near zero."""

    def spiked(phase, omega):
        x, v = lines(MESH, phase, omega)
        turned = np.mod(phase, 40 * 2 * np.pi)
        return x + 1e-12 * np.exp(-((turned - 30.0) ** 2)), v

    row = hops(record(5.0, {"II": spiked}))[-1].indicators["II_1"]
    assert value(row, "na4_driven") < 0.01


@pytest.mark.slow
def test_stage_one_needs_its_long_window_and_a_slow_gearbox_gives_no_number():
    found = hops(record(17.0))
    ratio = [value(hop.indicators["I_1"], "sideband_ratio_driver_1") for hop in found]
    assert np.isnan(ratio[:15]).all()  # four turns of the ring are 13.9 s, and every fourth second it is computed
    assert np.isfinite(ratio[15:]).all()
    others = [value(hop.indicators["I_2"], "sideband_ratio_driver_1") for hop in found]
    assert np.isnan(others[:14]).all()
    assert others[14] == others[16]  # shown until it is computed anew
    assert np.isnan(value(found[2].indicators["II_1"], "fm0_driver"))
    assert np.isfinite(value(found[4].indicators["II_1"], "fm0_driver"))
    assert np.isnan(value(found[4].indicators["II_1"], "fm4_driver"))  # nothing beside the mesh lines but rounding
    slow = hops(record(17.0, speed=0.5))[-1]
    assert np.isnan(value(slow.indicators["I_1"], "sideband_ratio_driver_1"))
    assert np.isnan(value(slow.indicators["I_1"], "fm0_driver"))
    assert np.isfinite(value(slow.indicators["II_1"], "fm0_driver"))


def test_period_doubling_is_in_the_section_but_not_in_the_average_of_an_odd_gear():
    """Points of period 2 alternate: four orders of three, rounding decides between equals; all come back: DET = 1."""
    doubled = [*MESH, (AMPLITUDE / 3, 0.5, 0.0)]
    table = record(6.0, {"II": doubled})
    row = hops(table)[-1].indicators["II_1"]
    assert value(row, "permutation_entropy") == pytest.approx(2.0, abs=0.01)
    assert value(row, "sample_entropy") == pytest.approx(0.0, abs=0.02)
    assert value(row, "determinism") == pytest.approx(1.0, abs=0.01)
    x, v = table.column("x_II_1")[:, None], table.column("v_II_1")[:, None]
    cycles = whole_cycles(table.column("phase_II"), x, v, 1 / RATE)[0]
    average, turns = mean_turn(cycles[: 4 * 83], 83)  # an even number of turns
    per_cycle = cycles.shape[1]
    expected = lines(MESH, 2 * np.pi * np.arange(average.size) / per_cycle, 1.0)[0]
    assert turns == 4
    assert np.max(np.abs(average - expected)) < 1e-3 * AMPLITUDE


@pytest.mark.slow
def test_a_section_of_noise_reads_as_noise_and_one_of_a_single_point_reads_nothing():
    row = hops(record(12.0, noise=5e-7))[-1].indicators["III"]
    assert value(row, "permutation_entropy") == pytest.approx(np.log2(6), abs=0.02)
    assert value(row, "sample_entropy") == pytest.approx(2.185, abs=0.15)
    rate = value(row, "recurrence_rate")
    assert value(row, "determinism") == pytest.approx(1 - (1 - rate) ** 2, abs=0.02)
    still = hops(record(6.0))[-1].indicators["III"]
    for column in ("permutation_entropy", "sample_entropy", "determinism", "correlation_dimension"):
        assert np.isnan(value(still, column))


def test_contact_from_the_displacement():
    """A sine of twice the half gap about the middle is open for a third of the time, and as long behind it."""
    gap = paper().stage("II").half_gap
    middle = record(5.0, {"II": [(2 * gap, 1, 0.0)]})
    middle.data[:, 7:10] -= LEVEL
    row = hops(middle)[-1].indicators["II_1"]
    assert value(row, "open_share") == pytest.approx(1 / 3, abs=0.002)
    assert value(row, "back_flank_share") == pytest.approx(1 / 3, abs=0.002)
    closed = hops(record(5.0))[-1].indicators["II_1"]
    assert value(closed, "open_share") == value(closed, "back_flank_share") == 0.0


def knocks(order, size=30.0, ring=1200.0):
    """Knocks so many times a turn, each a ring of 1.2 kHz that dies within milliseconds."""

    def force(time, angle):
        place = np.arange(np.ceil(order * angle[0] / (2 * np.pi)), order * angle[-1] / (2 * np.pi))
        moments = np.interp(2 * np.pi * place / order, angle, time)
        total = np.zeros(time.size)
        for moment in moments:
            first = int(np.ceil(moment * RATE))
            t = time[first : first + 100] - moment
            total[first : first + 100] += size * np.exp(-t / 2e-3) * np.sin(2 * np.pi * ring * t)
        return total, 0.0

    return force


@pytest.mark.parametrize("rise", [0.0, pytest.param(0.04, marks=pytest.mark.slow)], ids=["steady", "rising"])
def test_knocks_of_the_outer_race_show_at_their_line_and_nowhere_else(rise):
    orders = next(b.orders for b in paper().bearings if b.name == "sb")
    hop = hops(record(10.0, force={"sb": knocks(orders.outer)}, rise=rise))[-1]
    row = hop.bearing_indicators["sb"]
    assert value(row, "bpfo_prominence") > 15
    for name, other in hop.bearing_indicators.items():
        for column in ("bpfo_prominence", "bpfi_prominence", "ftf_prominence"):
            if (name, column) != ("sb", "bpfo_prominence"):
                assert not value(other, column) > 5  # chance in noise: see docs/indicators.md
        assert np.isnan(value(other, "bsf"))  # roller counts don't tell it
    assert value(row, "spectral_kurtosis") > 2 * value(hop.bearing_indicators["b1"], "spectral_kurtosis")
    assert value(row, "spectral_kurtosis_low") < 1200 < value(row, "spectral_kurtosis_high")


def test_lines_of_a_bearing_force_at_shaft_speed_and_roller_passage():
    orders = next(b.orders for b in paper().bearings if b.name == "b21")

    def force(_time, angle):
        passing = 70.0 * np.cos(orders.outer * angle)
        return 300.0 * np.cos(angle) + passing, 400.0 * np.sin(angle)

    row = hops(record(5.0, force={"b21": force}))[-1].bearing_indicators["b21"]
    assert value(row, "shaft_rate") == pytest.approx(500.0, rel=0.01)
    assert value(row, "roller_pass") == pytest.approx(70.0, rel=0.02)
    assert value(row, "mean") == pytest.approx(1e4, rel=0.01)
    assert value(row, "rms") == pytest.approx(np.sqrt(300**2 / 2 + 70**2 / 2 + 100), rel=0.02)


def test_an_envelope_line_has_the_size_of_its_modulation():
    """A (1 + m cos q theta) on a carrier of 1.2 kHz reads m A at order q, up to 15 % less between two bins."""
    orders = next(b.orders for b in paper().bearings if b.name == "sb")

    def force(time, angle):
        return 100.0 * (1 + 0.4 * np.cos(orders.inner * angle)) * np.sin(2 * np.pi * 1200 * time), 0.0

    row = hops(record(10.0, force={"sb": force}))[-1].bearing_indicators["sb"]
    assert 34.0 < value(row, "bpfi") < 40.5
    assert value(row, "bpfo") < 2.0


def test_other_blocks_give_the_same_rows():
    table = record(6.0, noise=2e-7, force={"sb": knocks(13.2)})
    first, second = hops(table, 256), hops(table, 3001)
    for a, b in zip(first, second, strict=False):
        for name in ("indicators", "bearing_indicators"):
            for place, row in getattr(a, name).items():
                assert getattr(b, name)[place].data == pytest.approx(row.data, rel=1e-12, nan_ok=True)
