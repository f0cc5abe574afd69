"""What must not depend on the frame: turning everything by a planet spacing, by whole periods, mirrored loads.

Turned by 120 degrees planet j stands where j + 1 was, and gravity points elsewhere. That the teeth then mesh as before
is the assembly condition: after 22/3 turns of the ring planets and sun have come on by whole teeth and a third of a
turn. herringbone_2 can't follow, since it stands on the x axis: its mesh is opened. Cages repeat too where rollers and
cage factors fit.
"""

import math

import numpy as np
import pytest

from nw_gear_common.tables import Array
from nw_gear_sim.config import load, with_values
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.simulation import Simulation
from test.sim.gearboxes import RATED_SPEED, RATED_TORQUE, make

SPACING = 2 * math.pi / 3
TURN = 2 * math.pi * 22 / 3
OPEN_OUTPUT = (("mesh.III.backlash", 1e-2), ("mesh.III.damping_ratio", 0.0))
REPEATING_CAGES = (
    *((f"bearings.{kind}.rollers", 30) for kind in ("pb1", "pb2")),
    *((f"bearings.{kind}.cage_factor", 0.4) for kind in ("pb1", "pb2")),
    *((f"bearings.{kind}.rollers", 240) for kind in ("sb", "b1")),
    *((f"bearings.{kind}.cage_factor", 0.5) for kind in ("sb", "b1")),
)


def turned(gearbox: Gearbox, q: Array) -> Array:
    """The same motion of the gearbox turned by a planet spacing; ring segments turn with the ring."""
    layout, out = gearbox.layout, q.copy()
    cos, sin = math.cos(SPACING), math.sin(SPACING)
    for name, node in layout.nodes.items():
        target = node
        if name[-2:] in ("_1", "_2", "_3"):
            target = layout.nodes[f"{name[:-1]}{int(name[-1]) % 3 + 1}"]
        if name in ("h2", "b21", "b22"):
            continue
        out[target.x] = cos * q[node.x] - sin * q[node.y]
        out[target.y] = sin * q[node.x] + cos * q[node.y]
        for there, here in ((target.u, node.u), (target.z, node.z)):
            if here >= 0:
                out[there] = q[here]
    return out


@pytest.mark.parametrize("segments", [100, 99])
@pytest.mark.parametrize("angle", [0.013, 0.31, 4.4])
def test_turning_everything_by_a_planet_spacing(angle: float, segments: int, figure) -> None:
    """Forces turn with the gearbox, its weight included."""
    same = (*OPEN_OUTPUT, *REPEATING_CAGES, ("ring.segments", segments))
    before = make(*same, ("gravity.direction", -math.pi / 2))
    after = make(*same, ("gravity.direction", -math.pi / 2 + SPACING))
    rng = np.random.default_rng(7)
    q = 3e-4 * rng.standard_normal(before.layout.size)
    v = 1e-2 * rng.standard_normal(before.layout.size)
    before.set_instant(RATED_TORQUE, RATED_SPEED, angle)
    after.set_instant(RATED_TORQUE, RATED_SPEED, angle + TURN)
    expected = turned(before, before.forces(q, v))
    closed = np.count_nonzero(before.contact.elastic)
    found = after.forces(turned(before, q), turned(before, v))
    output = [getattr(before.layout.nodes[name], axis) for name in ("h2", "b21", "b22") for axis in "uxyz"]
    inside = np.setdiff1d(np.arange(before.layout.size), output)
    assert closed >= 3
    off = float(np.max(np.abs(found - expected)[inside]) / np.max(np.abs(expected)))
    assert figure("turned by a planet spacing, off over the largest force", off) < 1e-11


def test_turning_without_gravity_is_noticed() -> None:
    """The check can fail: with gravity left where it was the forces differ by the weights."""
    same = (*OPEN_OUTPUT, *REPEATING_CAGES)
    before, after = make(*same), make(*same)
    zero = np.zeros(before.layout.size)
    before.set_instant(0.0, 0.0, 0.2)
    after.set_instant(0.0, 0.0, 0.2 + TURN)
    difference = after.forces(zero, zero) - turned(before, before.forces(zero, zero))
    assert np.max(np.abs(difference)) > 9.81 * 2320


def test_mesh_frequencies_are_commensurate_after_forty_turns_of_a_planet() -> None:
    """880, 3320 and 10873 mesh cycles: then stiffness, errors and friction are the same again, and no earlier."""
    gearbox = make()
    gearbox.set_instant(RATED_TORQUE, RATED_SPEED, 0.6)
    once = gearbox.instants.excitation[0].copy()
    for turns in range(1, 41):
        gearbox.set_instant(RATED_TORQUE, RATED_SPEED, 0.6 + 2 * math.pi * turns * 22 / 91)
        again = gearbox.instants.excitation[0]
        assert np.allclose(again, once, rtol=1e-9, atol=1e-12) == (turns == 40)


def running(segments: int) -> Array:
    """Elongations of the meshes over two seconds at rated torque and speed, after one second, (samples, 7)."""
    drive = Drive(RATED_SPEED, RATED_SPEED, RATED_TORQUE, RATED_TORQUE)
    simulation = Simulation(with_values({"ring.segments": segments}, load()), drive)
    simulation.advance(5120, drive)
    return np.asarray(simulation.advance(2 * 5120, drive).x)


@pytest.mark.slow
def test_doubling_the_segments_while_running(figure) -> None:
    """Twice as many segments pass twice as often; means and vibrations of all meshes stay."""
    coarse, fine = running(100), running(200)
    mean = float(np.max(np.abs(coarse.mean(axis=0) / fine.mean(axis=0) - 1)))
    vibration = float(np.max(np.abs(coarse.std(axis=0) / fine.std(axis=0) - 1)))
    assert figure("mean elongations while running, M = 100 against 200", mean) < 1e-3
    assert figure("standard deviations while running, M = 100 against 200", vibration) < 0.01
