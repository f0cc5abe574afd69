"""The sample rate by a column of times, however they are written."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from nw_gear_common.errors import InputError
from nw_gear_monitor.datafiles import csvfile, matfile, npyfile
from nw_gear_monitor.datafiles.source import Source
from nw_gear_monitor.datafiles.timing import sample_rate


def source(time, resolution=0.0):
    return Source("file", {"t": np.asarray(time)}, time="t", time_resolution=resolution)


@settings(deadline=None, max_examples=100)
@given(st.floats(1.0, 1e5), st.integers(1, 9), st.floats(0.0, 1e5), st.integers(200, 3000))
def test_times_rounded_to_any_digits(rate, digits, start, size):
    """The rate is found to what rounding leaves open, or, where the digits are too few, times are said to be uneven."""
    time = np.round(start + np.arange(size) / rate, digits)
    try:
        found = sample_rate(source(time, 10.0**-digits), None)
    except InputError:
        found = None
        assert 10.0**-digits > 0.01 / rate  # digits too few
    if found is not None:
        assert found == pytest.approx(rate, rel=2e-3 + 4.0 * 10.0**-digits * rate / size)


@pytest.mark.parametrize(
    ("cells", "rate"),
    [
        ([f"{k * 0.0001953125:.6f}" for k in range(300)], 5120.0),
        ([f"{k * 1e-3:.3e}" for k in range(300)], 1000.0),
        ([f"2026-01-31T23:59:59.{k:03d}Z" for k in range(300)], 1000.0),
        ([f"2026-01-31 23:59:59.{k:03d}" for k in range(300)], 1000.0),
        ([f"{k // 2}{',5' if k % 2 else ',0'}" for k in range(300)], 2.0),
    ],
)
def test_ways_to_write(tmp_path: Path, cells, rate):
    file = tmp_path / "a.csv"
    file.write_text("Timestamp;x\n" + "\n".join(f"{cell};{k}" for k, cell in enumerate(cells)))
    assert sample_rate(csvfile.read(file), None) == pytest.approx(rate, rel=1e-3)
    assert sample_rate(csvfile.read(file), rate) == rate


@pytest.mark.parametrize(("unit", "seconds"), [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("µs", 1e-6), ("min", 60.0)])
def test_units(tmp_path: Path, unit, seconds):
    file = tmp_path / "a.csv"
    file.write_text(f"x,time [{unit}]\n" + "\n".join(f"{k % 7},{k}" for k in range(200)), encoding="utf-8")
    assert sample_rate(csvfile.read(file), None) == pytest.approx(1.0 / seconds)


def test_times_in_files_without_a_header(tmp_path: Path):
    """A vector t of MATLAB, also within a structure, and a field of a structured array."""
    time = np.arange(300) / 64.0
    for variables in ({"x": np.sin(time), "t": time}, {"run": {"x": np.sin(time), "Time": time}}):
        savemat(tmp_path / "a.mat", variables)
        assert sample_rate(matfile.read(tmp_path / "a.mat"), None) == pytest.approx(64.0)
    fields = np.zeros(300, dtype=[("time_ms", "f8"), ("x", "f4")])
    fields["time_ms"] = 1e3 * time
    np.save(tmp_path / "a.npy", fields)
    assert sample_rate(npyfile.read(tmp_path / "a.npy"), None) == pytest.approx(64.0)


def test_what_the_file_says_twice_has_to_agree():
    time = np.arange(200) / 100.0
    both = Source("file", {"t": time}, rate=50.0, time="t")
    with pytest.raises(InputError, match="100 Hz, as column t says"):
        sample_rate(both, None)
    with pytest.raises(InputError, match="50 Hz"):
        sample_rate(both, 100.0)
