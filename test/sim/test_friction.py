"""Tooth friction against brute-force integration along every contact line, and its power."""

import math

import numpy as np
import pytest

from nw_gear_sim.assembly import assemble
from nw_gear_sim.config import load, with_values
from nw_gear_sim.kinematics import derive
from nw_gear_sim.physics.friction import PHASES, FrictionLaw, empty_table, fill_table, friction_share, look_up
from test.sim.gearboxes import RATED_SPEED

CONFIGURATION = load()
KINEMATICS = derive(CONFIGURATION)
LAW: FrictionLaw = assemble(CONFIGURATION, "kinematic")[0].friction
PATHS = [(61.09, 66.67), (40.30, 43.00), (25.47, 31.30)]


def brute_force(stage: int, phase: float, speed: float, points: int = 4001) -> tuple[float, float]:
    """Average over the face width, tooth by tooth, of the points inside the path of contact."""
    pitch, overlap = LAW.pitch[stage], LAW.overlap[stage]
    across = (np.arange(points) + 0.5) / points
    teeth = np.arange(-1, math.ceil((LAW.approach[stage] + LAW.recess[stage]) / pitch + overlap) + 1)
    s = -LAW.approach[stage] + pitch * (phase / (2 * math.pi) + teeth[:, None] - overlap * across)
    s = s[(s > -LAW.approach[stage]) & (s < LAW.recess[stage])]
    sliding = np.abs(s) * LAW.sliding[stage] * speed
    mu = 0.05 * np.exp(-0.125 * sliding) + 0.002 * np.sqrt(sliding)
    return float(np.mean(np.sign(-s) * mu)), float(np.mean(np.sign(-s) * mu * s))


@pytest.mark.parametrize("stage", [0, 1, 2])
def test_path_of_contact(stage: int) -> None:
    """Unequal tips: the pitch point isn't in the middle of any path."""
    assert (LAW.approach[stage] * 1e3, LAW.recess[stage] * 1e3) == pytest.approx(PATHS[stage], abs=0.01)


def test_sliding_speeds() -> None:
    """|V| = s (w_1 + w_2), with the difference in the internal mesh, at rated speed."""
    speeds = np.array([17.3, 71.559, 148.485, 972.58]) * 2 * math.pi / 60
    expected = [speeds[1] - speeds[0], speeds[1] + speeds[2], speeds[2] + speeds[3]]
    assert LAW.sliding * RATED_SPEED == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("speed", [0.2 * RATED_SPEED, RATED_SPEED, 2 * RATED_SPEED])
@pytest.mark.parametrize("stage", [0, 1, 2])
def test_integral_over_the_contact_lines(stage: int, speed: float) -> None:
    for phase in np.linspace(0, 2 * math.pi, 17):
        force, moment = friction_share(LAW, stage, phase, speed)
        expected_force, expected_moment = brute_force(stage, phase, speed)
        assert force == pytest.approx(expected_force, abs=3e-5)
        assert moment == pytest.approx(expected_moment, rel=3e-3)


def test_contact_length_agrees_with_the_stiffness() -> None:
    """K follows the length of the contact lines: its first harmonic and phase come from the same lines as friction."""
    for stage, kinematic in enumerate(KINEMATICS.stages):
        phases = 2 * math.pi * (np.arange(2000) + 0.5) / 2000
        pitch, overlap = LAW.pitch[stage], LAW.overlap[stage]
        lengths = []
        for phase in phases:
            head = -LAW.approach[stage] + pitch * (phase / (2 * math.pi) + np.arange(10))
            inside = np.minimum(head, LAW.recess[stage]) - np.maximum(head - overlap * pitch, -LAW.approach[stage])
            lengths.append(np.sum(np.maximum(inside, 0)))
        harmonic = 2 * np.mean(np.array(lengths) * np.exp(-1j * phases)) / np.mean(lengths)
        stiffness = kinematic.stiffness
        assert harmonic == pytest.approx(stiffness.variation * np.exp(-1j * stiffness.phase), abs=1e-5)


def test_table_error() -> None:
    """Between the table's phases, against the exact integrals: kinks where lines enter, pass the pitch point, leave."""
    table = empty_table()
    fill_table(LAW, RATED_SPEED, table)
    assert table.shape == (3, 2, PHASES + 1)
    for stage in range(3):
        phases = np.random.default_rng(4).uniform(-20, 20, 400)
        found = np.array([look_up(table, table, 0.3, stage, phase) for phase in phases])
        exact = np.array([friction_share(LAW, stage, phase % (2 * math.pi), RATED_SPEED) for phase in phases])
        error = np.abs(found - exact) / [0.05, np.mean(np.abs(exact[:, 1]))]
        assert np.max(error) < 0.025
        assert np.sqrt(np.mean(error**2)) < 0.002


def test_friction_fades_at_standstill() -> None:
    table = empty_table()
    fill_table(LAW, 0.0, table)
    assert np.all(table == 0.0)


def test_off_is_off() -> None:
    law = assemble(with_values({"friction.enabled": False}, CONFIGURATION), "kinematic")[0].friction
    assert friction_share(law, 0, 1.0, RATED_SPEED) == (0.0, 0.0)


def test_spur_teeth() -> None:
    """Without overlap single teeth carry at once; the integral stays finite and bounded by mu."""
    law = LAW._replace(overlap=np.zeros(3))
    for phase in np.linspace(0, 6.28, 50):
        force, moment = friction_share(law, 1, phase, RATED_SPEED)
        assert abs(force) <= 0.0525
        assert moment < 0
