"""The baseline of a running monitor and its file: when it is written, and what happens where that fails."""

import dataclasses
import shutil

import pytest

from nw_gear_common.errors import InputError
from nw_gear_monitor.alarms import kernel, store
from nw_gear_monitor.alarms.identity import identity_of
from nw_gear_monitor.alarms.keeper import EVERY, Keeper
from nw_gear_monitor.alarms.operating import Bin
from nw_gear_monitor.pipeline import Windows
from test.monitor.gear_signal import paper

IDENTITY = identity_of(paper(), Windows())


def learn(keeper, windows=1.0):
    keeper.baseline.columns(["III/rms"])
    keeper.baseline.statistics(Bin(34, -49))[kernel.COUNT] += windows


def count(path):
    found = store.read(path, IDENTITY)
    return None if found is None else sum(float(block[kernel.COUNT].sum()) for block in found.bins.values())


def test_it_is_written_once_a_minute_where_something_was_learned(tmp_path):
    path = tmp_path / "baseline.json"
    keeper = Keeper(str(path), IDENTITY)
    keeper.keep(1000.0)
    assert not path.exists()  # nothing is known yet
    learn(keeper)
    keeper.keep(1000.0 + EVERY - 1.0)
    assert not path.exists()
    keeper.keep(1000.0 + EVERY)
    assert count(path) == 1.0
    before = path.stat().st_mtime_ns
    keeper.keep(1000.0 + 2 * EVERY)
    assert path.stat().st_mtime_ns == before
    learn(keeper)
    keeper.save()
    assert count(path) == 2.0
    assert Keeper(str(path), IDENTITY).found


def test_a_file_that_cannot_be_written_is_trouble_that_passes(tmp_path):
    folder = tmp_path / "there"
    folder.mkdir()
    keeper = Keeper(str(folder / "baseline.json"), IDENTITY)
    learn(keeper)
    shutil.rmtree(folder)
    keeper.save()
    assert "a file that can be written" in keeper.trouble
    folder.mkdir()
    keeper.save()
    assert keeper.trouble == ""
    assert count(folder / "baseline.json") == 1.0


def test_without_a_file_nothing_is_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    keeper = Keeper("", IDENTITY)
    learn(keeper)
    keeper.save()
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(InputError, match="parameter export_file"):
        keeper.export("")
    assert keeper.export("copy.json") == str(tmp_path / "copy.json")
    assert count(tmp_path / "copy.json") == 1.0


def test_a_baseline_is_used_at_its_own_sample_rate_alone(tmp_path):
    path = tmp_path / "baseline.json"
    keeper = Keeper(str(path), IDENTITY)
    assert keeper.admit(5120.0) == ""
    learn(keeper)
    keeper.save()
    again = Keeper(str(path), IDENTITY)
    assert again.admit(5120.0 * (1 + 1e-6)) == ""
    assert again.admit(10240.0) == "the baseline was learned at 5120 Hz, the waveform has 10240 Hz"


@pytest.mark.parametrize(
    ("machine", "windows"),
    [
        (dataclasses.replace(paper(), name="another"), Windows()),
        (dataclasses.replace(paper(), bearings=paper().bearings[1:]), Windows()),
        (dataclasses.replace(paper(), channels=paper().channels[1:]), Windows()),
        (paper(), Windows(label_seconds=32)),
        (paper(), Windows(envelope_low=600.0)),
    ],
)
def test_another_machine_has_another_identity(tmp_path, machine, windows):
    path = tmp_path / "baseline.json"
    store.write(path, Keeper("", IDENTITY).baseline, IDENTITY)
    before = path.read_bytes()
    with pytest.raises(InputError, match="identity"):
        Keeper(str(path), identity_of(machine, windows))
    assert path.read_bytes() == before


def test_a_folder_that_does_not_exist_is_refused_at_the_start(tmp_path):
    with pytest.raises(InputError, match="parameter baseline_file: expected a file in a folder that exists"):
        Keeper(str(tmp_path / "missing" / "baseline.json"), IDENTITY)
