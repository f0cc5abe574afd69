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
class MeshWindow:
    """The last seconds of one mesh.

    Attributes:
        mesh: its name.
        rate: samples per second, Hz.
        phase: (samples,) unwrapped mesh phase of this mesh, rad.
        x, v: (samples,) displacement, m, and velocity, m/s.
        lines: outcome of the line fit; None while its window isn't filled or nothing turns.
    """

    mesh: str
    rate: float
    phase: Array
    x: Array
    v: Array
    lines: LineResult | None
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
