"""The segmented ring against closed forms: thin rings, thick rings, rings on an elastic foundation, order in M."""

import math

import numpy as np
import pytest
import scipy.linalg

from nw_gear_common.tables import Array
from nw_gear_sim.config import load, with_values
from nw_gear_sim.kinematics import derive
from nw_gear_sim.physics.ring import RingLaw, ring_forces, ring_law
from nw_gear_sim.structure import RingSegments

BASE = derive(load()).bodies.ring.base_radius
COUNTS = (25, 50, 100, 200)


def segments(count: int, **ring: float) -> RingSegments:
    """Segments of the gearbox's ring, without supports if not asked for."""
    values = {"ring.segments": count, "ring.radial_support": 0.0, "ring.axial_support": 0.0}
    return derive(with_values(values | {f"ring.{key}": value for key, value in ring.items()}, load())).ring


def law(ring: RingSegments) -> RingLaw:
    return ring_law(
        segments=ring.count,
        radius=ring.radius,
        base_radius=BASE,
        joint=(ring.radial, ring.tangential, ring.rotational, ring.axial),
        damping_time=0.0,
        support=(ring.radial_support, ring.axial_support),
        support_damping=(0.0, 0.0),
        weight=0.0,
        gravity_direction=0.0,
    )


def matrix(ring: RingSegments, size: int) -> Array:
    """Stiffness matrix from the compiled forces, of the first `size` motions over M (3 in the plane, 4 with z)."""
    count, ring_data = ring.count, law(ring)
    out, scratch = np.empty((size * count, size * count)), np.zeros((4, count + 2))
    force, rest, turn = np.empty(4 * count), np.zeros(4 * count), np.array([1.0, 0.0])
    for k in range(size * count):
        q = np.zeros(4 * count)
        q[k] = 1.0
        ring_forces(ring_data, turn, 0.0, q, rest, scratch, force)
        out[:, k] = -force[: size * count]
    return out


def frequencies(ring: RingSegments, size: int = 3) -> Array:
    """All natural frequencies, Hz, ascending."""
    mass = np.repeat([ring.mass, ring.mass, ring.inertia / BASE**2, ring.mass][:size], ring.count)
    squares = scipy.linalg.eigvalsh(matrix(ring, size) / np.sqrt(np.outer(mass, mass)))
    return np.sqrt(np.abs(squares)) / (2 * math.pi)


def thin_ring(n: int, ring: RingSegments, foundation: float = 0.0) -> float:
    """Inextensional bending in the plane on a radial foundation (N/m per m), Hz.

    w^2 = n^2 / (n^2 + 1) [E I (n^2 - 1)^2 / R^4 + k] / (rho A): the textbook's formula for k = 0.
    """
    line_mass, bending = ring.mass / ring.length, ring.rotational * ring.length
    square = n**2 / (n**2 + 1) * (bending * (n**2 - 1) ** 2 / ring.radius**4 + foundation) / line_mass
    return math.sqrt(square) / (2 * math.pi)


def thick_ring(n: int, ring: RingSegments) -> Array:
    """Continuous ring with extension, shear and rotary inertia, harmonic n: its three frequencies, Hz.

    Per unit length E A e^2 + k G A g^2 + E I c^2 with e = (v_t + w) / R, g = (w_t - v) / R + psi, c = psi_t / R and the
    waves w, v, psi = W cos nt, V sin nt, P sin nt.
    """
    r, length = ring.radius, ring.length
    own = ring.inertia / length - ring.mass * length / 12  # without the segment's own length
    strains = np.array([[1 / r, n / r, 0.0], [-n / r, -1 / r, 1.0], [0.0, 0.0, n / r]])
    rigidity = np.diag([ring.tangential, ring.radial, ring.rotational]) * length
    mass = np.diag([ring.mass / length] * 2 + [own])
    squares = scipy.linalg.eigh(strains.T @ rigidity @ strains, mass, eigvals_only=True)
    return np.sqrt(np.abs(squares)) / (2 * math.pi)


def slender(count: int) -> RingSegments:
    """The ring with all of its bending, but as good as no stretch, no shear and no rotary inertia of its section."""
    ring = segments(count)
    stiff = 1e4
    return RingSegments(
        **{
            **vars(ring),
            "tangential": stiff * ring.tangential,
            "radial": stiff * ring.radial,
            "inertia": ring.mass * ring.length**2 / 12,
        }
    )


