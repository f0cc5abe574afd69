"""Checkpoints on disk: everything that a run's future depends on, in one file that is complete or isn't there.

An NPZ archive: numbers and texts as JSON under `meta`, arrays beside it. The resolved configuration is in it, so that a
run is continued with the same gearbox only.
"""

from __future__ import annotations

import contextlib
import json
import os
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from nw_gear_common.errors import InputError

FORMAT = "nw_gear checkpoint 1"


def write_checkpoint(path: Path, configuration: str, values: Mapping[str, Any]) -> None:
    """Write a checkpoint; an older one is replaced at once or not at all.

    Args:
        path: of the file.
        configuration: resolved, as YAML.
        values: arrays, plain numbers, texts and dictionaries of them.

    Raises:
        InputError: the file can't be written.
    """
    arrays: dict[str, Any] = {name: value for name, value in values.items() if isinstance(value, np.ndarray)}
    plain = {name: value for name, value in values.items() if name not in arrays}
    meta = json.dumps({"format": FORMAT, "configuration": configuration, "values": plain})
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("wb") as file:
            np.savez(file, meta=np.array(meta), **arrays)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        raise InputError(str(path), "a file that can be written", error.strerror or str(error)) from error


def read_checkpoint(path: Path, configuration: str) -> dict[str, Any]:
    """Read a checkpoint back.

    Args:
        path: of the file.
        configuration: of the run that goes on, resolved, as YAML.

    Raises:
        InputError: no such file, not a checkpoint, damaged, or of another configuration; the first difference is named.
    """
    if not path.is_file():
        raise InputError(str(path), "a checkpoint", "a folder" if path.is_dir() else "no such file")
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            contents = {name: archive[name] for name in archive.files}
        meta = json.loads(str(contents.pop("meta")))
        kind, written, plain = meta["format"], meta["configuration"], dict(meta["values"])
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(str(path), "a checkpoint", "a damaged or foreign file") from error
    if kind != FORMAT:
        raise InputError(str(path), FORMAT, str(kind))
    _refuse_other(str(path), written, configuration)
    return {**plain, **contents}


def _refuse_other(place: str, written: str, configuration: str) -> None:
    before, now = _flat(yaml.safe_load(written)), _flat(yaml.safe_load(configuration))
    for key in sorted(before.keys() | now.keys()):
        if before.get(key) != now.get(key):
            raise InputError(f"{place}: {key}", str(now.get(key, "nothing")), str(before.get(key, "nothing")))


def _flat(values: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    out: dict[str, Any] = {}
    for name, value in values.items():
        if isinstance(value, Mapping):
            out |= _flat(value, f"{prefix}{name}.")
        else:
            out[prefix + name] = value
    return out
