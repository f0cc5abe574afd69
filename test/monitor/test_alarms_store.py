"""The file of a baseline: what is read is what was written, whatever else is in its place is refused and stays."""

import json
import math
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nw_gear_common.errors import InputError
from nw_gear_monitor.alarms import kernel, store
from nw_gear_monitor.alarms.baseline import Baseline
from nw_gear_monitor.alarms.operating import NO_LOAD, Bin

IDENTITY = {
    "meshes": ["I_1", "III"],
    "rated mesh frequencies (Hz)": [26.24, 324.2],
    "window (s)": 4,
    "name": "Getriebe ü",
}
STORED = [kernel.COUNT, kernel.INDEPENDENT, kernel.MEAN, kernel.M2, kernel.ABOVE, kernel.M2_ABOVE]

whole = st.integers(-(2**31), 2**31)
number = st.floats(0.0, 1e12)


@st.composite
def baselines(draw):
    baseline = Baseline()
    names = draw(st.lists(st.text(min_size=1, max_size=8), unique=True, max_size=4))
    baseline.columns(names)
    baseline.frozen = draw(st.booleans())
    baseline.rate = draw(st.none() | st.floats(1.0, 1e6))
    for speed, load in draw(st.lists(st.tuples(whole, whole), unique=True, max_size=4)):
        block = baseline.statistics(Bin(speed, load))
        for row in STORED:
            block[row] = draw(st.lists(number, min_size=len(names), max_size=len(names)))
    return baseline


def some():
    baseline = Baseline()
    baseline.rate = 5120.0
    baseline.columns(["I_1/rms", "III/rms"])
    for key in (Bin(34, NO_LOAD), Bin(34, -50)):
        block = baseline.statistics(key)
        block[STORED] = np.random.default_rng(abs(key.load)).random((len(STORED), 2)) * 1e-5
    return baseline


def same(a, b):
    return (a.names, a.frozen, a.rate, list(a.bins)) == (b.names, b.frozen, b.rate, list(b.bins)) and all(
        np.array_equal(a.bins[k][STORED], b.bins[k][STORED]) for k in a.bins
    )


RAW = store.encode(some(), IDENTITY).encode()


@given(baselines())
def test_what_is_read_is_what_was_written_to_the_bit(baseline):
    raw = store.encode(baseline, IDENTITY).encode()
    back = store.decode("here", raw, IDENTITY)
    baseline.bins = dict(sorted(baseline.bins.items()))
    assert same(back, baseline)
    assert all(np.all(np.isnan(block[kernel.LAST])) for block in back.bins.values())


@given(st.integers(0, len(RAW) - 3))
def test_a_file_cut_short_is_refused(length):
    with pytest.raises(InputError, match="here"):
        store.decode("here", RAW[:length], IDENTITY)


@settings(max_examples=400)
@given(st.integers(0, len(RAW) - 1), st.integers(1, 255))
def test_a_flipped_byte_is_refused_or_changes_nothing(position, flip):
    damaged = bytearray(RAW)
    damaged[position] ^= flip
    try:
        back = store.decode("here", bytes(damaged), IDENTITY)
    except InputError:
        return
    assert same(back, store.decode("here", RAW, IDENTITY))  # white space, or another way to write the same


anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=8,
)


@given(anything | st.binary(max_size=40))
def test_other_content_is_refused(content):
    raw = content if isinstance(content, bytes) else json.dumps(content).encode()
    with pytest.raises(InputError, match="here"):
        store.decode("here", raw, IDENTITY)


