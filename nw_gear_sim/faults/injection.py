"""Puts faults into the laws of a gearbox: the arrays that the compiled right-hand side reads are changed in place."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.assembly import SENSE
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.faults.ramps import Ramps
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.kinematics import PLANETS, SHAFT_OF_BEARING, Kinematics, bearing_kind
from nw_gear_sim.params.faults import PLACES, SEVERITIES, FaultSettings

WORDS = {
    "crack": "cracked tooth",
    "pitch": "pitch error",
    "eccentricity": "eccentric gear",
    "wear": "worn flanks",
    "clearance": "bearing clearance",
    "race": "race defect",
}
UNITS = {"fault_crack": "1", "fault_wear_stiffness": "1"}
"""Units of the severities that aren't lengths."""


class Injection:
    """The faults of one gearbox.

    Args:
        gearbox: whose laws are changed.
    """

    def __init__(self, gearbox: Gearbox) -> None:
        self._gearbox = gearbox
        self._ramps = Ramps()
        mesh, bearings = gearbox.laws.mesh, gearbox.laws.bearings
        self._sound = {
            name: getattr(mesh, name).copy() for name in ("stiffness", "stiffness_cos", "stiffness_sin", "backlash")
        }
        self._clearance = bearings.clearance.copy()
        self._shown: dict[str, float] = {}
        self._resting: Array | None = None

    def change(self, settings: FaultSettings, time: float) -> None:
        """Take over what is asked for from a time (s) on.

        Raises:
            InputError: the gear has no such tooth.
        """
        check_faults(settings, self._gearbox.kinematics)
        self._ramps.change(settings, time)
        self._write(self._ramps.at(time))

    @property
    def settings(self) -> FaultSettings:
        """What was asked for last."""
        return self._ramps.settings

    def apply(self, time: float) -> None:
        """Bring the laws to a time (s); does nothing where no ramp is under way."""
        severities = self._ramps.at(time)
        if severities != self._shown:
            self._write(severities)

    def present(self, time: float) -> list[str]:
        """Return the kinds of faults that are there, in words."""
        now = self._ramps.at(time)
        return [WORDS[kind] for kind, severities in SEVERITIES.items() if any(now[name] for name in severities)]

    def truth(self, time: float) -> dict[str, str]:
        """Return every fault that is there: where, how much, since when."""
        found = {}
        for kind, severities in SEVERITIES.items():
            now = {name: self._ramps.at(time)[name] for name in severities}
            if not any(now.values()):
                continue
            label = f"fault {WORDS[kind]}"
            found[label] = ", ".join(str(getattr(self._ramps.settings, name)) for name in PLACES[kind])
            for name, value in now.items():
                found[f"{label}: {name.removeprefix('fault_')} ({UNITS.get(name, 'm')})"] = f"{value:.6g}"
            found[f"{label}: since (s)"] = f"{self._ramps.since(kind):.6f}"
        return found

    def state(self) -> dict[str, Any]:
        """Return all that the future depends on."""
        return self._ramps.state()

    def restore(self, state: Mapping[str, Any], time: float) -> None:
        """Take over what `state` returned, at a time (s)."""
        self._ramps.restore(state)
        self._write(self._ramps.at(time))

    def _write(self, severities: Mapping[str, float]) -> None:
        if severities["fault_race_depth"] > 0.0 and self._resting is None:
            self._write(dict.fromkeys(severities, 0.0))  # the place of a defect mustn't depend on what else is there
            self._resting = self._at_rest()
        self._shown = dict(severities)
        self._write_teeth(severities)
        self._write_wear(severities)
        self._write_bearings(severities)

    def _write_teeth(self, severities: Mapping[str, float]) -> None:
        asked, law = self._ramps.settings, self._gearbox.laws.teeth
        law.used[0] = 0
        for gear, tooth, column, name in (
            (asked.fault_crack_gear, asked.fault_crack_tooth, law.loss, "fault_crack"),
            (asked.fault_pitch_gear, asked.fault_pitch_tooth, law.error, "fault_pitch"),
            (asked.fault_eccentric_gear, 0, law.runout, "fault_eccentricity"),
        ):
            if severities[name] == 0.0:
                continue
            for mesh, offset in self._meshes(gear):
                row = law.used[0]
                pair = self._gearbox.kinematics.stage(mesh).pair
                for cleared in (law.loss, law.error, law.runout):
                    cleared[row] = 0.0
                law.mesh[row] = names.MESHES.index(mesh)
                law.teeth[row] = _teeth(gear, self._gearbox.kinematics)
                law.tooth[row] = tooth - offset
                law.fade[row] = max(pair.contact_ratio + pair.overlap_ratio - 1.0, 0.05)
                column[row] = severities[name]
                law.used[0] = row + 1

    def _write_wear(self, severities: Mapping[str, float]) -> None:
        mesh = self._gearbox.laws.mesh
        stage = self._ramps.settings.fault_wear_stage
        worn = np.array([names.STAGE_OF_MESH[name] == stage for name in names.MESHES])
        left = np.where(worn, 1.0 - severities["fault_wear_stiffness"], 1.0)
        for name in ("stiffness", "stiffness_cos", "stiffness_sin"):
            getattr(mesh, name)[:] = self._sound[name] * left
        mesh.backlash[:] = self._sound["backlash"] + np.where(worn, severities["fault_wear"], 0.0)

    def _write_bearings(self, severities: Mapping[str, float]) -> None:
        asked, law = self._ramps.settings, self._gearbox.laws.bearings
        law.clearance[:] = self._clearance
        law.clearance[names.BEARINGS.index(asked.fault_clearance_bearing)] += severities["fault_clearance"]
        marks = law.marks
        marks.used[0] = int(severities["fault_race_depth"] > 0.0)
        if marks.used[0] == 0:
            return
        b = names.BEARINGS.index(asked.fault_race_bearing)
        shaft = SHAFT_OF_BEARING[bearing_kind(asked.fault_race_bearing)]
        turning = SENSE[shaft] * self._gearbox.kinematics.shaft_ratio[shaft]
        marks.bearing[0] = b
        marks.angle[0] = self._loaded(b) + asked.fault_race_angle
        marks.ratio[0] = turning if asked.fault_race == "inner" else 0.0
        marks.width[0], marks.depth[0] = asked.fault_race_width, severities["fault_race_depth"]

    def _loaded(self, bearing: int) -> float:
        """Direction of the force on a housing of the sound gearbox at rest, rad."""
        assert self._resting is not None, "_write comes first"
        x, y = self._resting[bearing, :2]
        return math.atan2(y, x)

    def _at_rest(self) -> Array:
        """Forces on the housings under the load of the configuration by the laws as they are, N, (bearings, 3)."""
        gearbox, kinematics = self._gearbox, self._gearbox.kinematics
        q = find_equilibrium(gearbox, kinematics.input_torque, speed=kinematics.ring_speed).q
        gearbox.set_instant(kinematics.input_torque, kinematics.ring_speed)
        gearbox.forces(q, np.zeros_like(q))
        return gearbox.housing.copy()

    def _meshes(self, gear: str) -> list[tuple[str, float]]:
        """Return the meshes of a gear, with what its tooth numbers there are less than at planet 1.

        Ring and sun bring a tooth from planet to planet: the phase of planet j is that of planet 1 plus turns j / 3
        mesh cycles, folded, where turns is -Z of the ring or Z of the sun; the whole cycles are the difference.
        """
        stage, driver = _place(gear)
        if gear in ("wheel", "pinion"):
            return [("III", 0.0)]
        if gear in ("ring", "sun"):
            turns = _teeth(gear, self._gearbox.kinematics) * (-1 if driver else 1)
            return [(f"{stage}_{j + 1}", float(turns * j // PLANETS)) for j in range(PLANETS)]
        return [(f"{stage}_{gear[-1]}", 0.0)]


def check_faults(settings: FaultSettings, kinematics: Kinematics) -> None:
    """Refuse faults that a gearbox can't have.

    Raises:
        InputError: the gear has no such tooth.
    """
    for kind, gear, tooth in (
        ("crack", settings.fault_crack_gear, settings.fault_crack_tooth),
        ("pitch", settings.fault_pitch_gear, settings.fault_pitch_tooth),
    ):
        teeth = _teeth(gear, kinematics)
        if tooth >= teeth:
            raise InputError(f"fault_{kind}_tooth", f"0 to {teeth - 1} on the {gear}", str(tooth))


def _teeth(gear: str, kinematics: Kinematics) -> int:
    stage, driver = _place(gear)
    pair = kinematics.stage(stage).pair
    return pair.driver.teeth if driver else pair.driven.teeth


def _place(gear: str) -> tuple[str, bool]:
    """Return the stage of a gear, and whether it drives there."""
    if gear == "ring" or gear.startswith("p1"):
        return "I", gear == "ring"
    if gear == "sun" or gear.startswith("p2"):
        return "II", gear != "sun"
    return "III", gear == "wheel"


def same_settings(settings: Any) -> FaultSettings:
    """Return the faults among other settings."""
    return FaultSettings(**{field.name: getattr(settings, field.name) for field in fields(FaultSettings)})