@pytest.mark.parametrize("count", COUNTS)
def test_three_rigid_motions_and_no_more(count: int, figure) -> None:
    """Two translations and the rotation at zero (up to rounding of the stiffest joints), then the oval."""
    found = frequencies(segments(count))
    assert figure(f"rigid motions of the free ring, M = {count}, Hz", float(found[2])) < 0.05
    assert found[3] > 30


def test_axial_rigid_motion_and_waves() -> None:
    """Axially the ring is a string of masses: f_n = sqrt(k_z / m) sin(pi n / M) / pi, exactly."""
    ring = segments(50)
    z = matrix(ring, 4)[150:, 150:]
    found = np.sqrt(np.abs(scipy.linalg.eigvalsh(z / ring.mass))) / (2 * math.pi)
    closed = np.sort(np.abs(np.sin(math.pi * np.arange(50) / 50))) * math.sqrt(ring.axial / ring.mass) / math.pi
    assert found == pytest.approx(closed, rel=1e-9, abs=1e-4)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_thin_ring(n: int, figure) -> None:
    """f_n = n (n^2 - 1) / sqrt(n^2 + 1) sqrt(E I / (rho A R^4)) / 2 pi, each twice, approached with order 2 in M."""
    errors = []
    for count in COUNTS:
        ring = slender(count)
        pair = frequencies(ring)[2 * n - 1 : 2 * n + 1]
        assert pair[1] == pytest.approx(pair[0], rel=1e-5)
        errors.append(abs(float(pair[0]) / thin_ring(n, ring) - 1))
    assert figure(f"thin ring n = {n}, M = 100, off the closed form", errors[2]) < 3e-4
    order = math.log2(errors[1] / errors[3]) / 2
    assert figure(f"thin ring n = {n}, order in M", order) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_thick_ring(n: int, figure) -> None:
    """The gearbox's own ring against the continuous one with shear, extension and rotary inertia: order 2 in M."""
    errors = []
    for count in COUNTS:
        ring = segments(count)
        errors.append(abs(float(frequencies(ring)[2 * n - 1]) / thick_ring(n, ring)[0] - 1))
    assert figure(f"thick ring n = {n}, M = 100, off the closed form", errors[2]) < 3e-4
    order = math.log2(errors[1] / errors[3]) / 2
    assert figure(f"thick ring n = {n}, order in M", order) == pytest.approx(2, abs=0.1)


def test_breathing_ring() -> None:
    """n = 0: w^2 = E A / (rho A R^2), the segments' chords being c = cos(pi / M), s = sin(pi / M) short of the arc."""
    ring = segments(100)
    closed = math.sqrt(ring.tangential * ring.length / (ring.mass / ring.length)) / ring.radius / (2 * math.pi)
    found = frequencies(ring)
    assert np.min(np.abs(found / closed - 1)) < 1e-3


@pytest.mark.parametrize("n", [2, 3, 4])
def test_ring_on_a_radial_foundation(n: int, figure) -> None:
    """w^2 = n^2 / (n^2 + 1) [E I (n^2 - 1)^2 / R^4 + k] / (rho A), k = 2 K / (2 pi R) for a support K.

    n = 1 is the whole ring moving on K.
    """
    ring, support = slender(200), 5e9
    ring = RingSegments(**{**vars(ring), "radial_support": 2 * support / ring.count})
    found = frequencies(ring)
    along = math.sqrt(support / (ring.mass * ring.count)) / (2 * math.pi)
    assert found[0] < 0.05
    closed = thin_ring(n, ring, 2 * support / (2 * math.pi * ring.radius))
    nearest = float(np.min(np.abs(found / closed - 1)))
    assert figure(f"ring on a foundation, n = {n}, M = 200, off the closed form", nearest) < 1e-3
    assert np.min(np.abs(found / along - 1)) < 1e-3


def test_static_ovalisation() -> None:
    """Two opposite pulls P: the diameter grows by P R^3 (pi/4 - 2/pi) / (E I), the textbook's thin ring."""
    ring = slender(200)
    stiffness, count, pull = matrix(ring, 3), ring.count, 1e5
    force = np.zeros(3 * count)
    force[[0, count // 2]] = pull
    q = scipy.linalg.lstsq(stiffness, force, cond=1e-13)[0]
    closed = pull * ring.radius**3 * (math.pi / 4 - 2 / math.pi) / (ring.rotational * ring.length)
    assert q[0] + q[count // 2] == pytest.approx(closed, rel=5e-3)
