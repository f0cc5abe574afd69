"""Reads one configuration file (YAML) into values in SI units by dotted key, and says what is wrong with it."""

from __future__ import annotations

import dataclasses
import difflib
import re
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from nw_gear_common.errors import InputError
from nw_gear_common.quantities import Quantity, check_value, optional, quantities
from nw_gear_sim import units
from nw_gear_sim.params import Configuration

_LEAF_KEYS = ("value", "unit", "source")

NONDIMENSIONAL = "nondimensional"
"""Section of a file whose values are pure numbers in the units of `nondimensional`, under the same keys."""


@dataclass(frozen=True)
class Leaf:
    """One parameter: its type and its declaration."""

    kind: Any
    description: Quantity


@dataclass(frozen=True)
class Scaled:
    """A value given in the units of the nondimensional form, with the place where it stands."""

    value: float
    place: str


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


def leaves() -> dict[str, Leaf]:
    """Return every parameter of `Configuration` by its dotted key, in the order of declaration."""
    return dict(_leaves(Configuration, ""))


def sections(cls: type) -> dict[str, type]:
    """Return the nested dataclasses of a dataclass of parameters by field name."""
    kinds = typing.get_type_hints(cls)
    return {f.name: kinds[f.name] for f in dataclasses.fields(cls) if dataclasses.is_dataclass(kinds[f.name])}


def read(path: Path, *, sources: bool = False) -> dict[str, Any]:
    """Read the values of a file (see `parse`).

    Raises:
        InputError: the file can't be read, besides what `parse` raises.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        got = error.strerror if isinstance(error, OSError) and error.strerror else "something that isn't UTF-8 text"
        raise InputError(str(path), "a readable YAML file", got) from error
    return parse(text, str(path), sources=sources)


def parse(text: str, place: str, *, sources: bool = False) -> dict[str, Any]:
    """Read the values of a configuration, partial or whole, as {dotted key: value in SI units}.

    A value is `{value: 45, unit: um, source: "..."}`, or `45 um`, or bare where it has no dimension. Those of the
    section `nondimensional`, which mirrors the others, are pure numbers and come out as `Scaled`.

    Args:
        text: YAML.
        place: the file's name for messages.
        sources: whether every value must name its source.

    Raises:
        InputError: no YAML, unknown or repeated key, wrong type or unit, missing unit, out of range, missing source.
    """
    loader = _Loader(text)
    try:
        root = loader.get_single_node()
        if root is None:
            return {}
        return _once(place, _section(_Reader(loader, place, sources), root, Configuration, ""))
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


@dataclass(frozen=True)
class _Reader:
    loader: _Loader
    file: str
    sources: bool

    def place(self, key: str, node: yaml.Node) -> str:
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
                raise InputError(self.place(_join(key, name.value), name), "each key once", "it twice")
            found[name.value] = value
        return found

    def scalar(self, key: str, node: yaml.Node) -> Any:
        if not isinstance(node, yaml.ScalarNode):
            raise InputError(self.place(key, node), "one value", _shown(node))
        try:
            return self.loader.construct_object(node)
        except ValueError as error:
            raise InputError(self.place(key, node), "one value", _shown(node)) from error


def _leaves(cls: type, prefix: str) -> Iterator[tuple[str, Leaf]]:
    for name, kind, _default, description in quantities(cls):
        yield _join(prefix, name), Leaf(kind, description)
    for name, section in sections(cls).items():
        yield from _leaves(section, _join(prefix, name))


def _section(reader: _Reader, node: yaml.Node, cls: type, prefix: str) -> Iterator[tuple[str, Any]]:
    own = {name: Leaf(kind, description) for name, kind, _default, description in quantities(cls)}
    nested = sections(cls)
    for name, child in reader.entries(prefix, node).items():
        key = _join(prefix, name)
        if name in own:
            yield key, _leaf(reader, child, key, own[name])
        elif name in nested:
            yield from _section(reader, child, nested[name], key)
        elif key == NONDIMENSIONAL:
            yield from _scaled_section(reader, child, Configuration, "")
        else:
            raise unknown_key(reader.place(prefix, child), name, [*own, *nested])


def _once(place: str, found: Iterator[tuple[str, Any]]) -> dict[str, Any]:
    """Return the values by key, refusing a key that stands in the section `nondimensional` and outside of it."""
    values: dict[str, Any] = {}
    for key, value in found:
        if key in values:
            raise InputError(f"{place}: {key}", "each key once", f"it under {NONDIMENSIONAL} too")
        values[key] = value
    return values


def scaled(place: str, value: Any) -> Scaled:
    """Return a value of the nondimensional form; raises InputError where it isn't a number."""
    return Scaled(check_value(place, value, float, Quantity("pure number")), place)


def _scaled_section(reader: _Reader, node: yaml.Node, cls: type, prefix: str) -> Iterator[tuple[str, Scaled]]:
    own, nested = [name for name, *_ in quantities(cls)], sections(cls)
    for name, child in reader.entries(_join(NONDIMENSIONAL, prefix), node).items():
        key = _join(prefix, name)
        if name in nested:
            yield from _scaled_section(reader, child, nested[name], key)
        elif name in own:
            place = _join(NONDIMENSIONAL, key)
            yield key, scaled(reader.place(place, child), reader.scalar(place, child))
        else:
            raise unknown_key(reader.place(_join(NONDIMENSIONAL, prefix), child), name, [*own, *nested])


def _leaf(reader: _Reader, node: yaml.Node, key: str, leaf: Leaf) -> Any:
    place = reader.place(key, node)
    unit: str | None = None
    if isinstance(node, yaml.MappingNode):
        entries = reader.entries(key, node)
        for name, child in entries.items():
            if name not in _LEAF_KEYS:
                raise unknown_key(reader.place(key, child), name, list(_LEAF_KEYS))
        if "value" not in entries:
            raise InputError(place, "a value", "none")
        value = reader.scalar(key, entries["value"])
        unit = None if "unit" not in entries else str(reader.scalar(f"{key}.unit", entries["unit"]))
        source = reader.scalar(f"{key}.source", entries["source"]) if "source" in entries else None
    else:
        value, source = reader.scalar(key, node), None
        if isinstance(value, str) and optional(leaf.kind)[0] in (int, float):
            parts = units.split(value)
            value, unit = (value, None) if parts is None else parts
    if reader.sources and not (isinstance(source, str) and source.strip()):
        raise InputError(place, "a source: where this value comes from", "none" if source is None else repr(source))
    return _in_si(place, value, unit, leaf)


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


def _join(prefix: str, name: str) -> str:
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
