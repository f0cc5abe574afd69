"""The reference equations hold what mechanics demands."""

import math

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_sim.reference.arrays import ArrayModel
from nw_gear_sim.reference.friction import contact_lines, sliding_friction
from nw_gear_sim.reference.model import Instant, ReferenceModel
from nw_gear_sim.reference.states import RATED, SMOOTH, model, random_state, shifted_together, turned_together


@pytest.mark.parametrize("angle", [0.0, 0.4, -7.1])
def test_turning_together_closes_no_mesh_and_strains_no_joint(angle: float) -> None:
    reference = model(**SMOOTH)
    rotation = 1e-3
    q = turned_together(reference, rotation)
    for mesh in names.MESHES:
        state = reference.mesh_state(mesh, q, q, Instant(angle, 1.8, 0.0))
        assert abs(state.x) < 1e-15
        assert abs(state.v) < 1e-15
    for h, stiffness, _ in reference.springs():
        if len(h) > 1:
            assert abs(stiffness * sum(c * q[name] for name, c in h.items())) < 1e-3  # N, of 1e8 N per strained joint


@pytest.mark.parametrize("angle", [0.0, 0.4, -7.1])
def test_shifting_together_closes_no_mesh(angle: float) -> None:
    reference = model(**SMOOTH)
    now = Instant(angle, 1.8, 0.0)
    q, v = shifted_together(reference, np.array([1e-3, -2e-3, 5e-4]), now)
    for mesh in names.MESHES:
        state = reference.mesh_state(mesh, q, v, now)
        assert abs(state.x) < 1e-15
        assert abs(state.v) < 1e-14
    for h, stiffness, _ in reference.springs():
        if len(h) > 1:
            assert abs(stiffness * sum(c * q[name] for name, c in h.items())) < 1e-3


def test_mesh_velocity_is_the_derivative_of_its_displacement() -> None:
    """Also while ring segments pass: h(t)^T q' alone isn't."""
    reference = model()
    speed, angle, step = 1.8, 0.412, 3e-6
    q, v = random_state(reference, 5)
    for mesh in names.MESHES:
        ends = []
        for time in (-step, step):
            moved = {name: q[name] + time * v[name] for name in q}
            ends.append(reference.mesh_state(mesh, moved, v, Instant(angle + time * speed, speed, 0.0)).x)
        rate = reference.mesh_state(mesh, q, v, Instant(angle, speed, 0.0)).v
        assert (ends[1] - ends[0]) / (2 * step) == pytest.approx(rate, abs=1e-7)


@pytest.mark.parametrize("seed", range(6))
def test_friction_takes_power_on_both_flanks(seed: int) -> None:
    """Friction times the motion that slides: all shafts turning at their speeds."""
    rubbing, smooth = model(), model(friction__enabled=False)
    q, v = random_state(rubbing, seed, size=6e-4)
    now = Instant(0.9 * seed, 1.8, 0.0)
    motion = turned_together(rubbing, now.speed)
    with_friction, without = rubbing.forces(q, v, now), smooth.forces(q, v, now)
    power = sum((with_friction[name] - without[name]) * motion[name] for name in motion)
    carried = sum(abs(rubbing.mesh_state(mesh, q, v, now).elastic) for mesh in names.MESHES)
    assert -1.0 * carried < power < 0  # W; sliding speeds are below 10 m/s and the coefficient below 0.06


def test_torque_chain_of_balanced_meshes() -> None:
    """With every mesh force at its share, u of all gears balances: ring 3 F_I, planets, sun 3 F_II, output."""
    reference = model(friction__enabled=False, **{f"mesh__{s}__error_amplitude": 0.0 for s in names.STAGES})
    bodies, stages = reference.kinematics.bodies, reference.kinematics.stages
    helix = [math.cos(stage.pair.base_helix) for stage in stages]
    first = RATED / (3 * bodies.ring.base_radius * helix[0])
    second = first * helix[0] * bodies.planet_1.base_radius / (bodies.planet_2.base_radius * helix[1])
    third = 3 * second * helix[1] * bodies.sun.base_radius / (bodies.herringbone_1.base_radius * helix[2])
    output = third * helix[2] * bodies.herringbone_2.base_radius
    assert output == pytest.approx(RATED / reference.kinematics.total_ratio, rel=1e-12)
    for mesh, force in zip(names.MESHES, [first] * 3 + [second] * 3 + [third], strict=True):
        h = reference.approach(mesh, 0.3)
        turned = turned_together(reference, 1.0)
        driver = ("ring", "p2", "h1")
        power = force * sum(c.real * turned[name] for name, c in h.items() if name.startswith(driver))
        assert power * (1 if mesh == "III" else 3) == pytest.approx(RATED, rel=1e-12)


