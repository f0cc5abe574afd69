"""Where data files are found."""

import sys

import pytest

from nw_gear_common import share
from nw_gear_common.errors import InputError


def make(folder):
    path = folder / "share" / "nw_gear" / "config" / "only_here.yaml"
    path.parent.mkdir(parents=True)
    path.write_text("a: 1\n")
    return path


def test_the_source_tree_serves_without_any_environment(monkeypatch):
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    assert share.find("config/gearbox.yaml").is_file()


def test_prefixes_of_the_ament_index_are_looked_up_in_order(tmp_path, monkeypatch):
    first, second = make(tmp_path / "a"), make(tmp_path / "b")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'none'}:{tmp_path / 'a'}:{tmp_path / 'b'}")
    assert share.find("config/only_here.yaml") == first
    first.unlink()
    assert share.find("config/only_here.yaml") == second


def test_the_environment_python_runs_in_is_looked_up(tmp_path, monkeypatch):
    path = make(tmp_path)
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    assert share.find("config/only_here.yaml") == path


def test_a_missing_file_is_refused_with_the_places(monkeypatch, tmp_path):
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    with pytest.raises(InputError) as refused:
        share.find("config/nothing.yaml")
    assert refused.value.place == "config/nothing.yaml"
    assert str(tmp_path) in str(refused.value)
