"""The whole right-hand side: rigid motions, action and reaction, energy, friction's power, order of the integrator."""

import math

import numpy as np
import pytest

from nw_gear_common.tables import Array
from nw_gear_sim import model, stepping
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.physics.friction import empty_table
from nw_gear_sim.physics.mesh import backlash_function
from test.sim.gearboxes import (
    RATED_SPEED,
    RATED_TORQUE,
    WITHOUT_FRICTION,
    WITHOUT_LOSSES,
    at_rest,
    make,
    potential,
    rigid_rotation,
    translation,
)

ANGLES = [0.0, 0.4321, 5.0]


def test_backlash_function() -> None:
    assert [backlash_function(x, 2.0) for x in (-5.0, -2.0, 0.0, 2.0, 5.0)] == [-3.0, 0.0, 0.0, 0.0, 3.0]


@pytest.mark.parametrize("angle", ANGLES)
def test_rigid_motions_give_no_elongation(angle: float) -> None:
    """Wherever the ring stands: its turning with the right ratios, and moving the whole gearbox."""
    gearbox = make()
    gearbox.set_instant(0.0, 0.0, angle)
    rows = gearbox.instants.rows[0]
    for motion in (rigid_rotation(gearbox), *(translation(gearbox, axis, angle) for axis in "xyz")):
        if motion[gearbox.layout.ring("z")].any():  # the herringbone has no axial motion
            motion[gearbox.layout.nodes["h1"].z] = 0.0
        x = np.sum(rows.normal * motion[rows.place], axis=1)
        assert np.max(np.abs(x)) < 1e-13 * np.max(np.abs(motion))


@pytest.mark.parametrize("angle", ANGLES)
def test_mesh_and_friction_forces_balance(angle: float) -> None:
    """Forces of each mesh add up to zero in x, y, z, with friction."""
    gearbox = make()
    gearbox.set_instant(RATED_TORQUE, RATED_SPEED, angle)
    rows = gearbox.instants.rows[0]
    for axis in "xyz":
        motion = translation(gearbox, axis, angle)
        motion[gearbox.layout.nodes["h1"].z] = 0.0
        for row in (rows.normal, rows.slide, rows.roll):
            work = np.sum(row * motion[rows.place], axis=1)
            assert np.max(np.abs(work)) < 1e-13


def test_internal_forces_do_no_work_on_a_translation() -> None:
    """What moves the whole gearbox are weight, supports and housings alone."""
    gearbox, _ = at_rest()
    rng = np.random.default_rng(5)
    q, v = 1e-4 * rng.standard_normal((2, gearbox.layout.size))
    force = gearbox.forces(q, v)
    ring, bearings = gearbox.laws.ring, gearbox.laws.bearings
    w = gearbox.layout.ring("w")
    outside = np.zeros(gearbox.layout.size)
    outside[w] = -ring.radial_support * q[w] - ring.radial_damping * v[w]
    for b, places in enumerate(bearings.place):
        for axis, place in enumerate(places):
            if place >= 0:
                outside[place] -= gearbox.housing[b, axis] + bearings.damping[b] * v[place]
    weight = 9.81 * (5690 + 3 * (950 + 2320 + 2 * 200) + 440 + 5369 + 125 + 150 + 200 + 40 + 40)
    for axis, load in (("x", 0.0), ("y", -weight)):
        motion = translation(gearbox, axis, 0.0)
        assert motion @ force == pytest.approx(motion @ outside + load, abs=1e-9 * np.abs(motion) @ np.abs(force))


@pytest.mark.parametrize("torque", [RATED_TORQUE, 0.02 * RATED_TORQUE])
def test_forces_are_the_slope_of_the_energy(torque: float) -> None:
    """Against a potential energy written out independently, in contact and in the gaps."""
    gearbox, found = at_rest(*WITHOUT_FRICTION)
    gearbox = make(*WITHOUT_FRICTION)
    gearbox.set_instant(torque, 0.0)
    rng = np.random.default_rng(6)
    q = found.q * rng.uniform(-1, 1, len(found.q))
    force = gearbox.forces(q, np.zeros_like(q))
    for _ in range(20):
        direction = rng.standard_normal(len(q))
        step = 1e-8 * direction
        slope = (potential(gearbox, q + step, torque) - potential(gearbox, q - step, torque)) / 2e-8
        assert slope == pytest.approx(-force @ direction, rel=2e-6, abs=1e-4 * np.linalg.norm(force))


def run(
    gearbox: Gearbox, q: Array, v: Array, step: float, steps: int, speed: float, angle: float
) -> tuple[Array, Array]:
    """Integrate from (q, v) and a ring angle (rad) at rated torque without friction."""
    q, v = q.copy(), v.copy()
    table = empty_table()
    interval = model.Interval(angle, speed, speed, RATED_TORQUE, RATED_TORQUE, step * steps)
    course = stepping.new_course(gearbox.laws, 1)
    done = stepping.advance(
        gearbox.laws, table, table, interval, steps, 0.1, q, v, gearbox.instants, gearbox.work, course
    )
    assert done == steps
    return q, v


