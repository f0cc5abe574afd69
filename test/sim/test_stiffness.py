"""Mesh and roller stiffness against hand calculations and against counting the contact length."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nw_gear_sim.config import load, with_values
from nw_gear_sim.kinematics import Kinematics, derive
from nw_gear_sim.stiffness import roller_stiffness, stiffness_variation, tooth_stiffness, transverse_stiffness

CONFIGURATION = load()
KINEMATICS: Kinematics = derive(CONFIGURATION)

# Hand calculation: c' (N/(mm um)), mean c_gamma, K_m (N/m), K along the normal, first harmonic, M_e (kg).
HAND = {
    "I": (14.34, 20.18, 1.13e10, 1.135e10, -0.289, 628.5),
    "II": (14.31, 22.38, 9.18e9, 9.31e9, 0.0056, 328.5),
    "III": (11.20, 16.29, 5.95e9, 8.06e9, 0.0094, 67.2),
}


@pytest.mark.parametrize("name", HAND)
def test_hand_numbers(name: str) -> None:
    single, mesh, transverse, normal, variation, effective_mass = HAND[name]
    stage = KINEMATICS.stage(name)
    toothing = getattr(CONFIGURATION.toothing, name)
    assert tooth_stiffness(stage.pair, toothing) * 1e-9 == pytest.approx(single, rel=5e-4)
    assert transverse_stiffness(stage.pair, toothing) / toothing.face_width * 1e-9 == pytest.approx(mesh, rel=5e-4)
    assert stage.stiffness.transverse == pytest.approx(transverse, rel=1e-3)
    assert stage.stiffness.normal == pytest.approx(normal, rel=1e-3)
    assert stage.stiffness.variation == pytest.approx(variation, rel=6e-3)
    assert stage.stiffness.effective_mass == pytest.approx(effective_mass, rel=1e-3)


def contact_length(eps_alpha: float, eps_beta: float, phase: np.ndarray) -> Any:
    """Length of all contact lines over that of one across the whole face, counted line by line at some mesh phases.

    A tooth that entered n mesh periods ago has been in contact, at a share l of the face, since n - l eps_beta
    periods, and leaves after eps_alpha periods.
    """
    across = (np.arange(400) + 0.5) / 400
    turns = phase[:, None] / (2 * np.pi) + np.arange(-1, math.ceil(eps_alpha + eps_beta) + 1)
    progress = turns[:, :, None] - across * eps_beta
    return ((progress > 0) & (progress < eps_alpha)).mean(axis=2).sum(axis=1)


@pytest.mark.parametrize("name", HAND)
def test_variation_is_the_first_harmonic_of_the_counted_contact_length(name: str) -> None:
    stage = KINEMATICS.stage(name)
    phase = 2 * np.pi * (np.arange(2000) + 0.5) / 2000
    length = contact_length(stage.pair.contact_ratio, stage.pair.overlap_ratio, phase)
    assert length.mean() == pytest.approx(stage.pair.contact_ratio, rel=1e-3)
    harmonic = 2 * np.mean(length * np.exp(-1j * phase)) / length.mean()
    expected = stage.stiffness.variation * np.exp(-1j * stage.stiffness.phase)
    assert harmonic == pytest.approx(expected, abs=1.5e-3)


@pytest.mark.parametrize(("contact_ratio", "variation"), [(1.875, 0.092), (1.8, 0.147), (1.542, 0.289)])
def test_variation_of_stage_one_depends_on_its_contact_ratio(contact_ratio: float, variation: float) -> None:
    pair = replace(KINEMATICS.stage("I").pair, contact_ratio=contact_ratio)
    assert abs(stiffness_variation(pair)) == pytest.approx(variation, abs=6e-4)


def test_whole_contact_ratio_leaves_no_variation() -> None:
    assert stiffness_variation(replace(KINEMATICS.stage("I").pair, contact_ratio=2.0)) == pytest.approx(0.0, abs=1e-15)


def test_given_values_stand_before_computed_ones() -> None:
    given = derive(with_values({"mesh.II.stiffness": 4e9, "mesh.II.stiffness_variation": -0.4}, CONFIGURATION)).stages[
        1
    ]
    assert given.stiffness.transverse == 4e9
    assert given.stiffness.variation == -0.4


def test_damping_ratio_of_the_pair() -> None:
    """A free pair on its mesh spring, M_e y'' + cos^2(beta_b) (C y' + K y) = 0, has the damping ratio asked for."""
    for stage in KINEMATICS.stages:
        square = math.cos(stage.pair.base_helix) ** 2
        stiffness, damping = stage.stiffness.normal * square, stage.stiffness.damping * square
        ratio = damping / (2 * math.sqrt(stiffness * stage.stiffness.effective_mass))
        assert ratio == pytest.approx(stage.mesh.damping_ratio, rel=1e-12)


@pytest.mark.parametrize(("kind", "stiffness"), [("pb1", 4.82e9), ("pb2", 4.82e9), ("sb", 3.95e9), ("b1", 3.95e9),
                                                 ("b21", 3.51e9), ("b22", 3.51e9)])  # fmt: skip
def test_roller_stiffness(kind: str, stiffness: float) -> None:
    assert KINEMATICS.roller_stiffness[kind] == pytest.approx(stiffness, rel=1e-3)


def test_roller_contacts_in_series() -> None:
    """Two line contacts, each delta = (Q/K)^(9/10) in mm and N, carry Q at the sum of their approaches."""
    bearing, load = CONFIGURATION.bearings.sb, 1e4
    one = (load / (8.06e4 * 80 ** (8 / 9))) ** 0.9
    approach = 2 * one * 1e-3
    assert roller_stiffness(bearing, 10 / 9) * approach ** (10 / 9) == pytest.approx(load, rel=1e-12)


def test_given_roller_stiffness() -> None:
    assert roller_stiffness(replace(CONFIGURATION.bearings.sb, stiffness=1e9), 10 / 9) == 1e9
