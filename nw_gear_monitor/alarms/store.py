"""The file of a baseline: JSON that people can read, replaced as a whole, refused where anything is wrong with it.

    {"format": "nw_gear baseline", "version": 1, "identity": {..}, "rate_hz": 5120.0, "frozen": false,
     "features": [..],
     "bins": [{"speed": 66, "load": -96, "count": [..], "independent": [..], "mean": [..], "m2": [..],
      "above": [..], "m2_above": [..]}, ..],
     "sha256": ".."}

`identity` says of which machine it is and how its features were made; the numbers are of ln(x + offset), see `kernel`.
The checksum is over everything else, so that a flipped digit doesn't become a limit.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_monitor.alarms.baseline import Baseline, empty
from nw_gear_monitor.alarms.kernel import ABOVE, COUNT, INDEPENDENT, M2, M2_ABOVE, MEAN
from nw_gear_monitor.alarms.operating import Bin

FORMAT = "nw_gear baseline"
VERSION = 1
LARGEST = 1 << 28
"""Bytes of a file that are read at most: more is no baseline."""
ROWS = {"count": COUNT, "independent": INDEPENDENT, "mean": MEAN, "m2": M2, "above": ABOVE, "m2_above": M2_ABOVE}
KEYS = {"format", "version", "identity", "rate_hz", "frozen", "features", "bins", "sha256"}

Identity = Mapping[str, Any]


def write(path: Path, baseline: Baseline, identity: Identity) -> None:
    """Put a baseline in the place of the file, which at every moment is the old one or the new one as a whole.

    Raises:
        InputError: the file can't be written; the old one is left as it was.
    """
    text = encode(baseline, identity)
    temporary = None
    try:
        with tempfile.NamedTemporaryFile(
            "w", dir=path.parent, prefix=f".{path.name}.", suffix=".tmp", delete=False, encoding="utf-8"
        ) as file:
            temporary = file.name
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
        _sync_folder(path.parent)
    except OSError as error:
        if temporary is not None:
            with contextlib.suppress(OSError):
                os.unlink(temporary)
        raise InputError(str(path), "a file that can be written", error.strerror or str(error)) from None


def read(path: Path, identity: Identity) -> Baseline | None:
    """Read a baseline; None where there is no file.

    Args:
        path: of the file; it is only read.
        identity: of this machine; every entry has to be the same in the file.

    Raises:
        InputError: the file can't be read, is damaged, of another format or version, or of another machine.
    """
    try:
        with path.open("rb") as file:
            raw = file.read(LARGEST + 1)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise InputError(str(path), "a baseline that can be read", error.strerror or str(error)) from None
    if len(raw) > LARGEST:
        raise InputError(str(path), "a baseline", f"more than {LARGEST} bytes")
    return decode(str(path), raw, identity)


def encode(baseline: Baseline, identity: Identity) -> str:
    """The content of the file."""
    body: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "identity": dict(identity),
        "rate_hz": baseline.rate,
        "frozen": baseline.frozen,
        "features": baseline.names,
        "bins": [
            {"speed": key.speed, "load": key.load, **{name: block[row].tolist() for name, row in ROWS.items()}}
            for key, block in sorted(baseline.bins.items())
        ],
    }
    body["sha256"] = _checksum(body)
    lines = {key: json.dumps(value, allow_nan=False) for key, value in body.items() if key != "bins"}
    rows = ",\n".join("  " + json.dumps(entry, allow_nan=False) for entry in body["bins"])
    lines["bins"] = f"[\n{rows}\n ]" if rows else "[]"
    return "{\n" + ",\n".join(f" {json.dumps(key)}: {lines[key]}" for key in body) + "\n}\n"


def decode(place: str, raw: bytes, identity: Identity) -> Baseline:
    """Turn the content of a file back into a baseline; see `read`."""
    body = _body(place, raw)
    _check_identity(place, body["identity"], identity)
    try:
        return _baseline(body)
    except (TypeError, ValueError, KeyError, AttributeError, OverflowError) as error:
        raise InputError(place, "a baseline", f"bins that make no sense ({error})") from None


def _body(place: str, raw: bytes) -> dict[str, Any]:
    try:
        body = json.loads(raw.decode("utf-8"), parse_constant=_refuse)
    except (ValueError, RecursionError):
        raise InputError(place, "a baseline", "damaged: not JSON" if raw else "an empty file") from None
    if not isinstance(body, dict) or body.get("format") != FORMAT:
        raise InputError(place, f"a file whose format is {FORMAT!r}", "another kind of file")
    if body.get("version") != VERSION:
        raise InputError(f"{place}: version", str(VERSION), repr(body.get("version")))
    if set(body) != KEYS or not isinstance(body["identity"], dict):
        raise InputError(place, "the entries " + ", ".join(sorted(KEYS)), ", ".join(sorted(body)))
    if body.pop("sha256") != _checksum(body):
        raise InputError(place, "a content that fits its checksum", "damaged, or changed by hand")
    return body


def _check_identity(place: str, theirs: Mapping[str, Any], ours: Identity) -> None:
    for key in (*ours, *(key for key in theirs if key not in ours)):
        here, there = ours.get(key), theirs.get(key)
        if not _same(here, there):
            expected = f"{here} as of this machine" if key in ours else "nothing of that name"
            raise InputError(f"{place}: identity: {key}", expected, "nothing" if there is None else str(there))


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(_same(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, float) and isinstance(b, float):
        return math.isclose(a, b, rel_tol=1e-9)
    return bool(a == b)


def _baseline(body: Mapping[str, Any]) -> Baseline:
    baseline = Baseline()
    baseline.frozen = _of_kind(bool, body["frozen"])
    if body["rate_hz"] is not None:
        baseline.rate = _of_kind(float, body["rate_hz"])
        if not 0.0 < baseline.rate < math.inf:
            raise ValueError(f"{baseline.rate} Hz")
    names = [_of_kind(str, name) for name in _of_kind(list, body["features"])]
    baseline.columns(names)
    if len(baseline.names) != len(names):
        raise ValueError("a feature twice")
    for entry in _of_kind(list, body["bins"]):
        key = Bin(_of_kind(int, entry["speed"]), _of_kind(int, entry["load"]))
        block = empty(len(names))
        for name, row in ROWS.items():
            block[row] = _numbers(entry[name], len(names))
        if key in baseline.bins or not np.all(np.isfinite(block[list(ROWS.values())])):
            raise ValueError(f"bin {key.speed}, {key.load}")
        if np.any(block[[COUNT, INDEPENDENT, M2, ABOVE, M2_ABOVE]] < 0.0):
            raise ValueError(f"bin {key.speed}, {key.load}: below zero")
        baseline.bins[key] = block
    return baseline


def _numbers(values: Any, length: int) -> list[float]:
    if not isinstance(values, list) or len(values) != length or any(type(v) not in (int, float) for v in values):
        raise ValueError(f"not {length} numbers")
    return [float(value) for value in values]


def _of_kind(kind: type, value: Any) -> Any:
    if type(value) is not kind:
        raise TypeError(f"{value!r}")
    return value


def _checksum(body: Mapping[str, Any]) -> str:
    content = {key: body[key] for key in sorted(body)}
    return hashlib.sha256(json.dumps(content, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def _refuse(constant: str) -> float:
    raise ValueError(constant)


def _sync_folder(folder: Path) -> None:
    """Make the new name last through a loss of power."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
