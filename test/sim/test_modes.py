"""Shapes, energies and names of modes, against the eigenproblem itself, closed forms and an independent assembly."""

import math
from functools import cache

import numpy as np
import pytest
import scipy.linalg

from nw_gear_common.tables import Array
from nw_gear_sim.config import load, with_values
from nw_gear_sim.elements import Element, find_elements, rigid_motions
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.kinematics import derive
from nw_gear_sim.linear import Linearised, Modes, Shapes, find_shapes, linearise, lowest_modes
from nw_gear_sim.participation import Participation, complexity, participations
from nw_gear_sim.remarks import remarks
from test.sim.gearboxes import WITHOUT_FRICTION, WITHOUT_LOSSES, at_rest
from test.sim.verification.independent import Independent


@cache
def solved(*values: tuple[str, object]) -> tuple[Gearbox, Linearised, Modes, Shapes, list[Element]]:
    gearbox, found = at_rest(*values)
    linear = linearise(gearbox, found.q)
    return gearbox, linear, *find_shapes(linear), find_elements(gearbox, found.q)


def parts(gearbox: Gearbox, shapes: Shapes, elements: list[Element]) -> list[Participation]:
    return participations(shapes, gearbox.mass, gearbox.layout, elements, rigid_motions(gearbox))


@pytest.mark.parametrize("values", [(), WITHOUT_FRICTION])
def test_shapes_solve_the_eigenproblem(values: tuple[tuple[str, object], ...]) -> None:
    """(lambda^2 M + lambda C + K) x = 0 for the lowest 200 pairs, to rounding of the stiffest spring's force."""
    _, linear, _, shapes, _ = solved(*values)
    x, rate = shapes.vectors[:, :200], shapes.eigenvalues[:200]
    left = linear.mass[:, None] * x * rate**2 + linear.damping @ x * rate + linear.stiffness @ x
    assert np.max(np.abs(left)) < 1e-9 * np.max(np.abs(linear.stiffness)) * np.max(np.abs(x))


def test_shapes_are_normalised() -> None:
    """Modal mass 1 kg; sum m x^2 real and positive, which is where the imaginary part is smallest."""
    gearbox, _, _, shapes, _ = solved()
    assert np.sum(gearbox.mass[:, None] * np.abs(shapes.vectors) ** 2, axis=0) == pytest.approx(1, rel=1e-12)
    square = np.sum(gearbox.mass[:, None] * shapes.vectors**2, axis=0)
    assert np.all(square.real > 0)
    assert np.max(np.abs(square.imag)) < 1e-12
    smallest = complexity(shapes, gearbox.mass)
    for turn in (0.1, -0.1, math.pi / 2):
        turned = Shapes(shapes.eigenvalues, shapes.vectors * np.exp(1j * turn))
        assert np.all(complexity(turned, gearbox.mass) >= smallest - 1e-12)


def test_everything_agrees_with_an_independent_assembly() -> None:
    """Frequencies, damping ratios, largest eigenvalue: the numbers of the JSON, to 1e-6."""
    gearbox, _, modes, _, _ = solved(*WITHOUT_FRICTION)
    _, found = at_rest(*WITHOUT_FRICTION)
    other = Independent(with_values(dict(WITHOUT_FRICTION), load()))
    K, C = other.tangent(found.q)
    scale = 1 / np.sqrt(np.outer(other.mass, other.mass))
    size = gearbox.layout.size
    system = np.block([[np.zeros((size, size)), np.eye(size)], [-K * scale, -C * scale]])
    eigenvalues = scipy.linalg.eigvals(system)
    pairs = eigenvalues[eigenvalues.imag > 0]
    pairs = pairs[np.argsort(np.abs(pairs))]
    assert modes.frequencies_hz == pytest.approx(np.abs(pairs) / (2 * math.pi), rel=1e-6)
    assert modes.damping_ratio[:60] == pytest.approx((-pairs.real / np.abs(pairs))[:60], rel=1e-6)
    assert modes.largest_eigenvalue == pytest.approx(np.max(np.abs(eigenvalues)), rel=1e-6)
    z = modes.largest_stable_step * eigenvalues
    growth = np.abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24)
    assert growth.max() == pytest.approx(1, abs=1e-6)
    longer = 1.001 * z
    assert np.abs(1 + longer + longer**2 / 2 + longer**3 / 6 + longer**4 / 24).max() > 1


@pytest.mark.parametrize("values", [(), WITHOUT_FRICTION])
def test_reduced_problem(values: tuple[tuple[str, object], ...]) -> None:
    """The lowest modes alone: 1e-5 with the default basis, exact with all undamped modes."""
    _, linear, _, shapes, _ = solved(*values)
    assert lowest_modes(linear, 40).eigenvalues == pytest.approx(shapes.eigenvalues[:40], rel=1e-5)
    whole = lowest_modes(linear, 40, basis=len(linear.mass))
    assert whole.eigenvalues == pytest.approx(shapes.eigenvalues[:40], rel=1e-8)


def test_elements_add_up_to_the_stiffness() -> None:
    """Meshes, rollers, springs and joints against the difference quotients of the whole right-hand side."""
    _, linear, _, _, elements = solved(*WITHOUT_FRICTION)
    total = np.zeros_like(linear.stiffness)
    for element in elements:
        element.add_to(total)
    assert np.max(np.abs(total - linear.stiffness)) < 1e-8 * np.max(np.abs(linear.stiffness))


