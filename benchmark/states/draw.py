"""Boxes from which the parameters of the benchmark's cases are drawn, and how many cases of each state are wanted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from states.systems import GOLDEN, TAU

Draw = Callable[[np.random.Generator], list[float]]
BOTH = ("tuning", "held-out")
HELD_OUT = ("held-out",)
IRRATIONAL = (GOLDEN, 2.0**0.5 - 1.0, 3.0**0.5 - 1.0, (13.0**0.5 - 3.0) / 2.0, np.e - 2.0, np.pi - 3.0 + 0.5)
"""Ratios of the two drives, plus 0 or 1."""


@dataclass(frozen=True)
class Family:
    """One system with a box of parameters.

    Attributes:
        name, system: of the family and of the system in systems.py.
        draw: parameters p at random.
        candidates: how many are tried.
        first, subharmonic, torus, chaos: most cases of period 1, of each other period, of tori, of chaos.
        two_channels: whether a second channel can be seen.
        sets: those that hold cases of it; some families are kept from the tuning altogether.
    """

    name: str
    system: str
    draw: Draw
    candidates: int
    first: int
    subharmonic: int
    torus: int
    chaos: int
    two_channels: bool = True
    sets: tuple[str, ...] = BOTH

    def parameters(self, random: np.random.Generator) -> tuple[Array, Array]:
        """Parameters (8,) and start (8,): state and a tangent."""
        p = np.zeros(8)
        given = self.draw(random)
        p[: len(given)] = given
        start = np.zeros(8)
        start[:4] = random.uniform(0.05, 0.3, 4)
        start[4:6] = 0.8, 0.6
        return p, start

    def quota(self, label: str) -> int:
        """Most cases with this state."""
        special = {names.PERIODS[0]: self.first, names.QUASI_PERIODIC: self.torus, names.CHAOTIC: self.chaos}
        return special.get(label, self.subharmonic)


def _hardening(r: np.random.Generator) -> list[float]:
    return [r.uniform(0.6, 2.5), r.uniform(0.05, 0.3), 1.0, r.uniform(0.3, 1.5), r.uniform(1.0, 20.0)]


def _double_well(r: np.random.Generator) -> list[float]:
    return [r.uniform(0.6, 1.5), r.uniform(0.08, 0.3), -1.0, 1.0, r.uniform(0.1, 0.6)]


def _ueda(r: np.random.Generator) -> list[float]:
    return [r.uniform(0.8, 1.3), r.uniform(0.05, 0.2), 0.0, 1.0, r.uniform(4.0, 14.0)]


def _pendulum(r: np.random.Generator) -> list[float]:
    return [r.uniform(0.4, 1.2), r.uniform(0.2, 0.8), 0.0, 0.0, r.uniform(0.6, 1.8)]


def _gear(r: np.random.Generator) -> list[float]:
    return [
        r.uniform(0.4, 1.8), r.uniform(0.02, 0.08), r.uniform(0.0, 0.3), r.uniform(0.05, 0.4), r.uniform(0.02, 0.4)
    ]  # fmt: skip


def _vdp(r: np.random.Generator) -> list[float]:
    return [r.uniform(0.4, 3.0), r.uniform(0.2, 4.0), 0.0, 0.0, r.uniform(0.2, 3.0)]


def _coupled(r: np.random.Generator) -> list[float]:
    return [r.uniform(0.4, 3.0), r.uniform(0.2, 1.5), r.uniform(0.05, 0.6), r.uniform(0.7, 1.5), r.uniform(0.1, 1.5)]


def _twice(draw: Draw) -> Draw:
    """The same with a second drive of 0.2 to 0.7 of the first, at an incommensurate frequency."""

    def both(r: np.random.Generator) -> list[float]:
        p = draw(r)
        ratio = float(r.choice(IRRATIONAL)) + float(r.integers(2))
        return [*p, p[4] * r.uniform(0.2, 0.7), ratio, r.uniform(0.0, TAU)]

    return both


def _driven(r: np.random.Generator) -> list[float]:
    p = [r.uniform(2.6, 3.45), r.uniform(0.02, 0.12), 0.0, 0.0, 0.0, 0.0]
    return [*p, float(r.choice(IRRATIONAL)), r.uniform(0.0, TAU)]


FAMILIES = (
    Family("hardening Duffing", "duffing", _hardening, 500, 14, 8, 0, 12),
    Family("double-well Duffing", "duffing", _double_well, 500, 12, 8, 0, 12),
    Family("Ueda", "duffing", _ueda, 400, 10, 8, 0, 12),
    Family("pendulum", "pendulum", _pendulum, 500, 14, 8, 0, 12, sets=HELD_OUT),
    Family("gear with backlash", "gear", _gear, 900, 18, 10, 0, 18),
    Family("van der Pol", "vdp", _vdp, 350, 6, 5, 25, 4),
    Family("coupled van der Pol", "coupled", _coupled, 250, 4, 4, 20, 4),
    Family("Duffing, two drives", "duffing", _twice(_hardening), 60, 0, 0, 12, 4),
    Family("gear, two drives", "gear", _twice(_gear), 60, 0, 0, 12, 4),
    Family("pendulum, two drives", "pendulum", _twice(_pendulum), 60, 0, 0, 10, 4, sets=HELD_OUT),
    Family("logistic", "logistic", lambda r: [r.uniform(3.0, 4.0)], 1500, 0, 4, 0, 8, two_channels=False),
    Family("sine", "sine", lambda r: [r.uniform(0.72, 1.0)], 1500, 0, 4, 0, 8, two_channels=False, sets=HELD_OUT),
    Family("cubic", "cubic", lambda r: [r.uniform(2.0, 3.0)], 1500, 0, 4, 0, 8, two_channels=False),
    Family(
        "Gauss", "gauss", lambda r: [r.uniform(4.5, 8.0), r.uniform(-0.9, 0.1)], 1000, 0, 4, 0, 8, two_channels=False
    ),
    Family("Hénon", "henon", lambda r: [r.uniform(0.4, 1.42), r.uniform(0.1, 0.32)], 2000, 0, 4, 0, 10),
    Family(
        "circle",
        "circle",
        lambda r: [r.uniform(0.0, 1.0), r.uniform(0.2, 1.6), r.uniform(0.0, 0.5)],
        1500, 0, 3, 25, 6, two_channels=False,
    ),
    Family("delayed logistic", "delayed", lambda r: [r.uniform(2.0, 2.27)], 300, 0, 2, 12, 2),
    Family("driven logistic", "driven", _driven, 100, 0, 0, 10, 4, two_channels=False),
)  # fmt: skip
