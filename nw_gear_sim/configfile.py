"""Reads one configuration file (YAML) into values in SI units by dotted key, and says what is wrong with it."""

from __future__ import annotations

import dataclasses
import functools
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import yaml

from nw_gear_common import yamlfile
from nw_gear_common.errors import InputError
from nw_gear_common.quantities import Quantity, check_value, quantities
from nw_gear_common.yamlfile import Leaf, Reader, check_leaf, join, unknown_key
from nw_gear_sim.params import Configuration

__all__ = ["Leaf", "Scaled", "check_leaf", "leaves", "parse", "read", "scaled", "sections", "unknown_key"]

NONDIMENSIONAL = "nondimensional"
"""Section of a file whose values are pure numbers in the units of `nondimensional`, under the same keys."""


@dataclass(frozen=True)
class Scaled:
    """A value given in the units of the nondimensional form, with the place where it stands."""

    value: float
    place: str


@functools.cache
def leaves() -> Mapping[str, Leaf]:
    """Return every parameter of `Configuration` by its dotted key, in the order of declaration."""
    return MappingProxyType(dict(_leaves(Configuration, "")))


def sections(cls: type) -> Mapping[str, type]:
    """Return the nested dataclasses of a dataclass of parameters by field name."""
    return _sections(cls)


@functools.cache
def _sections(cls: type) -> Mapping[str, type]:
    kinds = typing.get_type_hints(cls)
    nested = {f.name: kinds[f.name] for f in dataclasses.fields(cls) if dataclasses.is_dataclass(kinds[f.name])}
    return MappingProxyType(nested)


def read(path: Path, *, sources: bool = False) -> dict[str, Any]:
    """Read the values of a file (see `parse`).

    Raises:
        InputError: the file can't be read, besides what `parse` raises.
    """
    return parse(yamlfile.text(path), str(path), sources=sources)


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
    with yamlfile.document(text, place, sources=sources) as (reader, root):
        return {} if root is None else _once(place, _section(reader, root, Configuration, ""))


def _leaves(cls: type, prefix: str) -> Iterator[tuple[str, Leaf]]:
    for name, kind, _default, description in quantities(cls):
        yield join(prefix, name), Leaf(kind, description)
    for name, section in sections(cls).items():
        yield from _leaves(section, join(prefix, name))


def _section(reader: Reader, node: yaml.Node, cls: type, prefix: str) -> Iterator[tuple[str, Any]]:
    own = {name: Leaf(kind, description) for name, kind, _default, description in quantities(cls)}
    nested = sections(cls)
    for name, child in reader.entries(prefix, node).items():
        key = join(prefix, name)
        if name in own:
            yield key, reader.leaf(key, child, own[name])
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


def _scaled_section(reader: Reader, node: yaml.Node, cls: type, prefix: str) -> Iterator[tuple[str, Scaled]]:
    own, nested = [name for name, *_ in quantities(cls)], sections(cls)
    for name, child in reader.entries(join(NONDIMENSIONAL, prefix), node).items():
        key = join(prefix, name)
        if name in nested:
            yield from _scaled_section(reader, child, nested[name], key)
        elif name in own:
            place = join(NONDIMENSIONAL, key)
            yield key, scaled(reader.place(place, child), reader.scalar(place, child))
        else:
            raise unknown_key(reader.place(join(NONDIMENSIONAL, prefix), child), name, [*own, *nested])
