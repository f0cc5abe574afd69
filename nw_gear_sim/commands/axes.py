"""Axes that a user names on the command line: numbers, ranges, and parameters with either."""

from __future__ import annotations

import math

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array

MOST_POINTS = 1_000_000


def number(place: str, text: str) -> float:
    """Return a finite number.

    Raises:
        InputError: it is none; `place` names the option.
    """
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(place, "a finite number", repr(text))
    return value


def values(place: str, text: str) -> Array:
    """Return the numbers of `START:STOP:COUNT`, or of `A,B,C`.

    Raises:
        InputError: neither, or an empty range.
    """
    if ":" not in text:
        return np.array([number(place, part) for part in text.split(",")])
    parts = text.split(":")
    if len(parts) != 3:
        raise InputError(place, "START:STOP:COUNT", repr(text))
    start, stop = number(place, parts[0]), number(place, parts[1])
    count = int(parts[2]) if parts[2].isdecimal() else 0
    if not 2 <= count <= MOST_POINTS:
        raise InputError(place, f"a COUNT from 2 to {MOST_POINTS}", repr(parts[2]))
    if not stop > start:
        raise InputError(place, "a STOP above START", repr(text))
    return np.linspace(start, stop, count)


def axis(place: str, text: str) -> tuple[str, Array]:
    """Return name and numbers of `NAME=START:STOP:COUNT`, or of `NAME=A,B,C`.

    Raises:
        InputError: there is no `=`, or what follows can't be read.
    """
    name, equals, rest = text.partition("=")
    if not equals or not name:
        raise InputError(place, "NAME=START:STOP:COUNT or NAME=A,B,C", repr(text))
    return name.strip().replace("-", "_"), values(f"{place} {name}", rest)
