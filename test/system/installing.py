"""Runs installed executables in the environment of an installation, as a person would after sourcing it."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path

from nw_gear_common.launcher import NODES
from test.system.processes import LIMIT, Probe, environment

ROOT = Path(__file__).resolve().parents[2]
LEFT_OUT = (".*", "*.egg-info", "__pycache__", "node_modules", "build", "install", "log", "runs")


def copy_of_the_sources(folder: Path) -> Path:
    """Copy the tree without what tools leave in it, so that building leaves nothing in the tree."""
    sources = folder / "sources"
    shutil.copytree(ROOT, sources, ignore=shutil.ignore_patterns(*LEFT_OUT))
    return sources


def clean_environment(**variables: str) -> dict[str, str]:
    """The environment of a fresh shell: nothing that the Python of this test has set for itself."""
    own = {"_ROS_WHEELS_BOOTSTRAP_COMPLETE", "LD_LIBRARY_PATH", "PYTHONPATH", "AMENT_PREFIX_PATH", "VIRTUAL_ENV"}
    return {**{k: v for k, v in environment().items() if k not in own}, **variables}


def run(*command: str | Path, env: Mapping[str, str], cwd: Path | None = None, limit: float = 300.0) -> str:
    """Run a command to its end; fails with its output unless it succeeds."""
    words = [str(part) for part in command]
    done = subprocess.run(words, env=dict(env), cwd=cwd, capture_output=True, text=True, check=False, timeout=limit)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def sourced(script: Path, env: Mapping[str, str]) -> dict[str, str]:
    """The environment after a shell sourced a script."""
    shown = run("bash", "-c", f". {script} && env -0", env=env)
    return dict(line.split("=", 1) for line in shown.split("\0") if "=" in line)


def check_executables(folder: Path, env: Mapping[str, str]) -> None:
    """Start every executable: nodes refuse a wrong parameter, the command line answers, one node runs and stops."""
    with tempfile.TemporaryDirectory() as elsewhere:
        assert run(folder / "nw_gear", "--version", env=env, cwd=Path(elsewhere)).startswith("nw_gear ")
        for node in NODES:
            assert os.access(folder / node, os.X_OK), f"{folder / node} can't be executed"
            refuses(folder / node, env, Path(elsewhere))
    stops(folder / "wind_node", env)


def refuses(executable: Path, env: Mapping[str, str], cwd: Path) -> None:
    """A wrong parameter gives one line and exit code 2."""
    command = [str(executable), "--ros-args", "-p", "no_such_parameter:=1"]
    done = subprocess.run(command, env=dict(env), cwd=cwd, capture_output=True, text=True, check=False, timeout=120.0)
    assert done.returncode == 2, done.stderr
    assert "no_such_parameter" in done.stderr
    assert "Traceback" not in done.stderr


def stops(executable: Path, env: Mapping[str, str]) -> None:
    """A node offers its topic to others and ends with exit code 0 on SIGINT."""
    process = subprocess.Popen([str(executable)], env=dict(env), stderr=subprocess.DEVNULL)
    try:
        with Probe() as probe:
            probe.wait_for_match("/nw_gear/wind_speed", publishers=1)
        process.send_signal(signal.SIGINT)
        assert process.wait(LIMIT) == 0
    finally:
        process.kill()
        process.wait(LIMIT)


def check_share(prefix: Path) -> None:
    """The ament index and the shared files, which `ros2 run` and `ros2 launch` look up."""
    share = prefix / "share"
    assert (share / "ament_index" / "resource_index" / "packages" / "nw_gear").is_file()
    assert (share / "nw_gear" / "package.xml").is_file()
    for kind, pattern in (("launch", "*.launch.py"), ("config", "*.yaml")):
        names = {path.name for path in (ROOT / kind).glob(pattern)}
        assert names
        assert names == {path.name for path in (share / "nw_gear" / kind).glob(pattern)}
