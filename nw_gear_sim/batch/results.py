"""What `Batch.advance` hands back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nw_gear_common import names
from nw_gear_common.tables import Array


@dataclass(frozen=True, eq=False)
class Section:
    """Poincare points of one mesh at one parameter point: time (s), x (m) and its rate v (m/s), (n,) each."""

    time: Array
    x: Array
    v: Array


@dataclass(frozen=True, eq=False)
class Span:
    """What happened in an interval, for all points.

    Attributes:
        start, end: seconds since the batch began.
        section_time, section_x, section_v: Poincare points, (points, 7, n), NaN beyond the last one of a mesh.
        time: of the samples, s, (samples,).
        x, force: sampled elongation (m) and mesh force (N) in the order of names.MESHES, (points, samples, 7).
        open_fraction, back_fraction: share of the steps without load, and with load on the back flanks, (points, 7).
        diverged: time at which a displacement left its bound, s, (points,); NaN for points that are well. Nothing of a
            diverged point is given from then on (NaN).
    """

    start: float
    end: float
    section_time: Array
    section_x: Array
    section_v: Array
    time: Array
    x: Array
    force: Array
    open_fraction: Array
    back_fraction: Array
    diverged: Array

    def section(self, point: int, mesh: str) -> Section:
        """Return the Poincare points of a mesh (names.MESHES) at a point."""
        k = names.MESHES.index(mesh)
        there = np.isfinite(self.section_x[point, k])
        columns = (self.section_time, self.section_x, self.section_v)
        return Section(*(column[point, k][there] for column in columns))


@dataclass(frozen=True, eq=False)
class End:
    """Where all points of a batch are, to start another one there: flat states of `stepping.State`, points last.

    Attributes:
        parts: named arrays of shape (rows, points).
        angle: of the ring, rad, (points,).
        pairs: keys of the ring's modes; step: s.
    """

    parts: dict[str, Array]
    angle: Array
    pairs: tuple[tuple[int, int, int, int], ...]
    step: float

    def take(self, points: npt.ArrayLike) -> End:
        """Return some of the points, in a new order: their numbers, repeats allowed."""
        chosen = np.asarray(points, dtype=np.int64)
        return End({k: part[:, chosen] for k, part in self.parts.items()}, self.angle[chosen], self.pairs, self.step)
