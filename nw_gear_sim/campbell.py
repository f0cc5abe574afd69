"""Campbell diagram: natural frequencies over the ring's speed, what excites them, and where they meet.

At each speed the gearbox is linearised anew at the equilibrium under the load that belongs to it. Excitation follows
the speed: harmonics of the mesh frequencies, shafts, planets and segments passing, rollers. A crossing is a resonance
only as far as the excitation works on the mode: mesh orders are judged by the share of strain energy in their meshes.

IEC 61400-4 asks for such an analysis and for a judgement of each crossing by the shapes and energies of the mode; the
separation of 10 % used here is common practice, quoted from memory and not from the standard's text.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.optimize

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.elements import find_elements, rigid_motions
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.excitations import Order, orders
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.linear import Shapes, linearise, lowest_modes
from nw_gear_sim.participation import Participation, participations

SEPARATION = 0.1
"""Distance of a natural frequency from an excitation, over the latter, below which it counts as near."""
ALIKE = 0.5
"""Least modal assurance criterion between neighbouring speeds for a mode to be the same one."""


@dataclass(frozen=True)
class Crossing:
    """Where a natural frequency meets an excitation.

    Attributes:
        mode: number of the mode, from 1; order: name of the excitation.
        speed: of the ring, rad/s; frequency_hz: there.
        share: of the mode's strain energy there in the meshes that excite it (mesh orders; else NaN).
        certain: whether the shapes at the speeds on both sides are alike, so that it is the same mode.
    """

    mode: int
    order: str
    speed: float
    frequency_hz: float
    share: float
    certain: bool


@dataclass(frozen=True)
class Margin:
    """Distance of a natural frequency from an excitation at rated speed: `margin` = f_mode / f_order - 1."""

    mode: int
    order: str
    frequency_hz: float
    excitation_hz: float
    margin: float
    share: float


@dataclass(frozen=True, eq=False)
class Campbell:
    """The diagram.

    Attributes:
        speed: of the ring, rad/s, (n,); torque: N m, (n,); rated: speed at which the modes are numbered, rad/s.
        frequencies_hz, damping_ratio: of each mode along the speeds, (n, modes).
        alike: modal assurance criterion between a mode at a speed and at the next one, (n - 1, modes).
        strain: share of strain energy in the meshes of stages I, II, III, (n, 3, modes).
        modes: what takes part in them at rated speed.
        orders: the excitations; crossings: by speed; margins: those within `separation`, nearest first.
    """

    speed: Array
    torque: Array
    rated: float
    frequencies_hz: Array
    damping_ratio: Array
    alike: Array
    strain: Array
    modes: list[Participation]
    orders: list[Order]
    crossings: list[Crossing]
    margins: list[Margin]
    separation: float


def wind_torque(rated_torque: float, rated_speed: float) -> Callable[[float], float]:
    """Torque (N m) over the ring's speed (rad/s) along the wind law, paper Eq 2: T ~ v^2, n ~ v up to rated."""
    return lambda speed: rated_torque * min(1.0, speed / rated_speed) ** 2


def find_campbell(
    gearbox: Gearbox,
    torque: Callable[[float], float],
    *,
    rated: float,
    speeds: Sequence[float] | Array,
    count: int,
    separation: float = SEPARATION,
    angle: float = 0.0,
    progress: Callable[[int, int], None] = lambda _done, _total: None,
) -> Campbell:
    """Follow the lowest modes over the speed, outwards from the rated one.

    Args:
        gearbox: its laws.
        torque: N m over the ring's speed, rad/s.
        rated: rated speed, rad/s; it is put among the speeds.
        speeds: of the ring, rad/s; count: modes followed; separation: see SEPARATION.
        angle: of the ring, rad: mesh stiffness is taken there.
        progress: called with the speeds done and all of them.

    Modes at neighbouring speeds belong together where the assignment has the largest sum of the modal assurance
    criterion |a^H M b|^2; below ALIKE it is doubtful whether they do. The frequencies are good to about 1e-5 (see
    `linear.lowest_modes`). Coriolis forces of the ring are left out, and frequencies of ring
    modes are those seen by the ring.

    Raises:
        NoEquilibrium: at one of the speeds.
    """
    grid = np.unique(np.concatenate([np.asarray(speeds, float), [rated]]))
    start = int(np.searchsorted(grid, rated))
    walker = _Walker(gearbox, torque, grid, count, angle, progress)
    walker.visit(start)
    modes = participations(walker.shapes, gearbox.mass, gearbox.layout, walker.elements, rigid_motions(gearbox, angle))
    at_rated = walker.shapes, walker.q
    for way in (range(start - 1, -1, -1), range(start + 1, len(grid))):
        walker.shapes, walker.q = at_rated
        before = start
        for k in way:
            walker.visit(k, before)
            before = k
    lines = orders(gearbox.kinematics)
    found = [c for order in lines for c in _crossings(order, grid, walker)]
    return Campbell(
        speed=grid,
        torque=np.array([torque(speed) for speed in grid]),
        rated=rated,
        frequencies_hz=walker.frequencies,
        damping_ratio=walker.damping,
        alike=walker.alike,
        strain=walker.strain,
        modes=modes,
        orders=lines,
        crossings=sorted(found, key=lambda c: c.speed),
        margins=_margins(lines, rated, walker.frequencies[start], walker.strain[start], separation),
        separation=separation,
    )


