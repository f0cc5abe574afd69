"""Message definitions and type hashes of installed ROS packages, put together as rosbag2 stores them.

The definition of a type is followed by those of all types in its fields, each after a line of 80 equal signs and
`MSG: package/Type`. Files come from share/<package>/msg of the ament prefixes, or of this Python installation where
ROS came as wheels. A type without a file there is described from its Python class.
"""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from nw_gear_common.errors import InputError

SEPARATOR = "=" * 80
_NUMBERS = ("float32", "float64", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)))
PRIMITIVES = frozenset(("bool", "byte", "char", "string", "wstring", *_NUMBERS))
_FIELD = re.compile(r"^\s*([A-Za-z][\w/]*)(?:<=\d+)?\s*(?:\[[^\]]*\])?\s+[A-Za-z]\w*")
_TYPE = re.compile(r"[A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*){2}")
_IDL_WORDS = {"double": "float64", "float": "float32", "boolean": "bool", "octet": "byte"}
_SEQUENCE = re.compile(r"^sequence<(.+?)(?:, (\d+))?>$")
_ARRAY = re.compile(r"^(.+)\[(\d+)\]$")
_BOUNDED = re.compile(r"^(w?string)<(\d+)>$")


@dataclass(frozen=True)
class Definition:
    """What a recording has to know about a type: its text with all dependencies, and its RIHS01 hash ("" unknown)."""

    text: str
    type_hash: str


def shares() -> list[Path]:
    """Folders `share` in which packages can be found, the first one first."""
    prefixes = [p for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    return [Path(prefix) / "share" for prefix in (*prefixes, sys.prefix)]


def define(kind: str, fields: Mapping[str, str] | None = None) -> Definition:
    """Put together the definition of a type such as `std_msgs/msg/String`.

    Args:
        kind: the type's full name.
        fields: of its Python class (name to IDL type), used where there is no file.

    Raises:
        InputError: there is no description of the type or of one that it depends on.
    """
    package, _, rest = kind.partition("/")
    name = rest.rpartition("/")[2]
    short = f"{package}/{name}"
    text = _own_text(short, rest) if fields is None else _own_text(short, rest) or from_fields(fields)
    if text is None:
        raise InputError(f"type {kind}", f"a file share/{package}/{rest}.msg", "none in any prefix")
    parts, known = [text], {short}
    waiting = dependencies(text, package)
    while waiting:
        dependency = waiting.pop(0)
        if dependency in known:
            continue
        known.add(dependency)
        below = _own_text(dependency, f"msg/{dependency.partition('/')[2]}")
        if below is None:
            raise InputError(f"type {kind}", f"a definition of {dependency}, which it contains", "none in any prefix")
        parts.append(f"{SEPARATOR}\nMSG: {dependency}\n{below}")
        waiting += dependencies(below, dependency.partition("/")[0])
    return Definition("\n".join(part.rstrip("\n") + "\n" for part in parts).rstrip("\n") + "\n", type_hash(kind))


def dependencies(text: str, package: str) -> list[str]:
    """Types `package/Type` in the fields of a definition, in order; names without a package belong to `package`."""
    found = []
    for line in text.splitlines():
        match = _FIELD.match(line)
        if match and match[1] not in PRIMITIVES:
            parts = match[1].split("/")
            found.append(f"{parts[0]}/{parts[-1]}" if len(parts) > 1 else f"{package}/{match[1]}")
    return found


def type_hash(kind: str) -> str:
    """RIHS01 hash of a type from the file that describes it, "" where there is none."""
    if not _TYPE.fullmatch(kind):
        return ""
    package, _, rest = kind.partition("/")
    for share in shares():
        path = share / package / f"{rest}.json"
        if path.is_file():
            hashes = json.loads(path.read_text(encoding="utf-8"))["type_hashes"]
            return next((str(h["hash_string"]) for h in hashes if h["type_name"] == kind), "")
    return ""


def from_fields(fields: Mapping[str, str]) -> str:
    """The definition of a type from the fields of its Python class: without constants, defaults and comments."""
    return "".join(f"{_msg_type(kind)} {name}\n" for name, kind in fields.items())


def _msg_type(kind: str) -> str:
    """Turn a type of IDL (`sequence<double, 3>`) into one of msg (`float64[<=3]`)."""
    if match := _SEQUENCE.match(kind):
        return f"{_msg_type(match[1])}[{'<=' + match[2] if match[2] else ''}]"
    if match := _ARRAY.match(kind):
        return f"{_msg_type(match[1])}[{match[2]}]"
    if match := _BOUNDED.match(kind):
        return f"{match[1]}<={match[2]}"
    return _IDL_WORDS.get(kind, kind)


def _own_text(short: str, rest: str) -> str | None:
    package = short.partition("/")[0]
    if not _TYPE.fullmatch(f"{package}/{rest}"):
        return None
    for share in shares():
        path = share / package / f"{rest}.msg"
        if path.is_file():
            return path.read_text(encoding="utf-8")
    return None
