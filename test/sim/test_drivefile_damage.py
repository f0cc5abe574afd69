"""Damaged drive files: an error in one line or a valid series, whatever the bytes, and no more memory than the file."""

import struct
import tempfile
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nw_gear_common.errors import InputError
from nw_gear_sim.drivefile import read_drive_file
from test.sim.openfast_files import binary

TIMES = np.arange(6) * 0.1
DATA = np.column_stack([np.full(6, 9.0), 12.0 + np.sin(np.arange(6.0)), 4000.0 + np.arange(6.0)])
FILES = {identifier: binary(identifier, TIMES, DATA) for identifier in (1, 2, 3, 4)}
TEXT = (
    "remark\n\nTime RotSpeed RotTorq\n(s) (rpm) (kN-m)\n0.0 1.2E+01 4.0E+03\n0.1 1.3E+01 4.1E+03\n"
    "0.2 1.3E+01 4.1E+03\n0.3 1.2E+01 4.0E+03\n"
)
CSV = "time;speed (r/min);torque (kN m)\n0;12,5;4000\n1;12,75;4010,25\n2;13;4020\n3;13,5;3990\n"


def read_whatever(content: bytes, name: str) -> None:
    """Read; what comes out is an InputError of one line or a series that keeps its promises."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(content)
        try:
            series, message = read_drive_file(path, gaps="bridge"), ""
        except InputError as error:
            series, message = None, str(error)
    if series is None:
        assert len(message.splitlines()) == 1
        assert len(message) < 2000
        return
    assert len(series.times) == len(series.speed) == len(series.torque) >= 2
    assert series.times[0] == 0.0
    assert np.all(np.diff(series.times) > 0.0)
    assert np.all(np.isfinite(series.speed))
    assert np.all(series.speed >= 0.0)
    assert np.all(np.isfinite(series.torque))
    assert np.all(np.isfinite(series.at(0.4 * series.duration)))


@settings(max_examples=300, deadline=None)
@given(st.sampled_from((1, 2, 3, 4)), st.data())
def test_any_bits_flipped(identifier: int, data: st.DataObject) -> None:
    content = bytearray(FILES[identifier])
    for bit in data.draw(st.lists(st.integers(0, 8 * len(content) - 1), min_size=1, max_size=4)):
        content[bit // 8] ^= 1 << bit % 8
    read_whatever(bytes(content), "run.outb")


@settings(max_examples=100, deadline=None)
@given(st.binary(max_size=300), st.sampled_from((1, 2, 3, 4)))
def test_any_bytes_behind_an_identifier(content: bytes, identifier: int) -> None:
    read_whatever(struct.pack("<h", identifier) + content, "run.outb")


@pytest.mark.parametrize("identifier", FILES)
def test_every_truncation_is_refused(identifier: int, tmp_path: Path) -> None:
    path = tmp_path / "run.outb"
    for size in range(len(FILES[identifier])):
        path.write_bytes(FILES[identifier][:size])
        with pytest.raises(
            InputError, match=rf"run.outb: byte {size}: expected \d+ bytes of .*, got the end of the file"
        ):
            read_drive_file(path)
    path.write_bytes(FILES[identifier] + b"\0")
    with pytest.raises(InputError, match="expected the end of the file after 6 rows"):
        read_drive_file(path)


@settings(max_examples=150, deadline=None)
@given(st.sampled_from((("run.out", TEXT), ("drive.csv", CSV))), st.data())
def test_any_bytes_changed_in_text(file: tuple[str, str], data: st.DataObject) -> None:
    name, text = file
    content = bytearray(text.encode())
    for at in data.draw(st.lists(st.integers(0, len(content) - 1), min_size=1, max_size=4)):
        content[at] = data.draw(st.sampled_from(b'09-+.,;eE*\n\r\t\0\x0b\x85\xff"# nN') | st.integers(0, 255))
    read_whatever(bytes(content[: data.draw(st.integers(0, len(content)))]), name)


@pytest.mark.parametrize(
    ("identifier", "at", "form", "value", "message"),
    [
        (2, 0, "h", 5, r"byte 0: expected identifier of the format \(1 to 4\), got 5"),
        (2, 0, "h", 0, r"byte 0: expected identifier of the format .*, got 0"),
        (4, 2, "h", 0, r"byte 2: expected width of channel names, at least 1, got 0"),
        (2, 2, "i", 0, r"byte 2: expected number of channels, at least 1, got 0"),
        (2, 2, "i", 2**31 - 1, r"expected 8589934588 bytes of a scale of a channel from byte 26 on, got the end"),
        (2, 6, "i", 1, r"byte 6: expected number of rows, at least 2, got 1"),
        (3, 6, "i", 2**31 - 1, r"expected 51539607528 bytes of channels from byte 26 on, got the end"),
        (2, 10, "d", np.nan, r"byte 10: expected first time and step, got nan and 0.1"),
        (2, 18, "d", -0.1, r"byte 10: expected a step above 0 s, got -0.1"),
        (1, 10, "d", 0.0, r"byte 10: expected a scale of the times, got 0"),
        (2, 30, "f", 0.0, r"byte 30: expected a scale of a channel, got 0"),
        (2, 42, "f", np.inf, r"byte 42: expected an offset of a channel, got inf"),
        (2, 50, "i", -1, r"byte 50: expected length of the description, at least 0, got -1"),
        (3, 125, "d", np.inf, r"byte 125, row 1, column RotSpeed: expected a speed that is a finite number, got inf"),
        (3, 149, "d", -2.0, r"byte 149, row 2, column RotSpeed: expected a speed of at least 0, got -2"),
    ],
)
def test_what_is_wrong_in_a_binary_is_named(
    tmp_path: Path, identifier: int, at: int, form: str, value: float, message: str
) -> None:
    content = bytearray(FILES[identifier])
    struct.pack_into("<" + form, content, at, value)
    path = tmp_path / "run.outb"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        read_drive_file(path)


def test_memory_is_that_of_the_channels_read(tmp_path: Path) -> None:
    rows, channels = 20_000, 60
    names = ["Time", "RotSpeed", "RotTorq", *(f"Other{i}" for i in range(channels - 2))]
    units = ["(s)", "(rpm)", "(kN-m)", *["(-)"] * (channels - 2)]
    data = np.tile(np.linspace(1.0, 2.0, rows)[:, None], (1, channels))
    path = tmp_path / "run.outb"
    path.write_bytes(binary(3, np.arange(rows) * 0.01, data, names, units))
    del data
    read_drive_file(path)
    tracemalloc.start()
    try:
        read_drive_file(path)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 0.5 * path.stat().st_size  # three columns of sixty, a few times over
