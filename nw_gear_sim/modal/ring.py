"""The flexible ring in its own modes, and how the planets touch them.

The ring is linear and has the symmetry of its segments, so that its motions fall into harmonics n = 0 .. M/2 of the
angle phi_i = 2 pi i / M. In the ring's frame each harmonic has the families

    A: w = W cos n phi, v = V sin n phi, p = P sin n phi        B: A turned forward by a quarter of its period
    and in the axial direction z = Z cos n phi, Z sin n phi

within which at most three motions are coupled. Modes are normalised to a modal mass of 1 kg. Those above a bandwidth
can be left out: what they would add to a contact's elongation under a slow force is kept as a flexibility.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.linalg

from nw_gear_common.tables import Array
from nw_gear_sim.physics.engagement import EngagementLaw, engage
from nw_gear_sim.physics.mesh import Indices, empty_rows
from nw_gear_sim.physics.ring import RingLaw

KNOTS = 64
"""Positions within a segment at which the contact is tabulated."""

FAMILIES = ("A", "B", "axial A", "axial B")


@dataclass(frozen=True, eq=False)
class RingModes:
    """Modes of the free-standing ring on its supports, sorted by frequency.

    Attributes:
        shapes: displacements by modal coordinates, (4 M, modes), 1/sqrt(kg); mass-normalised.
        harmonic: n of each mode; family: index in FAMILIES.
        square: squared angular frequencies, 1/s^2; zero where the ring turns freely.
        damping: modal damping matrix, (modes, modes), 1/s; it couples modes of one harmonic and family only.
    """

    shapes: Array
    harmonic: Indices
    family: Indices
    square: Array
    damping: Array

    def select(self, chosen: npt.NDArray[np.int64] | npt.NDArray[np.bool_]) -> RingModes:
        """Return the chosen modes (indices, or a mask) alone."""
        return RingModes(
            np.ascontiguousarray(self.shapes[:, chosen]),
            self.harmonic[chosen],
            self.family[chosen],
            self.square[chosen],
            self.damping[chosen][:, chosen],
        )

    def padded(self, multiple: int) -> RingModes:
        """Return the modes with idle ones at the end, which move nothing, so that their number suits vector units."""
        more = -len(self.square) % multiple
        return RingModes(
            np.pad(self.shapes, ((0, 0), (0, more))),
            np.pad(self.harmonic, (0, more), constant_values=-1),
            np.pad(self.family, (0, more)),
            np.pad(self.square, (0, more)),
            np.pad(self.damping, ((0, more), (0, more))),
        )


class ContactTable(NamedTuple):
    """What a planet at contact angle A (rad, in the ring's frame) feels of the modes; KNOTS positions for each segment.

    Attributes:
        normal, slide, roll: rows of the modes as in `mesh.Rows`, (M KNOTS + 1, modes), linear in between.
        flexibility: of the modes left out: elongation by a unit normal force, and along the normal by units of the
            friction's force and moment (as in `slide` and `roll`), m/N, (3, KNOTS + 1) over one segment.
        neighbour: the same by the force of another planet, mean over a segment, m/N.
        push: elongation by the modes left out for 1 N of tangential force on every segment, m/N.
    """

    normal: Array
    slide: Array
    roll: Array
    flexibility: Array
    neighbour: float
    push: float


def ring_matrices(law: RingLaw) -> tuple[Array, Array]:
    """Return stiffness (N/m) and damping (N s/m) of the ring on its supports, (4 M, 4 M), ordered as in `layout`."""
    count = len(law.cos)
    joints = np.zeros((4 * count, 4 * count))
    for i in range(count):
        here = i + count * np.arange(3)
        beyond = (i + 1) % count + count * np.arange(3)
        joints[np.ix_(here, here)] += law.own
        joints[np.ix_(here, beyond)] += law.next
        joints[np.ix_(beyond, here)] += law.next.T
        z, other = 3 * count + i, 3 * count + (i + 1) % count
        joints[[z, other], [z, other]] += law.axial
        joints[[z, other], [other, z]] -= law.axial
    w, axial = np.arange(count), 3 * count + np.arange(count)
    stiffness, damping = joints.copy(), law.damping_time * joints
    stiffness[w, w] += law.radial_support
    stiffness[axial, axial] += law.axial_support
    damping[w, w] += law.radial_damping
    damping[axial, axial] += law.axial_damping
    return stiffness, damping


def ring_modes(law: RingLaw, mass: Array) -> RingModes:
    """Return all modes of the ring; `mass` of its motions as in `layout`, kg, (4 M,)."""
    groups = _groups(len(law.cos), mass)
    stiffness, damping = ring_matrices(law)
    shapes, squares, harmonics, families = [], [], [], []
    forward: Array = np.zeros((0, 0))
    for harmonic, family, basis in groups:
        square, vectors = scipy.linalg.eigh(basis.T @ stiffness @ basis)
        if family % 2 == 0:
            forward = vectors
        elif vectors.shape == forward.shape:
            vectors = forward  # the same shape, turned: no sign of its own
        shapes.append(basis @ vectors)
        squares.append(np.maximum(square, 0.0))
        harmonics += [harmonic] * len(square)
        families += [family] * len(square)
    together, square = np.hstack(shapes), np.concatenate(squares)
    square[square < 1e-9 * square.max()] = 0.0  # the free rotation, up to rounding
    modes = RingModes(together, np.array(harmonics), np.array(families), square, together.T @ damping @ together)
    return modes.select(np.argsort(square, kind="stable"))


def rigid_ring_modes(law: RingLaw, mass: Array, radius: float, base_radius: float) -> RingModes:
    """Return the motions of a rigid ring on the same supports: rotation, two translations, axial translation.

    Args:
        law: of the flexible ring; mass: of its motions, kg, (4 M,).
        radius: r_c of the centroids, m; base_radius: r_b of the ring, m.
    """
    count = len(law.cos)
    angle = 2 * math.pi * np.arange(count) / count
    shapes = np.zeros((4, count, 4))
    shapes[1, :, 0], shapes[2, :, 0] = 1.0, base_radius / radius
    shapes[0, :, 1], shapes[1, :, 1] = np.cos(angle), -np.sin(angle)
    shapes[0, :, 2], shapes[1, :, 2] = np.sin(angle), np.cos(angle)
    shapes[3, :, 3] = 1.0
    rigid = shapes.reshape(4 * count, 4)
    rigid /= np.sqrt(np.sum(mass[:, None] * rigid**2, axis=0))
    stiffness, damping = ring_matrices(law)
    square = np.diag(rigid.T @ stiffness @ rigid).copy()
    square[0] = 0.0
    return RingModes(rigid, np.array([0, 1, 1, 0]), np.array([1, 0, 1, 2]), square, rigid.T @ damping @ rigid)


def contact_table(law: EngagementLaw, kept: RingModes, dropped: RingModes) -> ContactTable:
    """Tabulate the contact with a planet over the angle A = th_j - (angle of the ring).

    Args:
        law: of the internal meshes.
        kept: modes of the motion; dropped: those that follow at once, none of them with frequency zero.
    """
    positions = np.arange(law.segments * KNOTS + 1) * (law.pitch / KNOTS)
    flexible, neighbour, push = np.zeros((3, KNOTS + 1)), 0.0, 0.0
    if len(dropped.square):
        turned = law.planet_angle[1] - law.planet_angle[0]
        here, away = (
            np.array([contact_rows_of(law, dropped, angle) for angle in positions[: KNOTS + 1] + offset])
            for offset in (0.0, turned)
        )
        yields = here[:, 0] / dropped.square
        flexible = np.einsum("ki,kri->rk", yields, here)
        neighbour = float(np.mean(np.sum(yields * away[:, 0], axis=1)))
        push = float(np.mean(yields @ dropped.shapes[law.segments : 2 * law.segments].sum(axis=0)))
    tables = [np.empty((len(positions), len(kept.square))) for _ in range(3)]
    for k, angle in enumerate(positions):
        for table, row in zip(tables, contact_rows_of(law, kept, angle), strict=True):
            table[k] = row
    return ContactTable(tables[0], tables[1], tables[2], flexible, neighbour, push)


def contact_rows_of(law: EngagementLaw, modes: RingModes, angle: float) -> tuple[Array, Array, Array]:
    """Return the rows (normal, slide, roll) of the modes for a planet at contact angle A (rad), each (modes,)."""
    rows = empty_rows()
    facing = law._replace(planet_angle=np.zeros(3))
    engage(facing, -angle, 0.0, rows.place, rows.normal, rows.slide, rows.roll, rows.drift)
    shapes = modes.shapes[rows.place[0, :8]]
    return rows.normal[0, :8] @ shapes, rows.slide[0, :8] @ shapes, rows.roll[0, :8] @ shapes


def _groups(count: int, mass: Array) -> list[tuple[int, int, Array]]:
    """Return (harmonic, family, basis) with mass-normalised bases of shape (4 M, 1 to 3)."""
    angle = 2 * math.pi * np.arange(count) / count
    groups = []
    for n in range(count // 2 + 1):
        cos, sin = np.cos(n * angle), np.sin(n * angle)
        for family, waves in enumerate(((cos, sin, sin), (sin, -cos, -cos), (cos,), (sin,))):
            columns = []
            for part, wave in enumerate(waves):
                if np.max(np.abs(wave)) < 1e-6:
                    continue
                column = np.zeros((4, count))
                column[part if family < 2 else 3] = wave
                columns.append(column.ravel())
            if columns:
                basis = np.array(columns).T
                groups.append((n, family, basis / np.sqrt(np.sum(mass[:, None] * basis**2, axis=0))))
    return groups
