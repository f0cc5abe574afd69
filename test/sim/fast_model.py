"""The fast right-hand side behind the names of the reference's coordinates."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.reference.model import Instant, ReferenceModel

ROLLER_ERROR = 1e-9
"""Stated relative error of the fast power of a roller's compression."""
FRICTION_ERROR = 4e-4
"""Error of the tabulated friction share of a mesh force."""


@dataclass(frozen=True)
class Evaluation:
    """Accelerations by coordinate; displacement, rate and force of the meshes; forces on the bearings' housings."""

    accelerations: dict[str, float]
    x: np.ndarray
    v: np.ndarray
    force: np.ndarray
    housing: np.ndarray


class FastModel:
    """The compiled gearbox of a reference model's configuration."""

    def __init__(self, reference: ReferenceModel) -> None:
        self.gearbox = Gearbox(reference.configuration, reference.configuration.excitation.mode)
        base, layout = reference.kinematics.bodies.ring.base_radius, self.gearbox.layout
        self._entry = {f"{name}.{axis}": getattr(node, axis) for name, node in layout.nodes.items() for axis in "uxyz"}
        self._entry = {name: entry for name, entry in self._entry.items() if entry >= 0}
        self._scale = dict.fromkeys(self._entry, 1.0)
        for ours, motion, scale in (("w", "w", 1.0), ("v", "v", 1.0), ("psi", "p", base), ("z", "z", 1.0)):
            for i in range(reference.ring.count):
                self._entry[f"ring.{ours}.{i}"] = layout.ring(motion).start + i
                self._scale[f"ring.{ours}.{i}"] = scale

    def evaluate(self, q: Mapping[str, float], v: Mapping[str, float], now: Instant) -> Evaluation:
        """Accelerations and what the meshes and bearings do."""
        gearbox = self.gearbox
        gearbox.set_instant(now.torque, now.speed, now.angle.real)
        accelerations = gearbox.forces(self._state(q), self._state(v)) / gearbox.mass
        contact = gearbox.contact
        return Evaluation(
            self._named(accelerations),
            contact.x.copy(),
            contact.rate.copy(),
            contact.force.copy(),
            gearbox.housing.copy(),
        )

    def equilibrium(self, torque: float) -> dict[str, float]:
        """Displacements at rest, the ring unturned."""
        return self._named(find_equilibrium(self.gearbox, torque).q)

    def _state(self, values: Mapping[str, float]) -> np.ndarray:
        state = np.full(self.gearbox.layout.size, np.nan)
        for name, value in values.items():
            state[self._entry[name]] = value * self._scale[name]
        return state

    def _named(self, state: np.ndarray) -> dict[str, float]:
        return {name: float(state[entry]) / self._scale[name] for name, entry in self._entry.items()}
