"""Action and reaction, element by element: what each one does to the bodies adds up to no force and no moment.

Forces in x, y, z and moments about z, with the forces at the bodies' own places. Moments about x and y aren't in the
model: gears and bearings don't tilt.
"""

import math

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from test.sim.gearboxes import RATED_SPEED, RATED_TORQUE, at_rest, make
from test.sim.verification.wrenches import only, place_of, with_nothing_but, wrench

BOUND = 1e-9
ANGLES = [0.0, 0.4321, -7.7]


def state(gearbox: Gearbox, seed: int = 3) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    return 3e-4 * rng.standard_normal(gearbox.layout.size), 1e-2 * rng.standard_normal(gearbox.layout.size)


def imbalance(gearbox: Gearbox, force: Array, angle: float) -> float:
    """Largest of the sums of forces and moments, over the largest force, and that times one metre."""
    total, moment = wrench(gearbox, force, angle)
    largest = np.max(np.abs(force))
    assert largest > 0
    return max(float(np.max(np.abs(total))), abs(moment)) / largest


@pytest.mark.parametrize("mesh", range(7))
@pytest.mark.parametrize("angle", ANGLES)
def test_meshes(mesh: int, angle: float, figure) -> None:
    """Normal force, damping and friction of one mesh alone; on the ring they act on two segments."""
    gearbox = make()
    law = gearbox.laws.mesh
    chosen = {name: only(getattr(law, name), mesh) for name in ("stiffness", "damping")}
    with_nothing_but(gearbox, mesh=law._replace(stiffness_cos=0 * law.damping, stiffness_sin=0 * law.damping, **chosen))
    gearbox.set_instant(0.0, RATED_SPEED, angle)
    q, v = state(gearbox)
    row = gearbox.instants.rows[0]
    for sign in (1, -1):  # both flanks
        stretched = q.copy()
        stretched[row.place[mesh, 8 if mesh < 3 else 0]] -= sign * 2e-3 * (1 if mesh < 3 else -1)
        force = gearbox.forces(stretched, v)
        assert sign * gearbox.contact.elastic[mesh] > 1e5
        assert np.count_nonzero(gearbox.contact.elastic) == 1
        label = f"imbalance of mesh {names.MESHES[mesh]} over its force"
        assert figure(label, imbalance(gearbox, force, angle)) < BOUND


@pytest.mark.parametrize("angle", ANGLES)
def test_ring_joints(angle: float, figure) -> None:
    gearbox = make()
    ring = gearbox.laws.ring
    bare = {name: 0.0 for name in ("radial_support", "axial_support", "radial_damping", "axial_damping", "weight")}
    with_nothing_but(gearbox, ring=ring._replace(**bare))
    gearbox.set_instant(0.0, RATED_SPEED, angle)
    assert figure("imbalance of the ring's joints", imbalance(gearbox, gearbox.forces(*state(gearbox)), angle)) < BOUND


def test_shaft_and_torsion_springs(figure) -> None:
    """Each of the springs alone; only the generator's, the last one, has its other end outside."""
    gearbox = make()
    springs = gearbox.laws.springs
    worst = 0.0
    for k in range(len(springs.aa)):
        gearbox = make()
        alone = springs._replace(aa=only(springs.aa, k), ab=only(springs.ab, k), bb=only(springs.bb, k))
        with_nothing_but(gearbox, springs=alone)
        gearbox.set_instant(0.0, RATED_SPEED, 0.3)
        off = imbalance(gearbox, gearbox.forces(*state(gearbox)), 0.3)
        if k == len(springs.aa) - 1:
            assert off == pytest.approx(gearbox.kinematics.bodies.herringbone_2.base_radius, rel=1e-9)
        else:
            worst = max(worst, off)
    assert figure("imbalance of the shafts' springs", worst) < BOUND


