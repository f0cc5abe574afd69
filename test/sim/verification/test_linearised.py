"""Stiffness, damping and modes against matrices that were put together independently, and how they depend on M."""

import math

import numpy as np
import pytest
import scipy.linalg

from nw_gear_common.tables import Array
from nw_gear_sim.config import load, with_values
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.kinematics import derive
from nw_gear_sim.linear import find_modes
from test.sim.gearboxes import RATED_TORQUE, WITHOUT_FRICTION, at_rest, make
from test.sim.verification.independent import Independent

SMOOTH = load()


def independent(**values: object) -> Independent:
    return Independent(with_values({key.replace("__", "."): value for key, value in values.items()}, SMOOTH))


@pytest.mark.parametrize("load_share", [1.0, 0.2])
@pytest.mark.parametrize("angle", [0.0, 1.9])
def test_symmetric_without_friction(angle: float, load_share: float, figure) -> None:
    """K and C to 1e-8 of their largest entry; C takes energy out of every motion."""
    gearbox = make(*WITHOUT_FRICTION)
    q = find_equilibrium(gearbox, load_share * RATED_TORQUE, angle=angle).q
    gearbox.set_instant(load_share * RATED_TORQUE, 0.0, angle, static=True)
    for name, matrix in (("K", gearbox.stiffness(q)), ("C", gearbox.damping(q))):
        off = float(np.max(np.abs(matrix - matrix.T)) / np.max(np.abs(matrix)))
        assert figure(f"asymmetry of {name}", off) < 1e-8
        scaled = 0.5 * (matrix + matrix.T) / np.sqrt(np.outer(gearbox.mass, gearbox.mass))
        lowest, *_, highest = scipy.linalg.eigvalsh(scaled)
        assert lowest > -1e-9 * highest


@pytest.mark.parametrize("angle", [0.0, 0.777])
def test_matrices_spring_by_spring(angle: float, figure) -> None:
    """Difference quotients of the compiled forces against sums of k h h^T over meshes, joints, springs and rollers."""
    gearbox, other = make(*WITHOUT_FRICTION), independent(friction__enabled=False)
    q = find_equilibrium(gearbox, RATED_TORQUE, angle=angle).q
    gearbox.set_instant(RATED_TORQUE, 0.0, angle, static=True)
    K, C = other.tangent(q, angle)
    assert figure("K, off the assembled one", off_by(gearbox.stiffness(q), K)) < 1e-7
    assert figure("C, off the assembled one", off_by(gearbox.damping(q), C)) < 1e-9
    assert gearbox.mass == pytest.approx(other.mass, rel=1e-13)


def off_by(found: Array, expected: Array) -> float:
    return float(np.max(np.abs(found - expected)) / np.max(np.abs(expected)))


def test_modes_of_the_assembled_eigenproblem(figure) -> None:
    """All 463 undamped frequencies of the fast model are those of the independent K and M; damped ones too."""
    (gearbox, found), other = at_rest(*WITHOUT_FRICTION), independent(friction__enabled=False)
    K, C = other.tangent(found.q)
    scale = 1 / np.sqrt(np.outer(other.mass, other.mass))
    ours = gearbox.stiffness(found.q) * scale
    expected = np.sqrt(np.abs(scipy.linalg.eigvalsh(K * scale))) / (2 * math.pi)
    measured = np.sqrt(np.abs(scipy.linalg.eigvalsh(0.5 * (ours + ours.T)))) / (2 * math.pi)
    off = float(np.max(np.abs(measured / expected - 1)))
    assert figure("undamped frequencies, off the assembled problem's", off) < 1e-6
    size = len(K)
    system = np.block([[np.zeros((size, size)), np.eye(size)], [-K * scale, -C * scale]])
    eigenvalues = scipy.linalg.eigvals(system)
    pairs = np.sort(np.abs(eigenvalues[eigenvalues.imag > 0])) / (2 * math.pi)
    damped = find_modes(gearbox, found.q).frequencies_hz
    off = float(np.max(np.abs(np.sort(damped) / pairs - 1)))
    assert figure("damped frequencies, off the assembled problem's", off) < 1e-6


def low_modes(segments: int) -> tuple[Array, Array]:
    """The twenty lowest undamped frequencies at rated torque (Hz), and the elongations of the meshes (m)."""
    gearbox: Gearbox = make(*WITHOUT_FRICTION, ("ring.segments", segments))
    q = find_equilibrium(gearbox, RATED_TORQUE).q
    gearbox.set_instant(RATED_TORQUE, 0.0, static=True)
    gearbox.forces(q, 0 * q)
    x = gearbox.contact.x.copy()
    K = gearbox.stiffness(q) / np.sqrt(np.outer(gearbox.mass, gearbox.mass))
    squares = scipy.linalg.eigh(0.5 * (K + K.T), eigvals_only=True, subset_by_index=[0, 19])
    return np.sqrt(squares) / (2 * math.pi), x


def test_low_modes_dont_depend_on_the_number_of_segments(figure) -> None:
    """M = 25, 50, 100 within 2 % of M = 200, doubling M from the default changes the statics by less than 1 %."""
    finest, x_finest = low_modes(200)
    for segments in (25, 50, 100):
        frequencies, x = low_modes(segments)
        off = float(np.max(np.abs(frequencies / finest - 1)))
        assert figure(f"twenty lowest modes, M = {segments} against 200", off) < 0.02
        if segments == 100:
            moved = float(np.max(np.abs(x / x_finest - 1)))
            assert figure("elongations at rest, M = 100 against 200", moved) < 0.01


def test_highest_mode_grows_with_the_number_of_segments() -> None:
    """The joints' own waves: twice as many segments, half as long, make the highest frequency twice as high."""
    highest = []
    for segments in (50, 100):
        ring = derive(with_values({"ring.segments": segments}, SMOOTH)).ring
        highest.append(math.sqrt(4 * ring.tangential / ring.mass))
    assert highest[1] / highest[0] == pytest.approx(2, rel=0.01)
    gearbox, found = at_rest(*WITHOUT_FRICTION)
    assert find_modes(gearbox, found.q).largest_eigenvalue == pytest.approx(highest[1], rel=0.01)
