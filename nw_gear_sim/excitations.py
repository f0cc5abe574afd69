"""What excites the gearbox, as orders of the ring's rotation: meshes, shafts, planets, rollers, segments."""

from __future__ import annotations

from dataclasses import dataclass

from nw_gear_common import names
from nw_gear_sim.kinematics import PLANETS, SHAFT_OF_BEARING, Kinematics

HARMONICS = 3
"""Harmonics of the mesh frequencies."""


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
