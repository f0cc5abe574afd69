"""A number declared once: default, unit, bounds, choices and text in the field of a frozen dataclass.

YAML keys, ROS parameter descriptors and the tables of the README derive from these declarations; `check_value` is the
one place where values are held against them.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import sys
import types
import typing
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from nw_gear_common.errors import InputError

_KEY = "quantity"


@dataclass(frozen=True)
class Quantity:
    """What is known about one field besides its type.

    Attributes:
        text: one sentence for people.
        unit: SI unit, "" where dimensionless or not a number.
        minimum, maximum: inclusive bounds (None = none).
        choices: the accepted strings (None = any).
        live: whether it may change while a node runs.
    """

    text: str
    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None
    choices: tuple[str, ...] | None = None
    live: bool = False

    def expected(self, kind: type) -> str:
        """Say in words what is accepted."""
        if self.choices is not None:
            return "one of " + ", ".join(self.choices)
        words = {float: "a number", int: "a whole number", bool: "true or false", str: "a text"}.get(kind, "a list")
        unit = f" in {self.unit}" if self.unit else ""
        low = "" if self.minimum is None else f" >= {self.minimum:g}"
        high = "" if self.maximum is None else f" <= {self.maximum:g}"
        return words + unit + (" and".join(part for part in (low, high) if part))


def quantity(
    default: Any,
    text: str,
    unit: str = "",
    *,
    minimum: float | None = None,
    maximum: float | None = None,
    choices: tuple[str, ...] | None = None,
    live: bool = False,
) -> Any:
    """Declare a dataclass field that carries its own description (see `Quantity`). `dataclasses.MISSING` = required."""
    return dataclasses.field(default=default, metadata={_KEY: Quantity(text, unit, minimum, maximum, choices, live)})


def quantities(owner: Any) -> Iterator[tuple[str, type, Any, Quantity]]:
    """Iterate over (name, type, default, description) of the declared fields of a dataclass or an instance of one."""
    yield from _declared(owner if isinstance(owner, type) else type(owner))


@functools.cache  # the hints are compiled from text each time
def _declared(cls: type) -> tuple[tuple[str, type, Any, Quantity], ...]:
    kinds = typing.get_type_hints(cls)
    fields = [field for field in dataclasses.fields(cls) if _KEY in field.metadata]
    return tuple((field.name, kinds[field.name], field.default, field.metadata[_KEY]) for field in fields)


def optional(kind: Any) -> tuple[Any, bool]:
    """Split the type of a field into (type without None, whether None is accepted)."""
    if typing.get_origin(kind) is not types.UnionType:
        return kind, False
    members = [member for member in typing.get_args(kind) if member is not type(None)]
    return members[0], len(members) < len(typing.get_args(kind))


def check_value(place: str, value: Any, kind: Any, description: Quantity) -> Any:
    """Hold one value against its declaration and return it, whole numbers turned into floats where a float is declared.

    None passes where the declared type is `<type> | None`.

    Raises:
        InputError: wrong type, not finite, out of bounds, or not among the choices.
    """
    kind, may_be_none = optional(kind)
    if value is None and may_be_none:
        return None
    if typing.get_origin(kind) is tuple:
        member = typing.get_args(kind)[0]
        if not isinstance(value, list | tuple):
            raise InputError(place, f"a list; each {description.expected(member)}", repr(value))
        return tuple(check_value(f"{place}[{i}]", item, member, description) for i, item in enumerate(value))
    wanted = description.expected(kind)
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value) if abs(value) <= sys.float_info.max else math.inf
    if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
        raise InputError(place, wanted, repr(value))
    if isinstance(value, int | float):
        outside = isinstance(value, float) and not math.isfinite(value)
        outside |= description.minimum is not None and value < description.minimum
        outside |= description.maximum is not None and value > description.maximum
        if outside:
            raise InputError(place, wanted, f"{value:g}" if isinstance(value, float) else str(value))
    if description.choices is not None and value not in description.choices:
        raise InputError(place, wanted, repr(value))
    return value
