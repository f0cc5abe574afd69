"""Reads the description of somebody's machine (YAML): what the monitor has to know to watch it. See docs/foreign.md."""

from __future__ import annotations

import dataclasses
import re
import typing
from dataclasses import MISSING
from pathlib import Path
from typing import Any, TypeVar

import yaml

from nw_gear_common import yamlfile
from nw_gear_common.errors import InputError
from nw_gear_common.quantities import Quantity, check_value, quantities
from nw_gear_common.yamlfile import Leaf, Reader, join, unknown_key
from nw_gear_monitor.machine import Machine
from nw_gear_monitor.machinefile.build import build
from nw_gear_monitor.machinefile.entries import (
    BearingEntry,
    ChannelEntry,
    Entries,
    Gear,
    Reference,
    ShaftEntry,
    StageEntry,
)

Spec = TypeVar("Spec")

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*")
LISTS: dict[str, type] = {
    "stages": StageEntry,
    "shafts": ShaftEntry,
    "channels": ChannelEntry,
    "bearings": BearingEntry,
}
REQUIRED = ("name", "reference", "stages", "channels")
SIDEBANDS = Quantity("lines on either side of mesh lines at the speed of each shaft", minimum=0, maximum=6)
DEFAULT_SIDEBANDS = 2


def load(path: Path) -> Machine:
    """Read a machine from a file.

    Raises:
        InputError: it can't be read, or something in it is wrong (file, line and key are named).
    """
    return parse(yamlfile.text(path), str(path))


def parse(text: str, place: str) -> Machine:
    """Read a machine from a text.

    Args:
        text: YAML.
        place: its name for messages.

    Raises:
        InputError: no YAML, an unknown or missing key, a wrong type, unit or name, a number out of range, or entries
            that don't fit together.
    """
    with yamlfile.document(text, place) as (reader, root):
        if root is None:
            raise InputError(place, f"a value for {REQUIRED[0]}", "an empty file")
        return build(_entries(reader, root))


def _entries(reader: Reader, root: yaml.Node) -> Entries:
    found = reader.entries("", root)
    known = ["name", "sidebands", "reference", *LISTS]
    for key, node in found.items():
        if key not in known:
            raise unknown_key(reader.place("", node), key, known)
    for key in REQUIRED:
        if key not in found:
            raise InputError(reader.file, f"a value for {key}", "none")
    places = {"reference": reader.place("reference", found["reference"])}
    lists: dict[str, list[Any]] = {}
    for key, kind in LISTS.items():
        nodes = dict(enumerate(reader.items(key, found[key]) if key in found else []))
        places |= {f"{key}[{i}]": reader.place(f"{key}[{i}]", node) for i, node in nodes.items()}
        lists[key] = [_read(reader, node, kind, f"{key}[{i}]") for i, node in nodes.items()]
    sidebands = DEFAULT_SIDEBANDS
    if "sidebands" in found:
        sidebands = reader.leaf("sidebands", found["sidebands"], Leaf(int, SIDEBANDS))
    return Entries(
        name=reader.leaf("name", found["name"], Leaf(str, Quantity("name of the machine"))),
        sidebands=sidebands,
        reference=_read(reader, found["reference"], Reference, "reference"),
        stages=tuple(lists["stages"]),
        channels=tuple(lists["channels"]),
        shafts=tuple(lists["shafts"]),
        bearings=tuple(lists["bearings"]),
        places=places,
    )


def _read(reader: Reader, node: yaml.Node, cls: type[Spec], key: str) -> Spec:
    """Read a mapping into a dataclass of quantities and, where `Gear` is declared, gears."""
    own = {name: (kind, default, text) for name, kind, default, text in quantities(cls)}
    gears = [field.name for field in dataclasses.fields(cls) if field.name not in own]  # type: ignore[arg-type]
    values: dict[str, Any] = {}
    for name, child in reader.entries(key, node).items():
        if name in gears:
            values[name] = _read(reader, child, Gear, join(key, name))
        elif name in own:
            values[name] = _value(reader, child, join(key, name), own[name][0], own[name][2])
        else:
            raise unknown_key(reader.place(key, child), name, [*own, *gears])
    for name, (_kind, default, _text) in own.items():
        if name not in values and default is MISSING:
            raise InputError(reader.place(key, node), f"a value for {name}", "none")
    return cls(**values)


def _value(reader: Reader, node: yaml.Node, key: str, kind: Any, text: Quantity) -> Any:
    place = reader.place(key, node)
    if typing.get_origin(kind) is tuple:
        items = [str(reader.scalar(key, item)) for item in reader.items(key, node)]
        return tuple(_column(place, item) for item in check_value(place, items, kind, text))
    value = reader.leaf(key, node, Leaf(kind, text))
    last = key.rpartition(".")[2]
    if last in ("name", "shaft", "stage") and not _NAME.fullmatch(value):
        raise InputError(place, "a name of letters, digits and single underscores that begins with a letter", value)
    return _column(place, value) if last in ("column", "velocity", "phase") else value


def _column(place: str, value: str) -> str:
    if not value or "," in value or value == "time" or value != value.strip():
        raise InputError(place, "the name of a column, without commas, other than time", repr(value))
    return value
