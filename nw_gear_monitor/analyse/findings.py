"""A collection of numbers with names, where a number that can't be given leaves its reason instead."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from nw_gear_common.errors import InputError


class Findings:
    """Numbers found so far.

    Attributes:
        values: number by name, None where there is none.
        notes: why, by name.
    """

    def __init__(self) -> None:
        self.values: dict[str, float | None] = {}
        self.notes: dict[str, str] = {}

    def add(self, names: tuple[str, ...], function: Callable[[], Mapping[str, float]]) -> None:
        """Call a function that returns these numbers; where it refuses, note its reason for the first of them."""
        try:
            found = function()
        except InputError as error:
            self.refuse(names, f"expected {error.expected}, got {error.got}")
            return
        for name in names:
            self.put(name, found[name])

    def put(self, name: str, value: float) -> None:
        """Take in a number; one that isn't finite doesn't count as one."""
        self.values[name] = float(value) if math.isfinite(value) else None
        if self.values[name] is None:
            self.notes[name] = "outside the range of numbers"

    def refuse(self, names: tuple[str, ...], reason: str) -> None:
        """Say why there are no numbers of these names."""
        self.values |= dict.fromkeys(names)
        self.notes[names[0]] = reason