@pytest.mark.parametrize("bearing", range(10))
def test_bearings_push_the_housing_back(bearing: int, figure) -> None:
    """Force on the housing plus what the moving ring gets is nothing, in x, y and z, besides the damper to ground."""
    gearbox = make()
    law = gearbox.laws.bearings
    with_nothing_but(gearbox, bearings=law._replace(stiffness=only(law.stiffness, bearing), damping=0 * law.damping))
    gearbox.set_instant(0.0, RATED_SPEED, 1.234)
    force = gearbox.forces(*state(gearbox, 4))
    total, moment = wrench(gearbox, force, 1.234)
    housing = gearbox.housing[bearing]
    x, y = place_of(gearbox, names.BEARINGS[bearing])
    on_housing = x * housing[1] - y * housing[0]
    off = max(float(np.max(np.abs(total + housing))), abs(moment + on_housing)) / float(np.max(np.abs(housing)))
    assert figure("imbalance of a bearing and its housing", off) < BOUND


@pytest.mark.parametrize("direction", [-math.pi / 2, 0.7])
@pytest.mark.parametrize("angle", ANGLES)
def test_weight_falls_where_it_should(angle: float, direction: float) -> None:
    """All of the gearbox's mass pulls in the direction of gravity, however far the ring's frame has turned."""
    gearbox = make(("gravity.direction", direction))
    own = gearbox.laws
    ring = own.ring._replace(own=0 * own.ring.own, next=0 * own.ring.next, radial_support=0.0, axial_support=0.0)
    with_nothing_but(gearbox, weight=own.weight, ring=ring)
    gearbox.set_instant(0.0, RATED_SPEED, angle)
    zero = np.zeros(gearbox.layout.size)
    total, moment = wrench(gearbox, gearbox.forces(zero, zero), angle)
    mass = 5690 + 3 * (950 + 2320 + 2 * 200) + 440 + 5369 + 125 + 150 + 200 + 40 + 40
    assert total == pytest.approx(9.81 * mass * np.array([math.cos(direction), math.sin(direction), 0]), abs=1e-4)
    output = gearbox.kinematics.stages[2].pair.centre_distance * (125 + 40 + 40)
    assert moment == pytest.approx(9.81 * output * math.sin(direction), rel=1e-9)


@pytest.mark.parametrize("angle", [0.0, 2.5])
def test_whole_gearbox_at_rest(angle: float, figure) -> None:
    """Free body of everything: torque in, generator, weight, housings and the ring's supports hold each other.

    About the axis the housings take the difference of the torques, T_in + T_out (both shafts turn the same way).
    """
    gearbox = make()
    q = find_equilibrium(gearbox, RATED_TORQUE, speed=RATED_SPEED, angle=angle).q
    gearbox.set_instant(RATED_TORQUE, RATED_SPEED, angle, static=True)
    gearbox.forces(q, 0 * q)
    ring, layout = gearbox.laws.ring, gearbox.layout
    outside = np.zeros(layout.size)
    for node, force in zip(layout.bearings(), gearbox.housing, strict=True):
        for place, part in zip((node.x, node.y, node.z), force, strict=True):
            if place >= 0:
                outside[place] -= part
    outside[layout.ring("w")] -= ring.radial_support * q[layout.ring("w")]
    outside[layout.ring("z")] -= ring.axial_support * q[layout.ring("z")]
    total, moment = wrench(gearbox, outside, angle)
    mass = 5690 + 3 * (950 + 2320 + 2 * 200) + 440 + 5369 + 125 + 150 + 200 + 40 + 40
    total[1] -= 9.81 * mass
    base = gearbox.kinematics.bodies.herringbone_2.base_radius
    generator = RATED_TORQUE / gearbox.kinematics.total_ratio + 5e6 * q[layout.nodes["h2"].u] / base
    moment -= 9.81 * gearbox.kinematics.stages[2].pair.centre_distance * (125 + 40 + 40)
    moment += RATED_TORQUE - generator
    assert figure("imbalance of forces on the whole gearbox, N", float(np.max(np.abs(total)))) < 1e-3
    assert figure("imbalance of moments on the whole gearbox, N m", abs(moment)) < 1e-2


def test_at_rest_is_without_residual() -> None:
    assert at_rest()[1].residual < 1e-3
