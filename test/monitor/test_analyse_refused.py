"""What `nw_gear analyse` doesn't accept: one line with place, expected and got, exit code 2, and never a number."""

import os
import struct

import numpy as np
import pytest
from scipy.io import savemat

from nw_gear_common import cli
from test.monitor.gear_signal import logistic

X = logistic(4.0, 300)
TIME = np.arange(300) / 100.0


@pytest.fixture
def refused(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        code = cli.main(["analyse", *map(str, arguments), "--json"])
        out, err = capfd.readouterr()
        (line,) = [line for line in err.splitlines() if "expected" in line or "Traceback" in line]
        assert code == 2
        assert out == ""
        assert line.startswith("nw_gear: ")
        assert ": expected " in line
        assert ", got " in line
        return line

    return run


def table(name, head, *columns):
    rows = zip(*(list(column) for column in columns), strict=True)
    text = "\n".join(",".join(str(value) for value in row) for row in rows)
    with open(name, "w", encoding="utf-8") as file:
        file.write(f"{head}\n{text}\n")
    return name


def changed(values, index, value):
    return [value if k == index else old for k, old in enumerate(values)]


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (changed(X, 7, "nan"), "nan at sample 7"),
        (changed(X, 7, "inf"), "inf at sample 7"),
        (changed(X, 7, "-inf"), "-inf at sample 7"),
        (changed(X, 7, "1e999"), "inf at sample 7"),
        (changed(X, 7, ""), "row 9: expected a row of numbers, got a blank one"),
        (changed(X, 7, "1_000"), "row 9, column x"),
        (changed(X, 7, "broken"), "row 9, column x"),
        (changed(X, 7, "1;2"), "a.csv: row 9"),
        (np.full(300, 3.5), "a constant"),
        (X[:40], "at least 64 samples"),
        ([], "none"),
    ],
)
def test_values(refused, values, words):
    assert words in refused(table("a.csv", "x", values), "--map")


@pytest.mark.parametrize(
    ("times", "words"),
    [
        (changed(TIME, 50, TIME[48]), "times that grow"),
        (changed(TIME, 50, TIME[49]), "times that grow"),
        (TIME[::-1], "times that grow"),
        (np.concatenate([TIME[:150], 1.5 + np.arange(150) / 90.0]), "steps of 0.01 s"),
        (np.delete(np.arange(301) / 100.0, 77), "0.02 s at sample 77"),
        (changed(TIME, 50, "nan"), "finite numbers"),
        (changed(TIME, 50, "noon"), "column time"),
        (["noon", *TIME[1:]], "ISO 8601"),
    ],
)
def test_times(refused, times, words):
    assert words in refused(table("a.csv", "time,x", times, X))


def test_a_rate_that_changes_by_less_than_the_steps_may(refused):
    many = np.arange(20000)
    time = np.where(many < 10000, many / 1000.0, 10.0 + (many - 10000) / 1005.0)
    assert "one sample rate" in refused(table("a.csv", "time,x", np.round(time, 9), logistic(4.0, 20000)))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--rate", 90), "100 Hz, as column time says"),
        (("--column", "y"), "time, x, p"),
        (("--column", "name"), "text such as"),
        (("--velocity", "y", "--column", "x"), "--velocity y"),
        (("--velocity", "x", "--phase", "p"), "a column beside"),
        (("--velocity", "p", "--column", "x", "--column", "p"), "one channel"),
        (("--phase", "q"), "--phase q"),
        (("--phase", "x"), "an unwrapped phase that always grows"),
        (("--phase", "p", "--strobe", 5), "--strobe or --phase"),
        (("--strobe", 50), "less than half the sample rate"),
        (("--strobe", 49, "--column", "x"), "samples to a cycle"),
        (("--strobe", 0), "above zero"),
        (("--rate", "nan"), "above zero"),
        (("--rate", "-5"), "above zero"),
        (("--map", "--strobe", 5), "with --map"),
        (("--bearing-orders", "3.5"), "--shaft-rate"),
        (("--bearing-orders", "3.5;4", "--shaft-rate", 2), "numbers such as"),
        (("--bearing-orders", "3.5,-4", "--shaft-rate", 2), "above zero"),
        (("--envelope", "10"), "LOW:HIGH"),
        (("--envelope", "20:10"), "LOW:HIGH"),
        (("--envelope", "10:60"), "<= 50 Hz"),
        (("--envelope", "10:10.1"), "samples"),
        (("-o", "a.png"), "*.html"),
        (("-o", "none/a.html"), "a folder that exists"),
    ],
)
def test_options(refused, options, words):
    name = table("a.csv", "time,x,p,name", TIME, X, np.arange(300.0), ["a"] * 300)
    assert words in refused(name, *options)


