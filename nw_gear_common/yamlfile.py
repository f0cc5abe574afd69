"""Strict reading of YAML: plain values, each key once, numbers with units; errors name file, line and key."""

from __future__ import annotations

import contextlib
import difflib
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from nw_gear_common import units
from nw_gear_common.errors import InputError
from nw_gear_common.quantities import Quantity, check_value, optional

_LEAF_KEYS = ("value", "unit", "source")


@dataclass(frozen=True)
class Leaf:
    """One parameter: its type and its declaration."""

    kind: Any
    description: Quantity


class _Loader(yaml.SafeLoader):
    """YAML whose plain scalars are null, true, false, whole numbers, numbers (1e-5 too) or texts, and nothing else."""


_Loader.yaml_implicit_resolvers = {}
_NUMBER = r"^[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?$|^[-+]?\.(?:inf|nan)$"
for _tag, _pattern, _first in (
    ("null", r"^(?:~|null|)$", ["~", "n", ""]),
    ("bool", r"^(?:true|false)$", list("tf")),
    ("int", r"^[-+]?[0-9]+$", list("-+0123456789")),
    ("float", _NUMBER, list("-+.0123456789")),
):
    _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", re.compile(_pattern), _first)


@dataclass(frozen=True)
class Reader:
    """Takes the nodes of one document apart and says where something is wrong.

    Attributes:
        loader: turns scalars into values.
        file: its name for messages.
        sources: whether every value must name its source.
    """

    loader: yaml.SafeLoader
    file: str
    sources: bool = False

    def place(self, key: str, node: yaml.Node) -> str:
        """Return file, line and key for messages."""
        return f"{self.file}, line {node.start_mark.line + 1}" + (f": {key}" if key else "")

    def entries(self, key: str, node: yaml.Node) -> Mapping[str, yaml.Node]:
        """Return the entries of a mapping node, refusing what isn't one."""
        if not isinstance(node, yaml.MappingNode):
            raise InputError(self.place(key, node), "a mapping of keys to values", _shown(node))
        found: dict[str, yaml.Node] = {}
        for name, value in node.value:
            if not isinstance(name, yaml.ScalarNode):
                raise InputError(self.place(key, name), "a plain key", _shown(name))
            if name.value in found:
                raise InputError(self.place(join(key, name.value), name), "each key once", "it twice")
            found[name.value] = value
        return found

    def items(self, key: str, node: yaml.Node) -> list[yaml.Node]:
        """Return the items of a list, refusing what isn't one."""
        if not isinstance(node, yaml.SequenceNode):
            raise InputError(self.place(key, node), "a list", _shown(node))
        return list(node.value)

    def scalar(self, key: str, node: yaml.Node) -> Any:
        """Return the value of a plain node."""
        if not isinstance(node, yaml.ScalarNode):
            raise InputError(self.place(key, node), "one value", _shown(node))
        try:
            return self.loader.construct_object(node)
        except ValueError as error:
            raise InputError(self.place(key, node), "one value", _shown(node)) from error

    def leaf(self, key: str, node: yaml.Node, leaf: Leaf) -> Any:
        """Return a value in SI units: `{value: 45, unit: um, source: ".."}`, or `45 um`, or bare without dimension."""
        place = self.place(key, node)
        unit: str | None = None
        if isinstance(node, yaml.MappingNode):
            entries = self.entries(key, node)
            for name, child in entries.items():
                if name not in _LEAF_KEYS:
                    raise unknown_key(self.place(key, child), name, list(_LEAF_KEYS))
            if "value" not in entries:
                raise InputError(place, "a value", "none")
            value = self.scalar(key, entries["value"])
            unit = None if "unit" not in entries else str(self.scalar(f"{key}.unit", entries["unit"]))
            source = self.scalar(f"{key}.source", entries["source"]) if "source" in entries else None
        else:
            value, source = self.scalar(key, node), None
            if isinstance(value, str) and optional(leaf.kind)[0] in (int, float):
                parts = units.split(value)
                value, unit = (value, None) if parts is None else parts
        if self.sources and not (isinstance(source, str) and source.strip()):
            raise InputError(place, "a source: where this value comes from", "none" if source is None else repr(source))
        return _in_si(place, value, unit, leaf)


def text(path: Path) -> str:
    """Return the text of a file.

    Raises:
        InputError: it can't be read, or isn't UTF-8.
    """
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        got = error.strerror if isinstance(error, OSError) and error.strerror else "something that isn't UTF-8 text"
        raise InputError(str(path), "a readable YAML file", got) from error


@contextlib.contextmanager
def document(text: str, place: str, *, sources: bool = False) -> Iterator[tuple[Reader, yaml.Node | None]]:
    """Give a reader and the root node (None for an empty document) while the document is open.

    Args:
        text: YAML.
        place: the file's name for messages.
        sources: whether every value must name its source.

    Raises:
        InputError: no YAML.
    """
    loader = _Loader(text)
    try:
        yield Reader(loader, place, sources), loader.get_single_node()
    except yaml.YAMLError as error:
        raise InputError(_yaml_place(place, error), "a YAML document", _yaml_problem(error)) from error
    except RecursionError as error:
        raise InputError(place, "a YAML document", "values nested without end") from error
    finally:
        loader.dispose()


def check_leaf(place: str, value: Any, leaf: Leaf) -> Any:
    """Hold a value in SI units against the declaration of its parameter and return it."""
    return check_value(place, value, leaf.kind, leaf.description)


def unknown_key(place: str, key: str, known: list[str]) -> InputError:
    """Return the error for a key that doesn't exist, with the nearest one that does."""
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.5)
    hint = f"a known key (nearest: {near[0]!r})" if near else "one of " + ", ".join(known)
    return InputError(place, hint, f"{key!r}")


def _in_si(place: str, value: Any, unit: str | None, leaf: Leaf) -> Any:
    """Convert a value to SI and check it; the message shows it as it was written."""
    declared = leaf.description.unit
    if not isinstance(value, int | float) or isinstance(value, bool):
        return check_leaf(place, value, leaf)
    choices = ", ".join(units.accepted(declared))
    if unit is None and declared:
        raise InputError(place, f"a number with its unit ({choices})", f"{value} without unit")
    if unit is not None and unit not in units.accepted(declared):
        wanted = f"a number in {choices}" if declared else "a number without unit"
        raise InputError(place, wanted, f"{value} {unit}")
    if unit in (None, declared, "1"):
        return check_leaf(place, value, leaf)
    try:
        return check_leaf(place, units.to_si(value, unit, declared), leaf)
    except InputError as error:
        raise InputError(place, error.expected, f"{value} {unit}") from error


def join(prefix: str, name: str) -> str:
    """Return a dotted key."""
    return f"{prefix}.{name}" if prefix else name


def _shown(node: yaml.Node) -> str:
    if isinstance(node, yaml.ScalarNode):
        return repr(node.value) if node.value else "nothing"
    return "a mapping" if isinstance(node, yaml.MappingNode) else "a list"


def _yaml_place(place: str, error: yaml.YAMLError) -> str:
    mark = getattr(error, "problem_mark", None)
    return place if mark is None else f"{place}, line {mark.line + 1}"


def _yaml_problem(error: yaml.YAMLError) -> str:
    problem = getattr(error, "problem", None) or getattr(error, "reason", None) or "something else"
    return " ".join(str(problem).split())