class _Walker:
    """Goes from speed to speed and keeps what it finds there, in the order of the modes at the first one."""

    def __init__(
        self,
        gearbox: Gearbox,
        torque: Callable[[float], float],
        grid: Array,
        count: int,
        angle: float,
        progress: Callable[[int, int], None],
    ) -> None:
        self._gearbox, self._torque, self._grid = gearbox, torque, grid
        self._count, self._angle, self._progress = count, angle, progress
        self._done = 0
        self.frequencies = np.empty((len(grid), count))
        self.damping = np.empty((len(grid), count))
        self.strain = np.empty((len(grid), len(names.STAGES), count))
        self.alike = np.empty((len(grid) - 1, count))
        self.q: Array | None = None
        self.shapes: Shapes

    def visit(self, k: int, before: int | None = None) -> None:
        """Linearise at speed k; the modes are those at `before`, a neighbour visited last."""
        gearbox, speed = self._gearbox, float(self._grid[k])
        self.q = find_equilibrium(gearbox, self._torque(speed), speed=speed, angle=self._angle, guess=self.q).q
        wanted = min(self._count + self._count // 4 + 4, gearbox.layout.size)
        found = lowest_modes(linearise(gearbox, self.q), wanted)
        chosen = np.arange(self._count)
        if before is not None:
            match = np.abs(self.shapes.vectors.conj().T @ (gearbox.mass[:, None] * found.vectors)) ** 2
            mine, chosen = scipy.optimize.linear_sum_assignment(-match)
            self.alike[min(k, before)] = match[mine, chosen]
        self.shapes = Shapes(found.eigenvalues[chosen], found.vectors[:, chosen])
        self.frequencies[k], self.damping[k] = self.shapes.frequencies_hz, self.shapes.damping_ratio
        self.elements = find_elements(gearbox, self.q)
        energy = {element.name: element.energy(self.shapes.vectors) for element in self.elements}
        total = np.maximum(np.sum(list(energy.values()), axis=0), np.finfo(float).tiny)
        for stage, own in enumerate(names.MESHES_OF_STAGE.values()):
            self.strain[k, stage] = sum(energy[f"mesh {mesh}"] for mesh in own) / total
        self._done += 1
        self._progress(self._done, len(self._grid))


def _share(order: Order, strain: Array, mode: int) -> float:
    """Share of a mode's strain energy in the meshes that an order excites; NaN where it is no mesh order."""
    return float(strain[names.STAGES.index(order.stage), mode]) if order.stage else math.nan


def _crossings(order: Order, speed: Array, walker: _Walker) -> list[Crossing]:
    """Straight lines between neighbouring speeds meet the straight line of the order."""
    found = []
    distance = walker.frequencies - (order.ratio / (2 * math.pi) * speed)[:, None]
    for k, m in zip(*np.nonzero((distance[:-1] < 0) != (distance[1:] < 0)), strict=True):
        part = distance[k, m] / (distance[k, m] - distance[k + 1, m])
        at = float(speed[k] + part * (speed[k + 1] - speed[k]))
        share = _share(order, walker.strain[k if part < 0.5 else k + 1], m)
        certain = bool(walker.alike[k, m] >= ALIKE)
        found.append(Crossing(int(m) + 1, order.name, at, order.ratio * at / (2 * math.pi), share, certain))
    return found


def _margins(lines: list[Order], rated: float, frequencies: Array, strain: Array, separation: float) -> list[Margin]:
    found = []
    for order in lines:
        excitation = order.ratio * rated / (2 * math.pi)
        for m, frequency in enumerate(frequencies):
            margin = float(frequency / excitation - 1)
            if abs(margin) <= separation:
                share = _share(order, strain, m)
                found.append(Margin(m + 1, order.name, float(frequency), excitation, margin, share))
    return sorted(found, key=lambda m: abs(m.margin))


def as_object(diagram: Campbell) -> dict[str, object]:
    """Return the JSON object of a diagram: SI units, frequencies in Hz, modes numbered from 1, NaN as null."""

    def plain(record: Crossing | Margin) -> dict[str, object]:
        values = dataclasses.asdict(record)
        return values | {"share": values["share"] if math.isfinite(record.share) else None}

    return {
        "speed": diagram.speed.tolist(),
        "torque": diagram.torque.tolist(),
        "rated_speed": diagram.rated,
        "separation": diagram.separation,
        "modes": [
            {
                "number": m + 1,
                "name": mode.name,
                "kind": mode.kind,
                "frequencies_hz": diagram.frequencies_hz[:, m].tolist(),
                "damping_ratio": diagram.damping_ratio[:, m].tolist(),
                "alike": diagram.alike[:, m].tolist(),
                "mesh_strain": {s: diagram.strain[:, k, m].tolist() for k, s in enumerate(names.STAGES)},
            }
            for m, mode in enumerate(diagram.modes)
        ],
        "orders": [dataclasses.asdict(order) for order in diagram.orders],
        "crossings": [plain(crossing) for crossing in diagram.crossings],
        "margins": [plain(margin) for margin in diagram.margins],
    }
