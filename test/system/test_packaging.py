"""What is installed, as it is declared: package.xml, setup.py and the launcher say the same."""

import re
import subprocess
import sys
import tomllib
from importlib.metadata import entry_points
from pathlib import Path
from xml.etree import ElementTree

import pytest

import nw_gear_common
from nw_gear_common.launcher import NODES
from test.system.installing import ROOT

EXECUTABLES = {*NODES, "nw_gear"}


def test_versions_agree():
    package = ElementTree.parse(ROOT / "package.xml").getroot()
    assert package.findtext("version") == nw_gear_common.__version__
    assert nw_gear_common.__version__ in (ROOT / "CHANGELOG.rst").read_text(encoding="utf-8")


def test_the_package_is_ament_python():
    package = ElementTree.parse(ROOT / "package.xml").getroot()
    assert package.findtext("name") == "nw_gear"
    assert package.findtext("export/build_type") == "ament_python"
    assert (ROOT / "resource" / "nw_gear").is_file()


def test_every_executable_is_a_console_script():
    scripts = {p.name: p.value for p in entry_points(group="console_scripts") if p.value.startswith("nw_gear_common.")}
    assert scripts == {name: f"nw_gear_common.launcher:{name}" for name in EXECUTABLES}


def test_every_executable_has_a_script_for_ros2_run():
    texts = set()
    for name in EXECUTABLES:
        script = ROOT / "scripts" / name
        assert script.stat().st_mode & 0o111, f"{script} can't be executed"
        texts.add(script.read_text(encoding="utf-8"))
    assert len(texts) == 1


@pytest.mark.parametrize("name", sorted(EXECUTABLES))
def test_the_scripts_of_the_environment_are_installed(name):
    assert (Path(sys.executable).parent / name).is_file()


def test_every_direct_requirement_is_pinned_and_locked():
    locked = (ROOT / "requirements" / "lock.txt").read_text(encoding="utf-8").splitlines()
    for name in ("runtime.txt", "development.txt"):
        for line in (ROOT / "requirements" / name).read_text(encoding="utf-8").splitlines():
            if line and not line.startswith("#"):
                requirement, reason = line.split("#")
                assert reason.strip()
                assert requirement.strip().lower().replace("_", "-") in locked


def test_the_lock_names_versions_and_nothing_else():
    for line in (ROOT / "requirements" / "lock.txt").read_text(encoding="utf-8").splitlines()[1:]:
        assert re.fullmatch(r"[a-z0-9.-]+==[A-Za-z0-9.+!]+", line), line


def test_setuptools_stays_below_the_version_that_breaks_symlink_installs():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert settings["build-system"]["requires"] == ["setuptools>=65,<80"]


def test_generated_files_are_up_to_date():
    command = [sys.executable, ROOT / "scripts" / "generate.py", "--check"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
