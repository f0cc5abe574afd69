"""`nw_gear analyse` on files of signals whose exponents, dimensions, entropies and lines are known."""

import json
import re
import wave

import numpy as np
import pytest
from scipy.io import savemat

from nw_gear_common import cli
from nw_gear_monitor.datafiles.read import read
from nw_gear_monitor.datafiles.timing import sample_rate
from test.monitor.chaotic import henon, lorenz, shuffled
from test.monitor.gear_signal import logistic

RATE = 20000.0


@pytest.fixture
def analyse(capfd):
    def run(*arguments):
        code = cli.main(["analyse", *map(str, arguments), "--json"])
        out, err = capfd.readouterr()
        assert code == 0, err
        return json.loads(out)

    return run


def only(found):
    (channel,) = found["channels"].values()
    return channel


def knocks(order=3.58, shaft=25.0, seconds=4.0):
    """A bearing's knocks that ring at 4 kHz, a line of the shaft, noise."""
    time = np.arange(round(seconds * RATE)) / RATE
    x = 0.3 * np.random.default_rng(0).standard_normal(time.size) + 0.5 * np.sin(2.0 * np.pi * shaft * time)
    since = np.mod(time, 1.0 / (order * shaft))
    return time, x + np.exp(-800.0 * since) * np.sin(2.0 * np.pi * 4000.0 * since)


def test_maps(analyse, tmp_path):
    """ln 2 and 0.41922 (Sprott); orders of the logistic map 2.14926 bits; 0-1 test near 1."""
    np.savetxt(tmp_path / "logistic.csv", logistic(4.0, 4096), header="x", comments="")
    found = analyse(tmp_path / "logistic.csv", "--map")
    assert found["rate_hz"] is None
    assert found["samples"] == 4096
    values = only(found)["indicators"]
    assert only(found)["state"] == "chaotic"
    assert values["largest_exponent"] == pytest.approx(np.log(2.0), rel=0.01)
    assert values["permutation_entropy"] == pytest.approx(2.14926, abs=0.01)
    assert values["zero_one_k"] > 0.95
    assert values["correlation_dimension"] == pytest.approx(1.0, abs=0.15)
    points = henon(4096)
    np.savetxt(tmp_path / "henon.csv", points, header="x,y", comments="", delimiter=",")
    for values in [channel["indicators"] for channel in analyse(tmp_path / "henon.csv", "--map")["channels"].values()]:
        assert values["largest_exponent"] == pytest.approx(0.41922, rel=0.05)
        assert values["correlation_dimension"] == pytest.approx(1.22, abs=0.08)
    values = only(analyse(tmp_path / "henon.csv", "--map", "--column", "x", "--velocity", "y"))["indicators"]
    assert values["largest_exponent"] == pytest.approx(0.41922, rel=0.05)


def test_a_flow_per_second(analyse, tmp_path):
    """Lorenz 0.9056 1/s at any sample rate that is stated: twice the rate, twice the exponent."""
    np.save(tmp_path / "lorenz.npy", lorenz(16384)[:, 0])
    values = only(analyse(tmp_path / "lorenz.npy", "--rate", 100))["indicators"]
    assert values["largest_exponent"] == pytest.approx(0.9056, rel=0.12)
    assert values["correlation_dimension"] == pytest.approx(2.068, abs=0.2)
    double = only(analyse(tmp_path / "lorenz.npy", "--rate", 200))["indicators"]
    assert double["largest_exponent"] == pytest.approx(2.0 * values["largest_exponent"], rel=1e-9)