@settings(max_examples=300)
@given(
    st.sampled_from(["version", "identity", "rate_hz", "frozen", "features", "bins", "sha256"]), anything, st.booleans()
)
def test_another_value_in_any_entry_is_refused_even_with_a_right_checksum(key, value, inside):
    body = json.loads(RAW)
    good = body.pop("sha256")
    if inside and key == "bins":
        body["bins"][0]["mean"] = value
    elif key != "sha256":
        body[key] = value
    body["sha256"] = store._checksum(body) if key != "sha256" else value
    if body["sha256"] == good or (key == "frozen" and isinstance(value, bool)):
        return
    if inside and key == "bins" and isinstance(value, list) and all(type(v) in (int, float) for v in value):
        return  # two numbers instead of two others, or a wrong number of them
    if key == "rate_hz" and (value is None or (isinstance(value, float) and 0.0 < value < math.inf)):
        return
    if key in ("bins", "features") and value == [] and not (key == "features" or inside):
        return  # a baseline without bins is one
    with pytest.raises(InputError, match="here"):
        store.decode("here", json.dumps(body).encode(), IDENTITY)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"meshes": ["I_1", "II_1"]}, "identity: meshes"),
        ({"rated mesh frequencies (Hz)": [26.24, 324.3]}, "identity: rated mesh frequencies"),
        ({"window (s)": 8}, "identity: window"),
        ({"teeth": 3}, "identity: teeth"),
    ],
)
def test_the_baseline_of_another_machine_is_refused_and_named(tmp_path, change, said):
    path = tmp_path / "baseline.json"
    store.write(path, some(), IDENTITY)
    before = path.read_bytes()
    with pytest.raises(InputError, match=said):
        store.read(path, {**IDENTITY, **change})
    with pytest.raises(InputError, match="expected nothing of that name"):
        store.read(path, {key: value for key, value in IDENTITY.items() if key != "name"})
    assert path.read_bytes() == before
    nearly = [26.24 * (1 + 1e-12), 324.2]
    assert store.read(path, {**IDENTITY, "rated mesh frequencies (Hz)": nearly}) is not None


def test_no_file_is_no_baseline_and_a_folder_is_an_error(tmp_path):
    assert store.read(tmp_path / "none.json", IDENTITY) is None
    with pytest.raises(InputError, match="a baseline that can be read"):
        store.read(tmp_path, IDENTITY)
    with pytest.raises(InputError, match="a file that can be written"):
        store.write(tmp_path / "missing" / "baseline.json", some(), IDENTITY)
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match="a file that can be written"):
        store.write(tmp_path / "folder", some(), IDENTITY)
    assert [path.name for path in tmp_path.iterdir()] == ["folder"]  # nothing half written is left


def test_numbers_that_are_none_are_never_written():
    baseline = some()
    baseline.bins[Bin(34, -50)][kernel.MEAN, 0] = math.nan
    with pytest.raises(ValueError, match="JSON compliant"):
        store.encode(baseline, IDENTITY)


WRITER = """
import sys
from pathlib import Path
import numpy as np
from nw_gear_monitor.alarms import kernel, store
from nw_gear_monitor.alarms.baseline import Baseline
from nw_gear_monitor.alarms.operating import Bin

baseline = Baseline()
baseline.columns([f"feature {i}" for i in range(100)])
for k in range(20):
    baseline.statistics(Bin(k, k))[[kernel.COUNT, kernel.INDEPENDENT, kernel.MEAN]] = 0.0
number = 0.0
while True:
    number += 1.0
    for block in baseline.bins.values():
        block[kernel.COUNT] = number
    store.write(Path(sys.argv[1]), baseline, {"machine": "this"})
    print(int(number), flush=True)
"""


def test_a_writer_killed_at_any_moment_leaves_a_whole_file(tmp_path):
    path = tmp_path / "baseline.json"
    rng = np.random.default_rng(0)
    last = 0.0
    for _ in range(6):
        with subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE) as writer:
            for _ in range(2):
                writer.stdout.readline()
            time.sleep(rng.uniform(0.0, 0.05))  # anywhere between encoding, writing, syncing and renaming
            os.kill(writer.pid, signal.SIGKILL)
            said = [int(line) for line in writer.stdout.read().split() if line.isdigit()]
        found = store.read(path, {"machine": "this"})
        counts = {float(c) for block in found.bins.values() for c in block[kernel.COUNT]}
        assert len(counts) == 1
        last = counts.pop()
        assert last >= max([2, *said])
    assert last > 0
