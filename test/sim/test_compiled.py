"""Where compiled kernels are kept."""

import re
import shutil
from pathlib import Path

import pytest

from nw_gear_sim import compiled


def test_folder_is_named_by_the_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another text of any kernel's file, called or calling, is another folder."""
    package = tmp_path / "nw_gear_sim"
    shutil.copytree(Path(compiled.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(compiled, "__file__", str(package / "compiled.py"))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    before = compiled.cache_folder()
    assert before.parent == tmp_path / "cache"
    assert re.fullmatch(r"kernels-[0-9a-f]{16}", before.name)
    assert before.is_dir()
    assert compiled.cache_folder() == before
    (package / "physics" / "ring.py").write_text("changed")
    assert compiled.cache_folder() != before


ALONE = "tangent/kernels.py"
"""Kernels in one file that no other kernel calls: numba itself notices that it has changed."""


def test_all_kernels_are_among_the_sources() -> None:
    package = Path(compiled.__file__).parent
    counted = {path for pattern in compiled.SOURCES for path in package.glob(pattern)}
    assert not any("nw_gear_sim.tangent" in path.read_text() for path in counted)
    counted.add(package / ALONE)
    for path in package.rglob("*.py"):
        if "nw_gear_sim.compiled import" in path.read_text():
            assert path in counted


def test_temporary_folder_where_the_cache_cant_be_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file" / "below"))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    folder = compiled.cache_folder()
    assert folder.is_dir()
    assert folder.parent == tmp_path