def test_energies_are_the_eigenvalues() -> None:
    """Without damping and friction: the elements' energy over the kinetic one is omega^2 (Rayleigh), shares add up."""
    gearbox, _, _, shapes, elements = solved(*WITHOUT_LOSSES)
    stored = np.sum([element.energy(shapes.vectors) for element in elements], axis=0)
    assert stored[:300] == pytest.approx(np.abs(shapes.eigenvalues[:300]) ** 2, rel=1e-6)
    for mode in parts(gearbox, shapes.first(30), elements):
        for shares in (mode.kinds, mode.kinetic, mode.strain, mode.strain_groups):
            assert sum(shares.values()) == pytest.approx(1, rel=1e-9)
            assert min(shares.values()) >= 0
        assert sum(mode.ring_harmonics) <= mode.kinetic["ring"] * (1 + 1e-9)


def test_effective_masses_add_up() -> None:
    """Over all undamped modes they are the whole mass, for any rigid motion."""
    gearbox, _, _, shapes, elements = solved(*WITHOUT_LOSSES)
    assert shapes.vectors.shape[1] == gearbox.layout.size
    modes = parts(gearbox, shapes, elements)
    for motion in ("x", "y", "z", "rotation"):
        assert sum(mode.effective[motion] for mode in modes) == pytest.approx(1, rel=1e-6)


def test_rigid_motions_strain_only_what_holds_them() -> None:
    gearbox, _, _, _, elements = solved(*WITHOUT_FRICTION)
    for name, motion in rigid_motions(gearbox).items():
        strained = {e.name for e in elements if e.energy(motion[:, None])[0] > 1.0}  # of some 1e9 J
        if name == "rotation":
            assert strained == {"generator"}
        elif name == "z":  # the herringbone has no axial motion, its partner has
            assert strained <= {"ring axial support"} | {e.name for e in elements if e.group == "bearings"}
        else:
            assert strained <= {"ring radial support"} | {e.name for e in elements if e.group == "bearings"}
            assert "ring radial support" in strained


def one(gearbox: Gearbox, motion: Array) -> Participation:
    """A single motion taken as a mode."""
    vector = motion / math.sqrt(gearbox.mass @ motion**2)
    shapes = Shapes(np.array([1j]), vector[:, None].astype(complex))
    return parts(gearbox, shapes, solved()[4])[0]


@pytest.mark.parametrize("n", [2, 3, 7])
def test_ring_modes_are_recognised(n: int) -> None:
    """The inextensional mode of a thin ring: w = n cos n phi, v = -sin n phi."""
    gearbox = solved()[0]
    phi = 2 * math.pi * np.arange(gearbox.layout.segments) / gearbox.layout.segments
    motion = np.zeros(gearbox.layout.size)
    motion[gearbox.layout.ring("w")], motion[gearbox.layout.ring("v")] = n * np.cos(n * phi), -np.sin(n * phi)
    found = one(gearbox, motion)
    assert (found.kind, found.harmonic, found.name) == ("ring in plane", n, f"ring n = {n}")
    assert found.ring_harmonics[n] == pytest.approx(1)
    axial = np.zeros(gearbox.layout.size)
    axial[gearbox.layout.ring("z")] = np.cos(n * phi)
    found = one(gearbox, axial)
    assert (found.kind, found.harmonic, found.name) == ("ring axial", n, f"ring n = {n}, axial")


def test_rigid_motions_are_recognised() -> None:
    gearbox = solved()[0]
    kinds = {"x": "translational", "y": "translational", "z": "axial", "rotation": "rotational"}
    for name, motion in rigid_motions(gearbox).items():
        found = one(gearbox, motion)
        assert found.kind == kinds[name]
        assert found.kinds[found.kind] == pytest.approx(1)
        assert found.effective[name] == pytest.approx(1)


def test_planets_alike() -> None:
    """All three outwards: alike. All three along x: not at all, the motion runs around them."""
    gearbox = solved()[0]
    outwards, along = np.zeros(gearbox.layout.size), np.zeros(gearbox.layout.size)
    for j in range(3):
        node = gearbox.layout.planet("p2", j)
        outwards[node.x], outwards[node.y] = math.cos(2 * math.pi * j / 3), math.sin(2 * math.pi * j / 3)
        along[node.x] = 1.0
    assert one(gearbox, outwards).planets_in_phase == pytest.approx(1)
    assert one(gearbox, along).planets_in_phase == pytest.approx(0, abs=1e-12)


def test_known_modes_at_rated_torque() -> None:
    """What the lowest ones are: the whole train on the generator's spring first, planets axially, the ring at last."""
    gearbox, _, modes, shapes, elements = solved(*WITHOUT_FRICTION)
    found = parts(gearbox, shapes.first(24), elements)
    assert modes.frequencies_hz[:7] == pytest.approx([38.5, 58.25, 58.58, 59.24, 65.7, 79.9, 94.2], abs=0.25)
    assert found[0].kind == "rotational"
    assert found[0].effective["rotation"] > 0.9
    assert max(found[0].strain, key=lambda name: found[0].strain[name]) == "generator"
    assert [mode.kind for mode in found[1:4]] == ["axial"] * 3
    assert found[6].strain["ring axial support"] > 0.95
    on_supports = np.sqrt(gearbox.laws.ring.axial_support / gearbox.mass[gearbox.layout.ring("z")][0]) / (2 * math.pi)
    assert modes.frequencies_hz[6] == pytest.approx(on_supports, rel=0.02)


def test_remarks() -> None:
    def said(**values: object) -> list[str]:
        configuration = with_values({key.replace("__", "."): value for key, value in values.items()}, load())
        return remarks(configuration, derive(configuration))

    assert said() == []
    assert "the mesh frequency of stage I" in said(ring__segments=91)[0]
    assert "2 times the mesh frequency" in said(ring__segments=182)[0]
    assert said(ring__segments=12) == [
        "ring.segments: 12 are few; the lowest natural frequencies are off by more than 2 %"
    ]
