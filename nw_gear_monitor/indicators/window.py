"""What an indicator may look at, and what it declares about itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

from nw_gear_common.tables import Array

Result = TypeVar("Result")


@dataclass(frozen=True)
class LineResult:
    """What the line fit says about one mesh (see `explained_lines`)."""

    rho: float
    tau: float
    k: float


@dataclass(frozen=True, eq=False)
class TurnsWindow:
    """A window long enough for turns of both gears of a mesh (see `gear_turns`).

    Attributes:
        cycles: (cycles, points per cycle) displacement on equal steps of mesh phase, m.
        teeth: of driver and driven gear.
    """

    cycles: Array
    teeth: tuple[int, int]


@dataclass(eq=False)
class Memory:
    """What indicators of one mesh keep from hop to hop until the stream breaks: sum and number of earlier values.

    Attributes:
        sums: name of a quantity -> (sum, number).
    """

    sums: dict[str, tuple[float, int]] = field(default_factory=dict)

    def add(self, name: str, value: float) -> None:
        """Take one more value."""
        total, number = self.sums.get(name, (0.0, 0))
        self.sums[name] = total + value, number + 1


@dataclass(frozen=True, eq=False)
class MeshWindow:
    """The last seconds of one mesh.

    Attributes:
        mesh: its name.
        rate: samples per second, Hz.
        phase: (samples,) unwrapped mesh phase of this mesh, rad.
        x, v: (samples,) displacement, m, and velocity, m/s.
        lines: outcome of the line fit; None while its window isn't filled or nothing turns.
        turns: the window of what needs turns of the gears; None where there's none, or tooth counts aren't known.
        strobes: (points, 2) x and v of the newest mesh cycles at a fixed mesh phase, oldest first.
        half_gap: displacement at which flanks touch, m; None where it isn't known.
        memory: of this mesh since the stream began or broke.
    """

    mesh: str
    rate: float
    phase: Array
    x: Array
    v: Array
    lines: LineResult | None
    turns: TurnsWindow | None = None
    strobes: Array | None = None
    half_gap: float | None = None
    memory: Memory = field(default_factory=Memory)
    _known: dict[Callable[[Array, Array], object], object] = field(default_factory=dict)

    def once(self, function: Callable[[Array, Array], Result]) -> Result:
        """Compute function(phase, x) at its first use; further indicators that build on it get the same result."""
        if function not in self._known:
            self._known[function] = function(self.phase, self.x)
        return self._known[function]  # type: ignore[return-value]  # the key fixes the type


@dataclass(frozen=True)
class Column:
    """One number in `indicators/<mesh>`."""

    name: str
    unit: str
    text: str


@dataclass(frozen=True)
class Indicator:
    """One indicator: the columns it fills and the function that does it (one number per column)."""

    columns: tuple[Column, ...]
    compute: Callable[[MeshWindow], tuple[float, ...]]


def single(name: str, unit: str, text: str, compute: Callable[[MeshWindow], float]) -> Indicator:
    """An indicator that is one number."""
    return Indicator((Column(name, unit, text),), lambda window: (compute(window),))
