"""The reference equations hold what mechanics demands, and the fast right-hand side agrees with them."""

import math

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_sim.config import load, with_values
from nw_gear_sim.physics.friction import friction_share
from test.sim.fast_model import FRICTION_ERROR, ROLLER_ERROR, FastModel
from test.sim.reference_model import Instant, ReferenceModel

CONFIGURATION = load()
SMOOTH = {f"mesh.{stage}.error_amplitude": 0.0 for stage in names.STAGES}
RATED = 4.3e6
ROUNDING = 5e-12
"""Relative to the largest force of its kind; phases of some thousand radians cost digits."""


def model(**values: object) -> ReferenceModel:
    return ReferenceModel(with_values({key.replace("__", "."): value for key, value in values.items()}, CONFIGURATION))


def at_rest(reference: ReferenceModel) -> dict[str, float]:
    return dict.fromkeys(reference.masses, 0.0)


def turned_together(reference: ReferenceModel, rotation: float) -> dict[str, float]:
    """The ring turned by an angle, and every gear by what its teeth demand."""
    q, bodies, ring = at_rest(reference), reference.kinematics.bodies, reference.ring
    for i in range(ring.count):
        q[f"ring.v.{i}"], q[f"ring.psi.{i}"] = ring.radius * rotation, rotation
    u = bodies.ring.base_radius * rotation
    q |= {f"p1_{j}.u": u for j in (1, 2, 3)}
    u *= bodies.planet_2.base_radius / bodies.planet_1.base_radius
    q |= {f"p2_{j}.u": u for j in (1, 2, 3)} | {"s.u": u}
    u *= bodies.herringbone_1.base_radius / bodies.sun.base_radius
    return q | {"h1.u": u, "h2.u": u}


def shifted_together(
    reference: ReferenceModel, shift: np.ndarray, now: Instant
) -> tuple[dict[str, float], dict[str, float]]:
    """The whole gearbox moved without turning, at rest there: coordinates, and rates in the ring's turning frame."""
    q, v = at_rest(reference), at_rest(reference)
    for name in q:
        if name.split(".")[1] in "xyz" and not name.startswith("ring"):
            q[name] = float(shift["xyz".index(name[-1])])
    for i in range(reference.ring.count):
        angle = now.angle.real + i * reference.ring.pitch
        outward = shift[0] * math.cos(angle) + shift[1] * math.sin(angle)
        along = shift[1] * math.cos(angle) - shift[0] * math.sin(angle)
        q[f"ring.w.{i}"], q[f"ring.v.{i}"], q[f"ring.z.{i}"] = outward, along, float(shift[2])
        v[f"ring.w.{i}"], v[f"ring.v.{i}"] = along * now.speed, -outward * now.speed
    return q, v


def random_state(reference: ReferenceModel, seed: int, size: float = 3e-4) -> tuple[dict[str, float], dict[str, float]]:
    """Displacements of a few backlashes and rates of vibration; both flanks and open bearings occur."""
    rng = np.random.default_rng(seed)
    q = {name: size * rng.standard_normal() for name in reference.masses}
    return q, {name: 30 * size * rng.standard_normal() for name in reference.masses}


# --- what mechanics demands -------------------------------------------------------------------------------------------


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
        lines = (reference.contact_lines(stage, phase) for phase in phases)
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
            lines = reference.contact_lines(stage, phase)
            before = sum(min(high, 0.0) - min(low, 0.0) for low, high in lines)
            behind = sum(max(high, 0.0) - max(low, 0.0) for low, high in lines)
            share = sum(weight for _, weight in reference.sliding_friction(stage, phase, 1.8))
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


# --- the fast right-hand side -----------------------------------------------------------------------------------------


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
            points = np.array(reference.sliding_friction(stage, phase, speed))
            expected = points[:, 1].sum(), (points[:, 0] * points[:, 1]).sum()
            assert friction_share(law, k, phase, speed) == pytest.approx(expected, abs=1e-11)


def test_fast_equilibrium_is_one() -> None:
    reference = model(friction__enabled=False)
    q = FastModel(reference).equilibrium(RATED)
    forces = reference.forces(q, at_rest(reference), Instant(0.0, 0.0, RATED))
    lever = reference.kinematics.bodies.ring.base_radius
    assert max(abs(f) / (lever if "psi" in name else 1) for name, f in forces.items()) < 0.02  # N, of 1.2e6 N per mesh


def test_degrees_of_freedom() -> None:
    assert len(model().masses) == 463
    assert len(model(ring__segments=37).masses) == 4 * 37 + 63