def test_no_rate_anywhere(refused):
    assert "--rate" in refused(table("a.csv", "x", X))


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.csv", b"", "an empty file"),
        ("a.csv", b"\n\n", "blank lines"),
        ("a.csv", b"x\n", "none"),
        ("a.csv", b"1,2\n3,4\n", "names of the columns"),
        ("a.csv", b"x,x\n3,4\n", "each name once"),
        ("a.csv", b"x,y\n3,4\n3\n", "row 3"),
        ("a.csv", b"x,y\na,b\n", "columns of numbers"),
        ("a.csv", b"\x93NUMPY\x01\x00v\x00", "binary data"),
        ("a.csv", b'x\n"1\n', "at least 64 samples"),
        ("a.npy", b"", "an empty file"),
        ("a.npy", b"x,y\n1,2\n", "NumPy"),
        ("a.wav", b"x,y\n1,2\n", "another kind of file"),
        ("a.wav", b"RIFF\x24\0\0\0WAVE", "chunk 'fmt '"),
        ("a.mat", b"x,y\n1,2\n", "another kind of file"),
        ("a.mat", b"MATLAB 7.3 MAT-file, Platform: GLNXA64" + bytes(500), "save it with save(.., '-v7')"),
        ("a.mat", bytes(512) + b"\x89HDF\r\n\x1a\n", "save it with save(.., '-v7')"),
        ("a.xlsx", b"PK", "*.csv"),
        ("a", b"x", "*.csv"),
    ],
)
def test_contents(refused, tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content)
    assert words in refused(name, "--rate", 100)


def test_files_that_are_none(refused, tmp_path):
    assert "no such file" in refused("a.csv", "--rate", 1)
    (tmp_path / "b.csv").mkdir()
    assert "a folder" in refused("b.csv", "--rate", 1)
    os.mkfifo(tmp_path / "c.csv")  # reading it would wait for ever
    assert "a device" in refused("c.csv", "--rate", 1)


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (np.zeros((4, 4, 4)), "one or two dimensions"),
        (np.float64(3.0), "one or two dimensions"),
        (X + 1j, "real numbers"),
        (X > 0.5, "real numbers"),
        (np.array(["a", "b"]), "real numbers"),
        (np.array([{}, 3], dtype=object), "pickled objects"),
        (np.array([(1, {})], dtype=[("x", "f8"), ("y", "O")]), "pickled objects"),
        (np.zeros(0), "shape"),
        (np.zeros((100, 100)), "at most 64 channels"),
    ],
)
def test_arrays(refused, tmp_path, array, words):
    np.save(tmp_path / "a.npy", array, allow_pickle=True)
    assert words in refused("a.npy", "--rate", 100)


def test_headers_that_claim_more_than_there_is(refused, tmp_path):
    """A trillion samples in a file of some bytes: nothing of that size is made."""
    for shape in ("(1000000000000,)", "(1000000, 1000000)", "(-3,)", "(3.5,)"):
        head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}}}".ljust(117) + "\n"
        (tmp_path / "a.npy").write_bytes(
            b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode() + bytes(64)
        )
        refused("a.npy", "--rate", 100)
    form = struct.pack("<HHIIHH", 1, 1, 8000, 16000, 2, 16)
    sound = b"WAVEfmt " + struct.pack("<I", 16) + form + b"data" + struct.pack("<I", 0xFFFFFFFE) + bytes(64)
    (tmp_path / "a.wav").write_bytes(b"RIFF" + struct.pack("<I", len(sound)) + sound)
    assert "cut short" in refused("a.wav")
    mat = b"MATLAB 5.0".ljust(124) + b"\x00\x01IM" + struct.pack("<II", 14, 0xFFFFFFF0) + bytes(64)
    (tmp_path / "a.mat").write_bytes(mat)
    assert "cut short" in refused("a.mat", "--rate", 100)


@pytest.mark.parametrize("fields", [(2, 1, 8000, 4), (1, 0, 8000, 2), (1, 1, 0, 2), (1, 1, 8000, 3), (6, 1, 8000, 2)])
def test_formats_of_sound(refused, tmp_path, fields):
    """ADPCM, no channels, no rate, another frame, a-law."""
    code, channels, rate, frame = fields
    form = struct.pack("<HHIIHH", code, channels, rate, rate * frame, frame, 16)
    sound = b"WAVEfmt " + struct.pack("<I", 16) + form + b"data" + struct.pack("<I", 600) + bytes(range(200)) * 3
    (tmp_path / "a.wav").write_bytes(b"RIFF" + struct.pack("<I", len(sound)) + sound)
    refused("a.wav")


def test_variables_of_matlab(refused, tmp_path):
    savemat(tmp_path / "a.mat", {"z": X + 1j, "text": "abc", "cell": np.array([1, "a"], dtype=object), "x": X})
    assert "complex numbers" in refused("a.mat", "--rate", 100, "--column", "z")
    savemat(tmp_path / "a.mat", {"text": "abc"})
    assert "a vector or matrix" in refused("a.mat", "--rate", 100)
    savemat(tmp_path / "a.mat", {"x": X, "fs": 100.0, "run": {"sr": 200.0}})
    assert "one sample rate" in refused("a.mat")
    savemat(tmp_path / "a.mat", {"x": X, "fs": 100.0})
    assert "as the header" in refused("a.mat", "--rate", 200)
    savemat(tmp_path / "a.mat", {"x": X, "p": np.arange(200.0)})
    assert "one value for each of 300 samples" in refused("a.mat", "--rate", 100, "--phase", "p")