def test_stiffness_is_the_first_harmonic_of_the_contact_length() -> None:
    """Stiffness and friction see the same contact lines: phase and signed amplitude agree."""
    reference = model()
    phases = 2 * math.pi * (np.arange(2000) + 0.5) / 2000
    for stage in reference.kinematics.stages:
        lines = (contact_lines(stage, phase) for phase in phases)
        length = np.array([sum(high - low for low, high in line) for line in lines])
        harmonic = 2 * np.mean(length * np.exp(-1j * phases)) / length.mean()
        expected = stage.stiffness.variation * np.exp(-1j * stage.stiffness.phase)
        assert abs(harmonic - expected) < 1e-5
        mean = stage.pair.contact_ratio * stage.pair.overlap_ratio * stage.pair.base_pitch
        assert length.mean() == pytest.approx(mean, rel=1e-5)


def test_friction_coefficient_without_growth_is_exact() -> None:
    """With mu constant, the share is the difference of the contact lengths before and behind the pitch point."""
    reference = model(friction__growth=0.0, friction__decay=0.0)
    for stage in reference.kinematics.stages:
        for phase in (0.2, 2.9, 5.5):
            lines = contact_lines(stage, phase)
            before = sum(min(high, 0.0) - min(low, 0.0) for low, high in lines)
            behind = sum(max(high, 0.0) - max(low, 0.0) for low, high in lines)
            share = sum(weight for _, weight in sliding_friction(reference.configuration.friction, stage, phase, 1.8))
            assert share == pytest.approx(0.05 * (before - behind) / (before + behind), rel=1e-12)


def ring_frequencies(reference: ReferenceModel, *, bending: bool) -> np.ndarray:
    """Natural frequencies (Hz) of the free ring in its plane, with or without the joints' rotational springs."""
    ring = reference.ring
    order = {f"ring.{motion}.{i}": 3 * i + k for i in range(ring.count) for k, motion in enumerate(("w", "v", "psi"))}
    stiffness = np.zeros((len(order), len(order)))
    for h, k, _ in reference.springs():
        row = np.zeros(len(order))
        for name, c in h.items():
            if name in order:
                row[order[name]] = c
        supported = np.count_nonzero(row) == 1
        if not supported and (bending or k != ring.rotational):
            stiffness += k * np.outer(row, row)
    scale = np.array([reference.masses[name] for name in order]) ** -0.5
    return np.sqrt(np.abs(np.linalg.eigvalsh(stiffness * np.outer(scale, scale)))) / (2 * math.pi)


def test_free_ring() -> None:
    """Three rigid motions, then the oval of a thin ring: w^2 = E I / (rho A R^4) n^2 (n^2 - 1)^2 / (n^2 + 1), n = 2."""
    reference = model()
    ring = reference.ring
    frequencies = ring_frequencies(reference, bending=True)
    assert frequencies[2] < 0.01
    thin = math.sqrt(ring.rotational * ring.length / (ring.mass / ring.length * ring.radius**4) * 36 / 5) / (
        2 * math.pi
    )
    assert frequencies[3] == pytest.approx(thin, rel=0.01)
    assert frequencies[4] == pytest.approx(frequencies[3], rel=1e-6)


def test_ring_of_pinned_segments_is_a_mechanism() -> None:
    """Why the joints have a rotational spring, which the paper's don't: M motions without any restoring force."""
    reference = model()
    frequencies = ring_frequencies(reference, bending=False)
    assert frequencies[reference.ring.count - 1] < 0.01
    assert frequencies[reference.ring.count] > 100


def test_degrees_of_freedom() -> None:
    assert len(model().masses) == 463
    assert len(model(ring__segments=37).masses) == 4 * 37 + 63


@pytest.mark.parametrize(("friction", "bound"), [(False, 1e-12), (True, 1e-5)])
@pytest.mark.parametrize("tied", [False, True])
def test_arrays_are_the_same_equations(friction: bool, bound: float, tied: bool) -> None:
    """Also while two segments share a mesh, with teeth apart and on both flanks; friction is tabulated in them."""
    reference = model(friction__enabled=friction, excitation__mode="tied" if tied else "kinematic")
    arrays = ArrayModel(reference, speed=1.8, torque=RATED)
    for seed, time in enumerate((0.0, 0.37, 3.1)):
        q, v = random_state(reference, seed)
        plain = reference.accelerations(q, v, Instant(1.8 * time, 1.8, RATED))
        expected = np.array([plain[name] for name in arrays.names])
        got = arrays.accelerations(
            time, np.array([q[name] for name in arrays.names]), np.array([v[name] for name in arrays.names])
        )
        assert np.max(np.abs(got - expected)) < bound * np.max(np.abs(expected))
