"""Campbell diagram: natural frequencies over the ring's speed, what excites them, and where they meet.

At each speed the gearbox is linearised anew at the equilibrium under the load that belongs to it. Excitation follows
the speed: harmonics of the mesh frequencies, shafts, planets and segments passing, rollers. A crossing is a resonance
only as far as the excitation works on the mode: mesh orders are judged by the share of strain energy in their meshes.

IEC 61400-4 asks for such an analysis and for a judgement of each crossing by the shapes and energies of the mode; the
separation of 10 % used here is common practice, quoted from memory and not from the standard's text.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.optimize

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.elements import find_elements, rigid_motions
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.kinematics import SHAFT_OF_BEARING, Kinematics
from nw_gear_sim.layout import PLANETS
from nw_gear_sim.linear import Shapes, linearise, lowest_modes
from nw_gear_sim.participation import Participation, participations

SEPARATION = 0.1
"""Distance of a natural frequency from an excitation, over the latter, below which it counts as near."""
HARMONICS = 3
ALIKE = 0.5
"""Least modal assurance criterion between neighbouring speeds for a mode to be the same one."""


@dataclass(frozen=True)
class Order:
    """One excitation.

    Attributes:
        name: such as `mesh II, 2nd`; kind: `mesh`, `shaft`, `planet passing`, `rollers` or `segments`.
        ratio: its frequency over that of the ring's rotation; stage, harmonic: of mesh orders, else "" and 1.
    """

    name: str
    kind: str
    ratio: float
    stage: str = ""
    harmonic: int = 1


@dataclass(frozen=True)
class Crossing:
    """Where a natural frequency meets an excitation.

    Attributes:
        mode: number of the mode, from 1; order: name of the excitation.
        speed: of the ring, rad/s; frequency_hz: there.
        share: of the mode's strain energy in the meshes that excite it (mesh orders; else NaN).
    """

    mode: int
    order: str
    speed: float
    frequency_hz: float
    share: float


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
        speed: of the ring, rad/s, (n,); torque: N m, (n,); rated: speed and index of the modes' numbers.
        frequencies_hz, damping_ratio: of each mode along the speeds, NaN where it couldn't be followed, (n, modes).
        modes: what takes part in them at rated speed.
        orders: the excitations; crossings, margins: see there, margins within `separation` alone.
    """

    speed: Array
    torque: Array
    rated: float
    frequencies_hz: Array
    damping_ratio: Array
    modes: list[Participation]
    orders: list[Order]
    crossings: list[Crossing]
    margins: list[Margin]
    separation: float


def orders(kinematics: Kinematics) -> list[Order]:
    """Return all excitations of a gearbox, with frequencies over that of the ring's rotation."""
    found = []
    for stage in kinematics.stages:
        for n in range(1, HARMONICS + 1):
            name = f"mesh {stage.name}" + ("" if n == 1 else f", {n}{'nd' if n == 2 else 'rd'}")
            found.append(Order(name, "mesh", n * stage.mesh_ratio, stage.name, n))
    found += [Order(f"shaft {shaft}", "shaft", kinematics.shaft_ratio[shaft]) for shaft in names.SHAFTS]
    found.append(Order("planets pass the ring", "planet passing", float(PLANETS)))
    passing: dict[float, list[str]] = {}
    for kind in SHAFT_OF_BEARING:
        passing.setdefault(kinematics.roller_pass_ratio[kind], []).append(kind)
    found += [Order(f"rollers of {', '.join(kinds)}", "rollers", ratio) for ratio, kinds in passing.items()]
    found.append(Order("ring segments (numerical)", "segments", float(kinematics.ring.count)))
    return found


def wind_torque(rated_torque: float, rated_speed: float) -> Callable[[float], float]:
    """Torque (N m) over the ring's speed (rad/s) along the wind law, paper Eq 2: T ~ v^2, n ~ v up to rated."""
    return lambda speed: rated_torque * min(1.0, speed / rated_speed) ** 2


