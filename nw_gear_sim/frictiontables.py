"""Friction tables at any speed, interpolated between tables at the speeds of a grid.

An exact table takes as long as a hundred steps, and under a changing wind each interval needs another one. Between two
speeds 2 % apart g and g_1 are straight to 3e-5 of the coefficient of friction, less than what lies between the phases
of a table. A table depends on the speed alone, not on those asked for before.
"""

from __future__ import annotations

import math

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.physics.friction import FrictionLaw, empty_table, fill_table

SPACING = 0.02
"""Relative distance of neighbouring speeds of the grid."""


class FrictionTables:
    """Fills friction tables.

    Args:
        law: of the gearbox; the grid begins where its friction starts to fade, below that tables are exact.
    """

    def __init__(self, law: FrictionLaw) -> None:
        self._law = law
        self._known: dict[int, Array] = {}

    def fill(self, speed: float, table: Array) -> None:
        """Set a table (see `friction.empty_table`) to a speed of the ring (rad/s)."""
        if speed <= self._law.fade_speed:
            fill_table(self._law, speed, table)
            return
        number = math.floor(math.log(speed / self._law.fade_speed) / math.log1p(SPACING))
        share = (speed / self._speed(number) - 1.0) / SPACING
        np.multiply(self._at(number), 1.0 - share, out=table)
        table += share * self._at(number + 1)

    def _speed(self, number: int) -> float:
        return self._law.fade_speed * (1.0 + SPACING) ** number

    def _at(self, number: int) -> Array:
        if number not in self._known:
            self._known[number] = empty_table()
            fill_table(self._law, self._speed(number), self._known[number])
        return self._known[number]
