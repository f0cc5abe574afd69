"""Where a recording comes from: the command line, the versions of what made it, and when."""

from __future__ import annotations

import json
import platform
import shlex
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

import nw_gear_common

PACKAGES = ("numpy", "scipy", "numba", "mcap", "ros-jazzy-rclpy", "ros-jazzy-rmw-fastrtps-cpp")


def versions() -> dict[str, str]:
    """Versions of this project, of Python and of the packages that results depend on."""
    found = {"nw_gear": nw_gear_common.__version__, "python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:  # a full ROS installation has no Python package of that name
            continue
    return found


def run_record(command_line: Sequence[str], given: str) -> dict[str, str]:
    """The metadata record `nw_gear.run`.

    Args:
        command_line: of the recorder.
        given: text handed over by whoever started the run, empty for none.
    """
    record = {
        "command_line": shlex.join(command_line),
        "versions": json.dumps(versions()),
        "platform": platform.platform(),
        "created": datetime.now(tz=UTC).isoformat(timespec="milliseconds"),
    }
    return {**record, "provenance": given} if given else record