def find_campbell(
    gearbox: Gearbox,
    torque: Callable[[float], float],
    *,
    rated: float,
    speeds: Sequence[float],
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
    criterion |a^H M b|^2; below ALIKE the line ends. Coriolis forces of the ring are left out, and frequencies of ring
    modes are those seen by the ring.

    Raises:
        NoEquilibrium: at one of the speeds.
    """
    grid = np.unique(np.concatenate([np.asarray(speeds, float), [rated]]))
    start = int(np.searchsorted(grid, rated))
    frequencies = np.full((len(grid), count), math.nan)
    damping = frequencies.copy()
    done = 0

    def solve(k: int) -> Shapes:
        nonlocal done
        found = find_equilibrium(gearbox, torque(grid[k]), speed=grid[k], angle=angle)
        shapes = lowest_modes(linearise(gearbox, found.q), count + count // 4)
        done += 1
        progress(done, len(grid))
        return shapes

    first = solve(start).first(count)
    at_rated = find_equilibrium(gearbox, torque(rated), speed=rated, angle=angle).q
    elements, rigid = find_elements(gearbox, at_rated), rigid_motions(gearbox, angle)
    modes = participations(first, gearbox.mass, gearbox.layout, elements, rigid)
    frequencies[start], damping[start] = first.frequencies_hz, first.damping_ratio
    for way in (range(start - 1, -1, -1), range(start + 1, len(grid))):
        vectors, alive = first.vectors, np.ones(first.vectors.shape[1], bool)
        for k in way:
            shapes = solve(k)
            match = np.abs(vectors.conj().T @ (gearbox.mass[:, None] * shapes.vectors)) ** 2
            mine, theirs = scipy.optimize.linear_sum_assignment(-match)
            alive &= match[mine, theirs] >= ALIKE
            frequencies[k] = np.where(alive, shapes.frequencies_hz[theirs], math.nan)
            damping[k] = np.where(alive, shapes.damping_ratio[theirs], math.nan)
            vectors = shapes.vectors[:, theirs]
    lines = orders(gearbox.kinematics)
    crossings = [c for order in lines for c in _crossings(order, grid, frequencies, modes)]
    return Campbell(
        speed=grid,
        torque=np.array([torque(speed) for speed in grid]),
        rated=rated,
        frequencies_hz=frequencies,
        damping_ratio=damping,
        modes=modes,
        orders=lines,
        crossings=sorted(crossings, key=lambda c: c.speed),
        margins=_margins(lines, rated, frequencies[start], modes, separation),
        separation=separation,
    )


def mesh_share(order: Order, mode: Participation) -> float:
    """Share of the mode's strain energy in the meshes that an order excites; NaN where it is no mesh order."""
    if not order.stage:
        return math.nan
    return sum(mode.strain[f"mesh {mesh}"] for mesh in names.MESHES_OF_STAGE[order.stage])


def _crossings(order: Order, speed: Array, frequencies: Array, modes: list[Participation]) -> list[Crossing]:
    """Straight lines between neighbouring speeds meet the straight line of the order."""
    found = []
    distance = frequencies - (order.ratio / (2 * math.pi) * speed)[:, None]
    for k, m in zip(*np.nonzero(distance[:-1] * distance[1:] < 0), strict=True):
        part = distance[k, m] / (distance[k, m] - distance[k + 1, m])
        at = float(speed[k] + part * (speed[k + 1] - speed[k]))
        share = mesh_share(order, modes[m])
        found.append(Crossing(int(m) + 1, order.name, at, order.ratio * at / (2 * math.pi), share))
    return found


def _margins(
    lines: list[Order], rated: float, frequencies: Array, modes: list[Participation], separation: float
) -> list[Margin]:
    found = []
    for order in lines:
        excitation = order.ratio * rated / (2 * math.pi)
        for m, frequency in enumerate(frequencies):
            margin = float(frequency / excitation - 1)
            if abs(margin) <= separation:
                share = mesh_share(order, modes[m])
                found.append(Margin(m + 1, order.name, float(frequency), excitation, margin, share))
    return sorted(found, key=lambda m: abs(m.margin))
