"""Readers of files under random and damaged input: a result or an InputError, nothing else, and no big arrays."""

import io
import struct
import tracemalloc
import wave
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from nw_gear_common.errors import InputError
from nw_gear_monitor.analyse.options import Options
from nw_gear_monitor.analyse.select import signals
from nw_gear_monitor.datafiles.read import READERS, read

X = np.sin(np.arange(100.0))
MOST_MEMORY = 50_000_000
"""Bytes; the files are some kilobytes long."""
FEW, MANY = 120, 1500


def sound(bits):
    file = io.BytesIO()
    with wave.open(file, "wb") as writer:
        writer.setnchannels(2)
        writer.setsampwidth(bits // 8)
        writer.setframerate(100)
        writer.writeframes(bytes(k % 251 for k in range(200 * bits // 8)))
    return file.getvalue()


def saved(save, *arguments, **options):
    file = io.BytesIO()
    save(file, *arguments, **options)
    return file.getvalue()


VARIABLES = {"x": X, "fs": 100.0, "run": {"y": X, "text": "abc"}, "m": np.ones((3, 5)), "z": 1j * X, "e": np.zeros(0)}
FIELDS = np.zeros(80, dtype=[("a", "<f4"), ("b", ">i2")])
GOOD = {
    ".csv": [
        ("time;x\n" + "\n".join(f"{k / 100:.2f};{x:.4f}" for k, x in enumerate(X))).encode(),
        ("# text\nt [ms],x,note\n" + "\n".join(f"{10 * k},{x},a" for k, x in enumerate(X))).encode("utf-16"),
    ],
    ".npy": [saved(np.save, X), saved(np.save, np.ones((80, 3), order="F")), saved(np.save, FIELDS)],
    ".wav": [sound(8), sound(16), sound(24), sound(32)],
    ".mat": [saved(savemat, VARIABLES), saved(savemat, VARIABLES, do_compression=True)],
}


def survive(folder: Path, suffix: str, data: bytes) -> None:
    """Read a file and choose its signals: whatever comes out is finite, and fits to the size of the file."""
    file = folder / f"a{suffix}"
    file.write_bytes(data)
    words = ""
    tracemalloc.start()
    try:
        source = read(file)
        assert sum(column.nbytes for column in source.columns.values()) <= 16 * len(data) + 2**20
        found = signals(source, Options(rate=None if source.rate or source.time else 100.0))
        assert all(np.isfinite(signal.x).all() and signal.x.size >= 64 for signal in found)
    except InputError as error:
        words = str(error)
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert peak < MOST_MEMORY
    assert "\n" not in words
    assert len(words) < 3000


@st.composite
def damaged(draw, originals):
    """A valid file that was cut, or got bytes changed, put in, taken out or added."""
    data = bytearray(draw(st.sampled_from(originals)))
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, max(len(data) - 1, 0)))
        kind = draw(st.sampled_from(("cut", "flip", "word", "insert", "remove", "extend")))
        if kind == "cut":
            del data[at:]
        elif kind == "flip" and data:
            data[at] ^= 1 << draw(st.integers(0, 7))
        elif kind == "word":
            data[at : at + 4] = struct.pack("<I", draw(st.sampled_from((0, 1, 0x7FFFFFFF, 0xFFFFFFFF, 1 << 30))))
        elif kind == "insert":
            data[at:at] = draw(st.binary(max_size=8))
        elif kind == "remove":
            del data[at : at + draw(st.integers(1, 16))]
        elif kind == "extend":
            data += draw(st.binary(max_size=64))
    return bytes(data)


# The beginning, where the headers are, is hit more often than chance would.
@st.composite
def damaged_head(draw, originals):
    data = bytearray(draw(st.sampled_from(originals)))
    for _ in range(draw(st.integers(1, 6))):
        at = draw(st.integers(0, min(len(data) - 1, 260)))
        data[at] = draw(st.integers(0, 255))
    return bytes(data)


def inputs(suffix):
    return st.one_of(st.binary(max_size=300), damaged(GOOD[suffix]), damaged_head(GOOD[suffix]))


relaxed = {"deadline": None, "suppress_health_check": list(HealthCheck)}


@pytest.mark.parametrize("suffix", GOOD)
def test_undamaged_files_are_read(tmp_path, suffix):
    for data in GOOD[suffix]:
        (tmp_path / f"a{suffix}").write_bytes(data)
        assert read(tmp_path / f"a{suffix}").columns


def test_every_kind_is_tried():
    assert {READERS[suffix] for suffix in GOOD} == set(READERS.values())


@settings(max_examples=FEW, **relaxed)
@example(b"x\n" + b"1\n" * 70)
@given(inputs(".csv"))
def test_csv(tmp_path, data):
    survive(tmp_path, ".csv", data)


@settings(max_examples=FEW, **relaxed)
@given(st.text(alphabet='0123456789.,;:-+eE\t\n"#nainfT ', max_size=400))
def test_almost_csv(tmp_path, text):
    survive(tmp_path, ".csv", ("t;x,y\n" + text).encode())


@settings(max_examples=FEW, **relaxed)
@given(inputs(".npy"))
def test_npy(tmp_path, data):
    survive(tmp_path, ".npy", data)


@settings(max_examples=FEW, **relaxed)
@given(
    st.sampled_from(("<f8", ">i4", "|O", "<c16", "<U9", "|V8", "<f2", "|b1", "<M8[s]", "bad", "<f8,<f8")),
    st.lists(st.integers(-1, 10**12), max_size=4).map(tuple),
    st.binary(max_size=100),
)
def test_headers_of_npy(tmp_path, kind, shape, data):
    head = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}}}\n".encode()
    survive(tmp_path, ".npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + data)


@settings(max_examples=FEW, **relaxed)
@given(inputs(".wav"))
def test_wav(tmp_path, data):
    survive(tmp_path, ".wav", data)


@settings(max_examples=FEW, **relaxed)
@given(
    st.sampled_from((0, 1, 2, 3, 6, 0xFFFE)),
    st.integers(0, 65535),
    st.integers(0, 2**32 - 1),
    st.integers(0, 65535),
    st.sampled_from((0, 1, 8, 12, 16, 24, 32, 64, 65535)),
    st.integers(0, 2**32 - 1),
    st.binary(max_size=200),
)
def test_headers_of_wav(tmp_path, code, channels, rate, frame, bits, size, data):
    form = struct.pack("<HHIIHH", code, channels, rate, 0, frame, bits)
    head = b"RIFF\0\0\0\0WAVEfmt " + struct.pack("<I", 16) + form + b"data"
    survive(tmp_path, ".wav", head + struct.pack("<I", size) + data)
    survive(tmp_path, ".wav", head + struct.pack("<I", len(data)) + data)


@settings(max_examples=FEW, **relaxed)
@given(inputs(".mat"))
def test_mat(tmp_path, data):
    survive(tmp_path, ".mat", data)


@pytest.mark.slow
@pytest.mark.parametrize("suffix", GOOD)
def test_many_more(tmp_path, suffix):
    @settings(max_examples=MANY, **relaxed)
    @given(inputs(suffix))
    def attempt(data):
        survive(tmp_path, suffix, data)

    attempt()
