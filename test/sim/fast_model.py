"""The fast right-hand side behind the names of the reference's coordinates."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_sim.dynamics import constants, friction, layout
from nw_gear_sim.dynamics import equilibrium as fast_equilibrium
from nw_gear_sim.dynamics.model import BEARING, FORCE, OBSERVED, V, X, accelerations, work_size
from test.sim.reference_model import Instant, ReferenceModel

FRICTION_ERROR = 2e-5
"""Error of the tabulated friction share of a mesh force."""


@dataclass(frozen=True)
class Evaluation:
    """Accelerations by coordinate; displacement, rate and force of the meshes; forces of the bearings."""

    accelerations: dict[str, float]
    x: np.ndarray
    v: np.ndarray
    force: np.ndarray
    bearing_force: np.ndarray


def coordinates(reference: ReferenceModel) -> Iterator[tuple[str, float]]:
    """The reference's name of each entry of the fast state, and by how much the entry is larger."""
    base = reference.kinematics.bodies.ring.base_radius
    for motion in layout.motions(reference.ring.count):
        body, axis = motion.split()
        if body != "ring":
            yield f"{body}.{axis}", 1.0
        else:
            kind, number = axis.rstrip("]").split("[")
            yield f"ring.{'psi' if kind == 'p' else kind}.{number}", base if kind == "p" else 1.0


def _tables(reference: ReferenceModel, speed: float) -> np.ndarray:
    k = reference.kinematics
    pairs = zip(k.stages, names.SHAFTS[:3], strict=True)
    law = reference.configuration.friction
    return np.array([friction.tables(stage.pair, law, speed * k.shaft_ratio[shaft], 0.0) for stage, shaft in pairs])


def evaluate(reference: ReferenceModel, q: Mapping[str, float], v: Mapping[str, float], now: Instant) -> Evaluation:
    order = list(coordinates(reference))
    c = constants.build(reference.configuration, reference.configuration.excitation.mode)
    state, rate = (np.array([values[name] * scale for name, scale in order]) for values in (q, v))
    observed, result = np.zeros(OBSERVED), np.zeros(len(order))
    accelerations(
        c,
        _tables(reference, now.speed),
        state,
        rate,
        now.angle.real,
        now.speed,
        now.torque,
        np.zeros(work_size(reference.ring.count)),
        observed,
        result,
    )
    return Evaluation(
        {name: a / scale for (name, scale), a in zip(order, result, strict=True)},
        observed[X:V],
        observed[V:FORCE],
        observed[FORCE:BEARING],
        observed[BEARING:].reshape(-1, 3),
    )


def equilibrium(reference: ReferenceModel, torque: float) -> tuple[dict[str, float], float]:
    """Equilibrium at rest at ring angle 0, by coordinate, and that angle."""
    c = constants.build(reference.configuration, reference.configuration.excitation.mode)
    q = fast_equilibrium.find(c, _tables(reference, 0.0), 0.0, torque).q
    return {name: x / scale for (name, scale), x in zip(coordinates(reference), q, strict=True)}, 0.0
