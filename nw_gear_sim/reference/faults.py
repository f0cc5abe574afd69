"""Faults as formulas, written apart from the fast code: teeth are followed by the angles of their gears."""

from __future__ import annotations

import cmath
import math

from nw_gear_sim.kinematics import PLANET_ANGLES, SHAFT_OF_BEARING, Kinematics, Stage, bearing_kind
from nw_gear_sim.params.faults import FaultSettings

GEAR_OF = {"I": ("ring", "p1"), "II": ("p2", "sun"), "III": ("wheel", "pinion")}
"""Driver and driven gear of a stage."""


def peak_phase(stage: Stage) -> float:
    """Mesh phase at which the stiffness is largest, rad."""
    return stage.stiffness.phase + (math.pi if stage.stiffness.variation < 0 else 0.0)


def share(cycles: complex, contact_ratio: float) -> complex:
    """What a tooth carries of its mesh, `cycles` after it entered: a raised cosine, blurred over one mesh cycle."""
    fade = contact_ratio - 1.0

    def area(s: complex) -> complex:
        if s.real <= 0.0:
            return 0.0
        if s.real >= fade:
            return 1.0
        return s / fade - cmath.sin(2.0 * cmath.pi * s / fade) / (2.0 * cmath.pi)

    return area(cycles) - area(cycles - 1.0)


class TeethThatDiffer:
    """What faulty gears do to meshes, as functions of the ring's angle (complex, so that it can be differentiated)."""

    def __init__(self, kinematics: Kinematics, faults: FaultSettings) -> None:
        self._kinematics = kinematics
        self._faults = faults

    def loss(self, mesh: str, angle: complex) -> complex:
        """Lost share of the mesh stiffness."""
        f = self._faults
        return f.fault_crack * self._of_tooth(mesh, f.fault_crack_gear, f.fault_crack_tooth, angle)

    def error(self, mesh: str, angle: complex) -> complex:
        """Additional transmission error, m."""
        f = self._faults
        pitch = f.fault_pitch * self._of_tooth(mesh, f.fault_pitch_gear, f.fault_pitch_tooth, angle)
        if not self._meshes(mesh, f.fault_eccentric_gear):
            return pitch
        turned = self._turned(mesh, f.fault_eccentric_gear, angle)
        return pitch + f.fault_eccentricity * cmath.cos(2.0 * cmath.pi * turned)

    def worn(self, mesh: str) -> tuple[float, float]:
        """Growth of half the backlash (m), and the share of the stiffness that is left."""
        f = self._faults
        if mesh.split("_", maxsplit=1)[0] != f.fault_wear_stage:
            return 0.0, 1.0
        return f.fault_wear, 1.0 - f.fault_wear_stiffness

    def _meshes(self, mesh: str, gear: str) -> bool:
        stage = mesh.split("_", maxsplit=1)[0]
        if gear[:2] in ("p1", "p2"):
            return gear[:2] in GEAR_OF[stage] and gear[-1] == mesh[-1]
        return gear in GEAR_OF[stage]

    def _teeth(self, mesh: str, gear: str) -> int:
        stage = self._kinematics.stage(mesh)
        return stage.pair.driver.teeth if gear[:2] == GEAR_OF[stage.name][0][:2] else stage.pair.driven.teeth

    def _turned(self, mesh: str, gear: str, angle: complex) -> complex:
        """Turns of a gear since its tooth 0 entered this mesh."""
        stage = self._kinematics.stage(mesh)
        teeth = self._teeth(mesh, gear)
        start = math.remainder(peak_phase(stage), 2.0 * math.pi)
        turns = (stage.mesh_ratio * angle + start) / (2.0 * math.pi * teeth)
        if stage.name == "III":
            return turns
        planet = int(mesh[-1]) - 1
        if gear == "ring":
            return turns - PLANET_ANGLES[planet] / (2.0 * math.pi)
        if gear == "sun":
            return turns + PLANET_ANGLES[planet] / (2.0 * math.pi)
        return turns + stage.planet_phases[planet] / (2.0 * math.pi * teeth)

    def _of_tooth(self, mesh: str, gear: str, tooth: int, angle: complex) -> complex:
        if not self._meshes(mesh, gear):
            return 0.0
        pair, teeth = self._kinematics.stage(mesh).pair, self._teeth(mesh, gear)
        cycles = teeth * self._turned(mesh, gear, angle) - tooth
        cycles -= teeth * math.floor(cycles.real / teeth)
        return share(cycles, pair.contact_ratio + pair.overlap_ratio)


def sinking(
    kinematics: Kinematics, faults: FaultSettings, bearing: str, place: float, loaded: float, angle: float
) -> float:
    """How deep (m) a roller at `place` (rad) is in the defect of a race; `loaded`: direction of the housing's force."""
    if bearing != faults.fault_race_bearing or faults.fault_race_depth == 0.0:
        return 0.0
    shaft = SHAFT_OF_BEARING[bearing_kind(bearing)]
    turning = kinematics.shaft_ratio[shaft] * (-1.0 if shaft == "sun" else 1.0)
    defect = loaded + faults.fault_race_angle + (turning * angle if faults.fault_race == "inner" else 0.0)
    distance = abs(math.remainder(place - defect, 2.0 * math.pi))
    if distance >= faults.fault_race_width:
        return 0.0
    return 0.5 * faults.fault_race_depth * (1.0 + math.cos(math.pi * distance / faults.fault_race_width))
