"""colcon build, with and without --symlink-install, and colcon test; in a copy of the sources."""

import os
import re
import sys
from pathlib import Path

import pytest

from test.system.installing import check_executables, check_share, clean_environment, copy_of_the_sources, run, sourced

pytestmark = pytest.mark.slow

BIN = Path(sys.executable).parent


def colcon(verb, folder, *arguments):
    env = clean_environment(PATH=f"{BIN}:{os.environ['PATH']}")
    built = ["--base-paths", folder / "sources", "--build-base", folder / "build", "--install-base", folder / "install"]
    places = ["--test-result-base", folder / "build"] if verb == "test-result" else built
    return run("colcon", "--log-base", folder / "log", verb, *places, *arguments, env=env, cwd=folder, limit=600.0)


@pytest.fixture(scope="module", params=[(), ("--symlink-install",)], ids=["plain", "symlink"])
def built(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("workspace")
    copy_of_the_sources(folder)
    colcon("build", folder, *request.param)
    return folder


def environment_of(folder):
    return sourced(folder / "install" / "setup.sh", clean_environment(PATH=f"{BIN}:{os.environ['PATH']}"))


def test_every_executable_starts(built):
    check_executables(built / "install" / "nw_gear" / "lib" / "nw_gear", environment_of(built))


def test_the_index_and_the_shared_files_are_there(built):
    check_share(built / "install" / "nw_gear")


def test_the_ament_index_finds_the_package(built):
    code = "from ament_index_python import get_package_prefix as f; print(f('nw_gear'))"
    prefix = run(sys.executable, "-c", code, env=environment_of(built), cwd=built).strip()
    assert Path(prefix) == built / "install" / "nw_gear"


def test_the_modules_come_from_the_installation(built):
    code = "import nw_gear_sim.params as p; print(p.__file__)"
    found = Path(run(sys.executable, "-c", code, env=environment_of(built), cwd="/").strip())
    assert built in found.parents


def test_building_leaves_the_scripts_as_they_were(built):
    for script in (built / "sources" / "scripts").iterdir():
        if not script.suffix and script.is_file():
            assert script.read_text(encoding="utf-8").startswith("#!/bin/sh\n")


def test_colcon_test_runs_the_tests(tmp_path):
    copy_of_the_sources(tmp_path)
    colcon("build", tmp_path)
    colcon("test", tmp_path, "--return-code-on-test-failure", "--pytest-args", "test/common/test_quantities.py")
    found = re.search(r"Summary: (\d+) tests, (\d+) errors, (\d+) failures", colcon("test-result", tmp_path, "--all"))
    assert found is not None
    tests, errors, failures = (int(n) for n in found.groups())
    assert tests > 20
    assert (errors, failures) == (0, 0)
