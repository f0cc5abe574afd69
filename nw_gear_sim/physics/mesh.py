"""Gear meshes: each one follows from a single scalar elongation x = h^T q + e (paper Eqs 3, 10, 29-35).

The generalised force on every motion is -h F, F = K(phase) f(x, b) + C x', with the backlash function f; so action and
reaction balance by construction. The transmission error and the stiffness are first harmonics of the mesh phase:

    K = K_m [1 + k cos psi],   e = e_a + e_r sin psi

with k >= 0 and psi = mesh phase - phase of the largest stiffness, 0 for planet 1 where the ring's angle is 0.

Friction acts along `slide` with G = g K |f| and along `roll` with G_1 = g_1 K |f| (see `friction`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import fused, kernel

WIDTH = 12
"""Most motions a mesh takes part in: two ring segments with four each, and a gear with four."""

Indices = npt.NDArray[np.int64]


class MeshLaw(NamedTuple):
    """Data of the seven meshes, arrays of shape (7,) if not said otherwise.

    Attributes:
        stage: 0, 1, 2; phase_offset: what the mesh phase (0 at tooth entry) is more than psi of planet 1, rad.
        stiffness: mean K along the normal, N/m; stiffness_cos, stiffness_sin: its first harmonic, N/m.
        error_mean, error_cos, error_sin: of the transmission error, m.
        damping: C, N s/m; backlash: b, m; entries: used in the rows.
        damping_in_gap: whether C x' acts inside the gap too (paper Eq 35).
    """

    stage: Indices
    phase_offset: Array
    stiffness: Array
    stiffness_cos: Array
    stiffness_sin: Array
    error_mean: Array
    error_cos: Array
    error_sin: Array
    damping: Array
    backlash: Array
    entries: Indices
    damping_in_gap: bool


class Rows(NamedTuple):
    """Rows of the meshes, arrays of shape (7, WIDTH): places in q, h, and the rows of friction.

    `drift` is the time derivative of h, so that x' = h^T v + drift^T q + e'; nonzero where ring segments pass.
    """

    place: Indices
    normal: Array
    slide: Array
    roll: Array
    drift: Array


class Contact(NamedTuple):
    """What the meshes do, arrays of shape (7,): x (m), its rate (m/s), whole force and elastic force (N)."""

    x: Array
    rate: Array
    force: Array
    elastic: Array


def empty_rows() -> Rows:
    """Return rows of zeros."""
    shape = (7, WIDTH)
    return Rows(np.zeros(shape, np.int64), np.zeros(shape), np.zeros(shape), np.zeros(shape), np.zeros(shape))


@kernel
def backlash_function(x: float, b: float) -> float:
    """Deflection of the teeth at an elongation x with half backlash b, m (paper Eq 10)."""
    if x > b:
        return x - b
    if x < -b:
        return x + b
    return 0.0


@kernel
def excite(law: MeshLaw, mesh: int, cos: float, sin: float, rate: float) -> tuple[float, float, float]:
    """Return stiffness (N/m), transmission error (m) and its rate (m/s) at a phase psi of planet 1.

    Args:
        law: the meshes' data; mesh: 0..6.
        cos, sin: of psi; rate: of psi, rad/s.
    """
    stiffness = law.stiffness[mesh] + law.stiffness_cos[mesh] * cos + law.stiffness_sin[mesh] * sin
    error = law.error_mean[mesh] + law.error_cos[mesh] * cos + law.error_sin[mesh] * sin
    return stiffness, error, rate * (law.error_sin[mesh] * cos - law.error_cos[mesh] * sin)


@fused
def add_meshes(law: MeshLaw, rows: Rows, excitation: Array, q: Array, v: Array, contact: Contact, force: Array) -> None:
    """Find the elongations and add the forces of all meshes.

    Args:
        law, rows: data and rows of the meshes.
        excitation: K (N/m), e (m), e' (m/s), g, g_1 (m) of each mesh, and one column more, shape (7, 6).
        q, v: displacements (m) and velocities (m/s).
        contact: set here.
        force: generalised forces (N), added to.
    """
    place, normal, slide, roll, drift = rows
    for mesh in range(7):
        x, rate = excitation[mesh, 1], excitation[mesh, 2]
        count = law.entries[mesh]
        for k in range(count):
            i = place[mesh, k]
            x += normal[mesh, k] * q[i]
            rate += normal[mesh, k] * v[i] + drift[mesh, k] * q[i]
        elastic = excitation[mesh, 0] * backlash_function(x, law.backlash[mesh])
        total = elastic
        if law.damping_in_gap or elastic != 0.0:
            total += law.damping[mesh] * rate
        sliding = excitation[mesh, 3] * abs(elastic)
        rolling = excitation[mesh, 4] * abs(elastic)
        for k in range(count):
            force[place[mesh, k]] += slide[mesh, k] * sliding + roll[mesh, k] * rolling - normal[mesh, k] * total
        contact.x[mesh], contact.rate[mesh] = x, rate
        contact.force[mesh], contact.elastic[mesh] = total, elastic
