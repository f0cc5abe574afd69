"""The gearbox with the ring in modes, against the whole model."""

import math

import numpy as np
import pytest

from nw_gear_common.tables import Array
from nw_gear_sim import model
from nw_gear_sim.config import load, with_values
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.modal import forces as modal_forces
from nw_gear_sim.modal import stepping as modal_stepping
from nw_gear_sim.modal.laws import ModalLaws, choose_modes
from nw_gear_sim.modal.ring import RingModes, ring_matrices, ring_modes
from nw_gear_sim.physics.friction import empty_table, fill_table
from test.sim.gearboxes import RATED_SPEED, RATED_TORQUE

CONFIGURATION = load()
TABULATED = 3e-7
"""Error of forces by linear interpolation between 64 knots a segment, in the largest force."""


def gearbox(**values: object) -> Gearbox:
    return Gearbox(with_values({key.replace("__", "."): value for key, value in values.items()}, CONFIGURATION))


def evaluated(
    laws: ModalLaws, whole: Gearbox, x: Array, v: Array, angle: float, speed: float = RATED_SPEED, times: int = 1
) -> tuple[Array, modal_forces.ModalWork]:
    table = empty_table()
    fill_table(whole.laws.friction, speed, table)
    interval = model.Interval(angle, speed, speed, RATED_TORQUE, RATED_TORQUE, 1.0)
    instants, work, out = modal_forces.new_instants(laws), modal_forces.new_work(laws), np.empty_like(x)
    for _ in range(times):
        modal_stepping.evaluate(laws, table, table, interval, x, v, instants, work, out)
    modal_forces.mesh_rates(laws, instants, 0, x, v, work)
    return out - laws.square * x - laws.damping * v, work


def reduced(whole: Gearbox, ring: RingModes, q: Array) -> Array:
    count = len(ring.shapes)
    return np.concatenate([ring.shapes.T @ (whole.mass[:count] * q[:count]), q[count:]])


@pytest.mark.parametrize("segments", [24, 25])
def test_modes_solve_the_ring_s_eigenproblem(segments: int) -> None:
    whole = gearbox(ring__segments=segments)
    mass = whole.mass[: 4 * segments]
    modes = ring_modes(whole.laws.ring, mass)
    stiffness, damping = ring_matrices(whole.laws.ring)
    assert modes.shapes.T @ (mass[:, None] * modes.shapes) == pytest.approx(np.eye(4 * segments), abs=1e-12)
    largest = modes.square.max()
    assert modes.shapes.T @ stiffness @ modes.shapes / largest == pytest.approx(
        np.diag(modes.square) / largest, abs=1e-12
    )
    assert modes.shapes.T @ damping @ modes.shapes == pytest.approx(modes.damping, abs=1e-9)
    expected = np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(mass, mass)))
    assert modes.square == pytest.approx(expected, abs=1e-9 * largest)


@pytest.mark.parametrize("angle", [0.0, 0.0123, 0.7, 5.9, -3.0])
def test_with_all_modes_the_forces_are_those_of_the_whole_model(angle: float) -> None:
    whole = gearbox()
    laws, ring = choose_modes(whole, math.inf, rigid=False, coupled=True)
    random = np.random.default_rng(3)
    q, v = 1e-4 * random.standard_normal(463), 1e-2 * random.standard_normal(463)
    whole.set_instant(RATED_TORQUE, RATED_SPEED, angle)
    expected = whole.forces(q, v)
    found, work = evaluated(laws, whole, reduced(whole, ring, q), reduced(whole, ring, v), angle)
    back = whole.mass * np.concatenate([ring.shapes @ found[:400], found[400:]])
    assert np.max(np.abs(back - expected)) < TABULATED * np.max(np.abs(expected))
    assert work.contact.x == pytest.approx(whole.contact.x, abs=2e-9)
    assert work.contact.rate == pytest.approx(whole.contact.rate, abs=1e-5)
    assert work.housing == pytest.approx(whole.housing, rel=1e-9, abs=1e-6)


@pytest.mark.parametrize("angle", [0.0, 0.013, 0.03, 1.1])
def test_modes_left_out_count_by_their_flexibility(angle: float) -> None:
    """At the whole model's equilibrium the modes kept carry nearly its elongations; without R they are 4-8 um off."""
    whole = gearbox()
    laws, ring = choose_modes(whole, 5000.0, rigid=False, coupled=False)
    q = find_equilibrium(whole, RATED_TORQUE, speed=RATED_SPEED, angle=angle).q
    whole.forces(q, np.zeros_like(q))
    expected = whole.contact.x.copy()
    x = reduced(whole, ring, q)
    _, work = evaluated(laws, whole, x, np.zeros_like(x), angle, times=4)
    assert work.contact.x == pytest.approx(expected, abs=0.03e-6)
    bare = work.bare - expected[:3]
    assert np.all(bare > 2e-6)


def test_a_rigid_ring_is_the_whole_model_whose_segments_move_as_one() -> None:
    """Rigid motions strain no joint, so that meshes, supports, weight and torque are all that acts on them."""
    whole = gearbox()
    laws, ring = choose_modes(whole, math.inf, rigid=True, coupled=True)
    random = np.random.default_rng(4)
    x, v = 1e-4 * random.standard_normal(67), 1e-2 * random.standard_normal(67)
    x[:4] *= 75.0  # coordinates of a ring of 5690 kg
    q, rate = (np.concatenate([ring.shapes @ part[:4], part[4:]]) for part in (x, v))
    whole.set_instant(RATED_TORQUE, RATED_SPEED, 0.4)
    force = whole.forces(q, rate)
    found, work = evaluated(laws, whole, x, v, 0.4)
    expected = np.concatenate([ring.shapes.T @ force[:400], force[400:] / whole.mass[400:]])
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-6 * np.max(np.abs(expected)))
    assert work.contact.x == pytest.approx(whole.contact.x, abs=2e-9)
