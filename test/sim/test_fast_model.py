"""The right-hand side that runs against the reference equations."""

import math

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_sim.physics.friction import friction_share
from nw_gear_sim.reference.friction import sliding_friction
from nw_gear_sim.reference.model import Instant, ReferenceModel
from nw_gear_sim.reference.states import RATED, at_rest, model, random_state
from test.sim.fast_model import FRICTION_ERROR, ROLLER_ERROR, FastModel

ROUNDING = 1e-12
"""Relative to the largest force of its kind; phases of some thousand radians cost digits."""

INSTANTS = [
    (0.0, 1.81, RATED),
    (0.37, 0.4, 0.0),
    (-5.2, 1.81, 2e6),
    (123.4, 1.2, 5e6),
    (2 * math.pi / 100, 1.81, RATED),
]


def kind_of(name: str) -> str:
    """Motions with forces of like size: `ring.w`, `p1.u`, `sb.x`, ..."""
    body, motion = name.split(".")[:2]
    return f"{body.partition('_')[0]}.{motion}"


def without_rollers(forces: dict[str, float], housing: np.ndarray) -> dict[str, float]:
    """Generalised forces with those of the rollers taken back."""
    out = dict(forces)
    for bearing, pushed in zip(names.BEARINGS, housing, strict=True):
        for axis, force in zip("xyz", pushed, strict=True):
            if f"{bearing}.{axis}" in out:
                out[f"{bearing}.{axis}"] += float(force)
    return out


def compare(reference: ReferenceModel, seed: int) -> tuple[float, float, float]:
    """Largest difference of generalised forces besides the rollers', relative to their kind, and in N; of the rollers'.

    The last one is relative to the loads of all rollers of the bearing. Displacements, rates and forces of the meshes
    are compared too.
    """
    now = Instant(*INSTANTS[seed])
    q, v = random_state(reference, seed)
    fast = FastModel(reference).evaluate(q, v, now)
    housing = np.array([reference.bearing_force(name, q, now.angle.real) for name in names.BEARINGS])
    slow = without_rollers(reference.forces(q, v, now), housing)
    other = without_rollers({name: a * reference.masses[name] for name, a in fast.accelerations.items()}, fast.housing)
    largest: dict[str, float] = {}
    for name, force in slow.items():
        largest[kind_of(name)] = max(largest.get(kind_of(name), 0.0), abs(force))
    for k, mesh in enumerate(names.MESHES):
        state = reference.mesh_state(mesh, q, v, now)
        assert fast.x[k] == pytest.approx(state.x, abs=1e-15)
        assert fast.v[k] == pytest.approx(state.v, abs=1e-12)
        assert fast.force[k] == pytest.approx(state.force, abs=1e-5)
    loads = np.array([reference.roller_loads(name, q, now.angle.real) for name in names.BEARINGS])
    return (
        max(abs(slow[name] - other[name]) / largest[kind_of(name)] for name in slow),
        max(abs(slow[name] - other[name]) for name in slow),
        float(np.max(np.abs(housing - fast.housing) / loads[:, None])),
    )


@pytest.mark.parametrize("mode", ["kinematic", "tied"])
@pytest.mark.parametrize("in_gap", [True, False])
@pytest.mark.parametrize("seed", range(len(INSTANTS)))
def test_fast_right_hand_side_without_friction(seed: int, in_gap: bool, mode: str) -> None:
    reference = model(friction__enabled=False, mesh__damping_in_gap=in_gap, excitation__mode=mode)
    relative, _, rollers = compare(reference, seed)
    assert relative < ROUNDING
    assert rollers < ROLLER_ERROR


@pytest.mark.parametrize("seed", range(3))
def test_fast_right_hand_side_of_other_gearboxes(seed: int) -> None:
    """Fewer segments, ball bearings, another direction of gravity: nothing is tied to the default numbers."""
    reference = model(
        friction__enabled=False,
        ring__segments=37,
        bearings__exponent=1.5,
        gravity__direction=0.7,
        mesh__I__error_mean=1e-5,
        mesh__II__stiffness_variation=-0.2,
    )
    relative, _, rollers = compare(reference, seed)
    assert relative < ROUNDING
    assert rollers < ROLLER_ERROR


@pytest.mark.parametrize("mode", ["kinematic", "tied"])
@pytest.mark.parametrize("seed", range(len(INSTANTS)))
def test_fast_friction(seed: int, mode: str) -> None:
    reference = model(excitation__mode=mode)
    q, v = random_state(reference, seed)
    now = Instant(*INSTANTS[seed])
    pressed = sum(abs(reference.mesh_state(mesh, q, v, now).elastic) for mesh in names.MESHES)
    assert compare(reference, seed)[1] < FRICTION_ERROR * pressed


@pytest.mark.parametrize("speed", [0.05, 1.81])
def test_fast_friction_integrals(speed: float) -> None:
    """The integrals behind the tables, at any phase."""
    reference = model()
    law = FastModel(reference).gearbox.laws.friction
    for k, stage in enumerate(reference.kinematics.stages):
        for phase in np.linspace(0.0, 2 * math.pi, 40, endpoint=False):
            points = np.array(sliding_friction(reference.configuration.friction, stage, phase, speed))
            expected = points[:, 1].sum(), (points[:, 0] * points[:, 1]).sum()
            assert friction_share(law, k, phase, speed) == pytest.approx(expected, abs=1e-11)


def test_fast_equilibrium_is_one() -> None:
    reference = model(friction__enabled=False)
    q = FastModel(reference).equilibrium(RATED)
    forces = reference.forces(q, at_rest(reference), Instant(0.0, 0.0, RATED))
    lever = reference.kinematics.bodies.ring.base_radius
    assert max(abs(f) / (lever if "psi" in name else 1) for name, f in forces.items()) < 0.02  # N, of 1.2e6 N per mesh