@pytest.mark.slow
def test_a_driven_oscillator(analyse, tmp_path):
    """Ueda's x" + 0.05 x' + x^3 = 7.5 sin t: 0.1034 per unit time (Sprott, Chaos and Time-Series Analysis, 2003)."""
    per_cycle, cycles, fine = 40, 1200, 2
    step = 2.0 * np.pi / (per_cycle * fine)
    drive = 7.5 * np.sin(0.5 * step * np.arange(2 * per_cycle * fine))
    samples = np.empty((cycles * per_cycle, 2))

    def slope(x, v, force):
        return v, force - 0.05 * v - x**3

    x, v = 2.5, 0.0
    for number in range(-50 * per_cycle * fine, cycles * per_cycle * fine):
        if number % fine == 0:
            samples[max(number // fine, 0)] = x, v
        forces = [drive[(2 * number + k) % drive.size] for k in range(3)]
        a = slope(x, v, forces[0])
        b = slope(x + 0.5 * step * a[0], v + 0.5 * step * a[1], forces[1])
        c = slope(x + 0.5 * step * b[0], v + 0.5 * step * b[1], forces[1])
        d = slope(x + step * c[0], v + step * c[1], forces[2])
        x += step / 6.0 * (a[0] + 2.0 * b[0] + 2.0 * c[0] + d[0])
        v += step / 6.0 * (a[1] + 2.0 * b[1] + 2.0 * c[1] + d[1])
    np.savetxt(tmp_path / "a.csv", samples, delimiter=",", header="x,v", comments="")
    options = ("--rate", per_cycle / (2.0 * np.pi), "--strobe", 1.0 / (2.0 * np.pi))
    for more in ((), ("--velocity", "v")):
        channel = only(analyse(tmp_path / "a.csv", *options, "--column", "x", *more))
        assert channel["state"] == "chaotic"
        assert channel["indicators"]["largest_exponent"] == pytest.approx(0.1034, rel=0.25)
        assert channel["indicators"]["zero_one_k"] > 0.95


def test_noise_drowns_the_exponent_and_the_reason_is_said(analyse, tmp_path):
    x = lorenz(8192)[:, 0]
    np.save(tmp_path / "x.npy", x + 0.05 * np.std(x) * np.random.default_rng(1).standard_normal(x.size))
    channel = only(analyse(tmp_path / "x.npy", "--rate", 100))
    assert channel["noise_db"] == pytest.approx(26.0, abs=1.0)
    assert channel["indicators"]["largest_exponent"] is None
    assert "noise" in channel["notes"]["largest_exponent"]


def test_white_noise(analyse, tmp_path):
    """Sample entropy -ln erf 0.1, permutation entropy log2 6, DET = 1 - (1 - RR)^2; never chaotic."""
    np.save(tmp_path / "noise.npy", np.random.default_rng(3).standard_normal(8000))
    channel = only(analyse(tmp_path / "noise.npy", "--map"))
    values = channel["indicators"]
    assert channel["state"] == "unknown"
    assert values["largest_exponent"] is None
    assert values["sample_entropy"] == pytest.approx(2.1851, abs=0.02)
    assert values["permutation_entropy"] == pytest.approx(np.log2(6.0), abs=1e-3)
    assert values["determinism"] == pytest.approx(1.0 - (1.0 - values["recurrence_rate"]) ** 2, abs=0.01)
    assert values["kurtosis"] == pytest.approx(3.0, abs=0.1)
    assert only(analyse(tmp_path / "noise.npy", "--rate", 1000))["state"] == "unknown"


@pytest.mark.parametrize(("period", "noise"), [(1, 0.0), (2, 0.0), (2, 1e-3), (3, 1e-2)])
def test_periodic_motion_has_a_period_and_no_exponent(analyse, tmp_path, period, noise):
    """By strobe frequency and by phase column alike; rms of cos + cos/2 is sqrt(0.5 + 0.125)."""
    time = np.arange(12000) / 500.0
    phase = 2.0 * np.pi * 7.0 * time
    x = np.cos(phase) + (0.5 * np.cos(phase / period + 1.0) if period > 1 else 0.0)
    x += noise * np.random.default_rng(2).standard_normal(x.size)
    data = np.column_stack([time, phase, x])
    np.savetxt(tmp_path / "x.csv", data, header="time,phase,x", comments="", delimiter=",")
    by_phase = only(analyse(tmp_path / "x.csv", "--phase", "phase"))
    by_strobe = only(analyse(tmp_path / "x.csv", "--strobe", 7, "--column", "x"))
    for channel in (by_phase, by_strobe):
        assert channel["state"] == f"period-{period}"
        assert channel["period"] == period
        assert channel["indicators"]["largest_exponent"] is None
        assert f"period-{period}" in channel["notes"]["largest_exponent"]
    wanted = np.sqrt(0.5 + (0.125 if period > 1 else 0.0) + noise**2)
    assert by_phase["indicators"]["rms"] == pytest.approx(wanted, rel=1e-2)
    if period == 1:
        assert by_phase["indicators"]["crest_factor"] == pytest.approx(np.sqrt(2.0), rel=1e-3)
        assert by_phase["indicators"]["kurtosis"] == pytest.approx(1.5, rel=1e-3)
        assert by_phase["indicators"]["determinism"] > 0.99


def test_lines_of_a_bearing(analyse, tmp_path):
    time, x = knocks()
    np.savetxt(tmp_path / "a.csv", np.column_stack([time, x]), "%.6f", ";", header="Time [s];a", comments="")
    options = ("--shaft-rate", 25, "--bearing-orders", "3.58,5.42")
    found = analyse(tmp_path / "a.csv", "--envelope", "3000:5000", *options)
    channel = only(found)
    assert found["rate_hz"] == pytest.approx(RATE, rel=1e-6)
    assert found["envelope_peaks_hz"] == channel["envelope_peaks_hz"]
    assert channel["envelope_peaks_hz"][0] == pytest.approx(89.5, abs=0.1)
    lines = {round(line["order"], 2): line for line in channel["bearing_lines"]}
    assert lines[3.58]["prominence"] > 20.0
    assert lines[5.42]["prominence"] < 5.0
    assert channel["shaft_lines"][0]["amplitude"] == pytest.approx(0.5, rel=0.02)
    band = channel["impulsive_band"]
    assert band["low_hz"] < 4000.0 < band["high_hz"]
    chosen = only(analyse(tmp_path / "a.csv", *options))
    assert chosen["envelope_band_from"] == "kurtogram"
    assert chosen["envelope_peaks_hz"][0] == pytest.approx(89.5, abs=0.1)


def test_envelope_of_a_modulated_carrier(analyse, tmp_path):
    """A (1 + m cos) on a carrier reads m A at the frequency of the modulation, between two bins as well."""
    time = np.arange(40000) / RATE
    noise = 0.01 * np.random.default_rng(5).standard_normal(time.size)
    x = 2.0 * (1.0 + 0.3 * np.cos(2.0 * np.pi * 123.4 * time)) * np.cos(2.0 * np.pi * 4000.0 * time) + noise
    np.save(tmp_path / "x.npy", x)
    found = analyse(tmp_path / "x.npy", "--rate", RATE, "--envelope", "3000:5000")
    assert len(found["envelope_peaks_hz"]) == 1
    (peak,) = only(found)["envelope_peaks"]
    assert peak["hz"] == pytest.approx(123.4, abs=0.01)
    assert peak["amplitude"] == pytest.approx(0.6, rel=0.01)


def test_every_kind_of_file_says_the_same(analyse, tmp_path):
    """CSV in three dialects, NPY in two shapes, WAV of 16, 24, 32 bits, MAT: the same numbers."""
    numbers = np.round(30000.0 * (shuffled(2000) - 0.5)).astype(np.int16)
    x = numbers / 32768.0
    time = np.arange(x.size) / 8000.0
    written = [f"{t:.6f};{value!r};7,5" for t, value in zip(time, x.tolist(), strict=True)]
    (tmp_path / "a.csv").write_text("t (s);x;load\n" + "\n".join(row.replace(".", ",") for row in written))
    (tmp_path / "b.csv").write_text("# made by hand\n\nx,Time [ms]\n" + "\n".join(
        f"{value!r},{1e3 * t:.3f}" for t, value in zip(time, x.tolist(), strict=True)))  # fmt: skip
    (tmp_path / "c.txt").write_text("x\tphase\n" + "\n".join(f"{value!r}\t{k}" for k, value in enumerate(x.tolist())))
    np.save(tmp_path / "a.npy", x)
    np.save(tmp_path / "b.npy", np.stack([x, x[::-1]]))
    for bits in (16, 24, 32):
        with wave.open(str(tmp_path / f"{bits}.wav"), "wb") as file:
            file.setnchannels(2)
            file.setsampwidth(bits // 8)
            file.setframerate(8000)
            wide = numbers.astype("<i8") << (bits - 16)
            both = np.stack([wide, wide[::-1]], axis=1).reshape(-1)
            file.writeframes(both.astype("<i8").view(np.uint8).reshape(-1, 8)[:, : bits // 8].tobytes())
    savemat(tmp_path / "a.mat", {"x": x[:, None], "fs": 8000.0, "note": "text"})
    savemat(tmp_path / "b.mat", {"run": {"x": x, "sr": 8000.0}}, do_compression=True)
    cases = {
        "a.csv": ("x", None), "b.csv": ("x", None), "c.txt": ("x", 8000.0), "a.npy": ("ch1", 8000.0),
        "b.npy": ("ch1", 8000.0), "16.wav": ("ch1", None), "24.wav": ("ch1", None), "32.wav": ("ch1", 8000.0),
        "a.mat": ("x", None), "b.mat": ("run.x", None),
    }  # fmt: skip
    for name, (column, given) in cases.items():
        source = read(tmp_path / name)
        assert np.array_equal(source.column(column, "--column"), x), name
        assert sample_rate(source, given) == pytest.approx(8000.0, rel=1e-5), name
    assert only(analyse(tmp_path / "32.wav", "--column", "ch1"))["indicators"]["rms"] == pytest.approx(np.std(x))
    assert set(read(tmp_path / "24.wav").columns) == {"ch1", "ch2"}


def test_units_of_the_signal_do_not_matter(analyse, tmp_path):
    """What has no unit is the same in any; what has one follows it, up to the ends of the range of numbers."""
    x = henon(2000)[:, 0]
    np.save(tmp_path / "x.npy", x)
    values = only(analyse(tmp_path / "x.npy", "--map"))["indicators"]
    for power in (-1000, 1000):
        np.save(tmp_path / "y.npy", np.ldexp(x, power))
        scaled = only(analyse(tmp_path / "y.npy", "--map"))["indicators"]
        for name in set(values) - {"mean", "rms", "peak_to_peak"}:
            assert scaled[name] == values[name], name
        assert scaled["rms"] == np.ldexp(values["rms"], power)


def test_page_and_table(tmp_path, capfd):
    time, x = knocks(seconds=1.5)
    np.savetxt(tmp_path / "a.csv", np.column_stack([time, x]), "%.6f", ",", header="t,<b>a & b</b>", comments="")
    page = tmp_path / "page.html"
    options = ["--envelope", "3000:5000", "--shaft-rate", "25", "--bearing-orders", "3.58"]
    assert cli.main(["analyse", str(tmp_path / "a.csv"), *options, "-o", str(page)]) == 0
    out = capfd.readouterr().out
    assert "kurtosis" in out
    assert "envelope of 3000 to 5000 Hz" in out
    assert not any(ord(character) > 127 for character in out)  # no boxes, no colours
    text = page.read_text(encoding="utf-8")
    assert "<h2>&lt;b&gt;a &amp; b&lt;/b&gt;</h2>" in text
    assert not re.search(r"<(script|img|link)[^>]*(src|href)=.?http", text)
    for words in ("History", "Amplitude spectrum", "Phase portrait", "Envelope spectrum", "3.580"):
        assert words in text