def test_energy_is_conserved_without_losses() -> None:
    """Standing still, undamped: only the integrator's own damping, far below a millionth, changes the energy."""
    gearbox, found = at_rest(*WITHOUT_LOSSES)
    q = found.q + 2e-6 * rigid_rotation(gearbox)
    v = 1e-3 * rigid_rotation(gearbox)

    def energy(q: Array, v: Array) -> float:
        gearbox.set_instant(RATED_TORQUE, 0.0)
        return potential(gearbox, q, RATED_TORQUE) + 0.5 * float(gearbox.mass @ v**2)

    brought_in = energy(q, v) - energy(found.q, 0 * v)
    q_end, v_end = run(gearbox, q, v, 2.5e-6, 20_000, 0.0, 0.0)
    assert np.max(np.abs(q_end - q)) > 1e-6
    assert energy(q_end, v_end) == pytest.approx(energy(q, v), abs=1e-5 * brought_in)


def test_order_of_the_integrator_on_the_gearbox() -> None:
    """Errors against a far finer run fall by 2^4 a halving where rollers take up load smoothly (delta^2)."""
    gearbox, found = at_rest(*WITHOUT_FRICTION, ("bearings.exponent", 2.0))
    v = np.full_like(found.q, 1e-4)
    reference, _ = run(gearbox, found.q, v, 2e-4 / 640, 640, RATED_SPEED, 0.3)
    errors = [np.linalg.norm(run(gearbox, found.q, v, 2e-4 / n, n, RATED_SPEED, 0.3)[0] - reference) for n in (20, 40)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.15)


@pytest.mark.parametrize("angle", np.linspace(0, 1, 7))
def test_friction_dissipates(angle: float) -> None:
    """Each mesh takes power out, between 0.1 and 1.5 % of what it transmits at rated load."""
    gearbox, found = at_rest()
    gearbox.set_instant(RATED_TORQUE, RATED_SPEED, angle)
    gearbox.forces(found.q, np.zeros_like(found.q))
    rows, excitation = gearbox.instants.rows[0], gearbox.instants.excitation[0]
    v = RATED_SPEED * rigid_rotation(gearbox)
    load = np.abs(gearbox.contact.elastic)
    share = excitation[:, 3, None] * rows.slide + excitation[:, 4, None] * rows.roll
    lost = -load * np.sum(share * v[rows.place], axis=1)
    driver = np.array([RATED_SPEED * gearbox.kinematics.bodies.ring.base_radius] * 3
                      + [v[gearbox.layout.planet("p2", 0).u]] * 3
                      + [v[gearbox.layout.nodes["h1"].u]])  # fmt: skip
    transmitted = load * driver
    assert np.all(lost / transmitted > 0.001)
    assert np.all(lost / transmitted < 0.015)


def test_friction_moments_are_those_of_its_forces() -> None:
    """The moment on the ring about its axis is the sum of segment forces times lever and segment moments."""
    gearbox = make()
    gearbox.set_instant(RATED_TORQUE, RATED_SPEED, 0.777)
    rows, kinematics = gearbox.instants.rows[0], gearbox.kinematics
    pair = kinematics.stages[0].pair
    turn = np.zeros(gearbox.layout.size)
    turn[gearbox.layout.ring("v")] = kinematics.ring.radius
    turn[gearbox.layout.ring("p")] = kinematics.bodies.ring.base_radius
    slide = np.sum(rows.slide[:3] * turn[rows.place[:3]], axis=1)
    roll = np.sum(rows.roll[:3] * turn[rows.place[:3]], axis=1)
    assert slide == pytest.approx([pair.driver.base_radius * math.tan(pair.working_angle)] * 3, rel=1e-12)
    assert roll == pytest.approx([-1.0] * 3, rel=1e-12)


def test_damping_inside_the_gap_is_a_choice() -> None:
    for inside in (True, False):
        gearbox = make(("mesh.damping_in_gap", inside))
        gearbox.set_instant(0.0, 0.0)
        size = gearbox.layout.size
        gearbox.forces(np.zeros(size), 1e-3 * np.ones(size))
        assert np.any(gearbox.contact.force != 0.0) == inside
        assert np.all(gearbox.contact.elastic == 0.0)


def test_rate_is_the_derivative_of_the_elongation() -> None:
    """Through the turning ring's segments too: difference quotient of x_n along a motion."""
    gearbox, found = at_rest()
    q, v = found.q, 1e-3 * np.random.default_rng(8).standard_normal(gearbox.layout.size)
    step = 1e-6

    def x(time: float) -> Array:
        gearbox.set_instant(RATED_TORQUE, RATED_SPEED, 0.5 + RATED_SPEED * time)
        gearbox.forces(q + v * time, v)
        return gearbox.contact.x.copy()

    slope = (x(step) - x(-step)) / (2 * step)
    x(0.0)
    assert gearbox.contact.rate == pytest.approx(slope, rel=1e-5, abs=1e-8)
