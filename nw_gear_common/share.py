"""Finds the data files that belong to this package: configuration, presets, launch files.

Wheels of ROS 2 set no AMENT_PREFIX_PATH, so that the ament index is only the first of three places.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from nw_gear_common.errors import InputError

PACKAGE = "nw_gear"


def _places() -> list[Path]:
    prefixes = [Path(p) for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    source_tree = Path(__file__).resolve().parent.parent
    return [*(p / "share" / PACKAGE for p in prefixes), source_tree, Path(sys.prefix) / "share" / PACKAGE]


def find(name: str) -> Path:
    """Return the path of a data file, for instance `config/gearbox.yaml`.

    Raises:
        InputError: the file is in none of the places where this package can be installed.
    """
    places = _places()
    for place in places:
        if (place / name).is_file():
            return place / name
    raise InputError(name, "a file of the package nw_gear", "none in " + ", ".join(str(p) for p in places))
