"""`pip install .` into a fresh environment that holds ROS and the pinned libraries, and nothing of this tree."""

import sys
from pathlib import Path

import pytest

from test.system.installing import ROOT, check_executables, check_share, clean_environment, copy_of_the_sources, run

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pip")
    sources = copy_of_the_sources(folder)
    env = clean_environment()
    run(sys.executable, "-m", "venv", folder / "venv", env=env)
    lock = ROOT / "requirements" / "lock.txt"
    pip = (folder / "venv" / "bin" / "python", "-m", "pip", "install", "--quiet", "--constraint", lock)
    run(*pip, "-r", ROOT / "requirements" / "runtime.txt", env=env, limit=600.0)
    run(*pip, sources, env=env, limit=600.0)
    return folder / "venv"


@pytest.mark.parametrize("place", ["bin", "lib/nw_gear"])
def test_every_executable_starts(prefix, place):
    check_executables(prefix / place, clean_environment())


def test_the_index_and_the_shared_files_are_there(prefix):
    check_share(prefix)


def test_every_module_is_installed(prefix, tmp_path):
    code = "import nw_gear_common as c; print(c.__path__[0])"
    common = Path(run(prefix / "bin" / "python", "-c", code, env=clean_environment(), cwd=tmp_path).strip())
    assert prefix in common.parents
    for package in ("nw_gear_common", "nw_gear_sim", "nw_gear_monitor"):
        wanted = {path.relative_to(ROOT) for path in (ROOT / package).rglob("*.py")}
        assert wanted <= {path.relative_to(common.parent) for path in (common.parent / package).rglob("*.py")}
