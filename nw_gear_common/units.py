"""Units a configuration file may use for each SI unit; a number is read as number * numerator / denominator."""

from __future__ import annotations

import math
import re
from fractions import Fraction

UNITS: dict[str, dict[str, tuple[float, int]]] = {
    "": {"1": (1, 1), "%": (1, 100)},
    "m": {"m": (1, 1), "cm": (1, 100), "mm": (1, 1_000), "um": (1, 1_000_000)},
    "rad": {"rad": (1, 1), "deg": (math.pi, 180)},
    "kg": {"kg": (1, 1), "t": (1_000, 1)},
    "s": {"s": (1, 1), "ms": (1, 1_000), "us": (1, 1_000_000), "min": (60, 1)},
    "N/m": {"N/m": (1, 1), "N/mm": (1_000, 1), "kN/mm": (1_000_000, 1), "N/um": (1_000_000, 1)},
    "N m": {"N m": (1, 1), "kN m": (1_000, 1), "MN m": (1_000_000, 1)},
    "N m/rad": {"N m/rad": (1, 1), "kN m/rad": (1_000, 1)},
    "N s/m": {"N s/m": (1, 1), "kN s/m": (1_000, 1)},
    "rad/s": {"rad/s": (1, 1), "r/min": (2 * math.pi, 60), "Hz": (2 * math.pi, 1)},
    "m/s": {"m/s": (1, 1), "km/h": (10, 36)},
    "m/s^2": {"m/s^2": (1, 1)},
    "W": {"W": (1, 1), "kW": (1_000, 1), "MW": (1_000_000, 1)},
    "Pa": {"Pa": (1, 1), "MPa": (1_000_000, 1), "GPa": (1_000_000_000, 1)},
}
"""Accepted units by SI unit. An SI unit that isn't listed is accepted as itself."""

_NUMBER_WITH_UNIT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\D.*?)\s*")


def accepted(unit: str) -> tuple[str, ...]:
    """Return the units accepted where `unit` (SI) is declared."""
    return tuple(UNITS.get(unit, (unit,)))


def to_si(value: float, given: str, unit: str) -> float:
    """Convert a value from the unit `given` to the SI unit `unit`; correctly rounded for decimal multiples.

    Raises:
        KeyError: `given` is no accepted unit.
    """
    if given == unit or not math.isfinite(value):
        return value
    numerator, denominator = UNITS[unit][given]
    if isinstance(numerator, int):
        return float(Fraction(repr(value)) * numerator / denominator)
    return value * numerator / denominator


def split(text: str) -> tuple[float, str] | None:
    """Take a text such as `45 um` apart; None where it isn't a number with a unit."""
    match = _NUMBER_WITH_UNIT.fullmatch(text)
    return None if match is None else (float(match[1]), match[2])
