"""The elastic elements of the gearbox as scalar springs: who holds what, and how much energy each of them stores.

Every element is a set of springs with elongations row . q[places] and stiffnesses (N/m); together they are the
symmetric part of the stiffness matrix, up to the friction's share of it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.kinematics import bearing_kind
from nw_gear_sim.layout import PLANETS
from nw_gear_sim.physics.ring import joint_rows

Indices = npt.NDArray[np.int64]

CLOSED = 1e-5
"""Compression of the rollers for the stiffness of closed contacts, m."""

GROUPS = ("meshes", "bearings", "shafts", "torsion", "ring", "ring support", "generator")


@dataclass(frozen=True, eq=False)
class Element:
    """One elastic element.

    Attributes:
        name: such as `mesh I_1`, `bearing pb1_1`, `ring bending`; group: one of GROUPS.
        places: entries of q, rows: their coefficients, shape (springs, entries); stiffness: N/m, shape (springs,).
    """

    name: str
    group: str
    places: Indices
    rows: Array
    stiffness: Array

    def energy(self, vectors: npt.NDArray[np.complex128]) -> Array:
        """Twice the largest energy in each of the motions, shape (dof, motions): sum of k |row . x|^2."""
        stretch = np.einsum("kn,knm->km", self.rows, vectors[self.places])
        return np.asarray(self.stiffness @ np.abs(stretch) ** 2)

    def add_to(self, matrix: Array) -> None:
        """Add the element to a stiffness matrix (N/m), shape (dof, dof)."""
        for places, row, stiffness in zip(self.places, self.rows, self.stiffness, strict=True):
            np.add.at(matrix, np.ix_(places, places), stiffness * np.outer(row, row))


def find_elements(gearbox: Gearbox, q: Array) -> list[Element]:
    """Return all elements as they are at displacements q (m) and at the instant set in the gearbox.

    A mesh inside its gap and a roller without load have no stiffness.
    """
    return [*_meshes(gearbox, q), *_bearings(gearbox, q), *_springs(gearbox), *_ring(gearbox)]


def closed_stiffness(gearbox: Gearbox) -> Array:
    """Return the stiffness (N/m), (dof, dof), with every flank and roller in contact, at the instant set."""
    size = gearbox.layout.size
    matrix = np.zeros((size, size))
    for element in find_elements(gearbox, np.zeros(size)):
        held = element.stiffness
        if element.group == "meshes":
            held = np.array([gearbox.laws.mesh.stiffness[names.MESHES.index(element.name.split()[1])]])
        elif element.group == "bearings":
            bearing = names.BEARINGS.index(element.name.split()[1])
            exponent = gearbox.bearings.exponent
            tangent = exponent * gearbox.laws.bearings.stiffness[bearing] * CLOSED ** (exponent - 1)
            held = np.full(len(held), tangent)
        replace(element, stiffness=held).add_to(matrix)
    return matrix


def _meshes(gearbox: Gearbox, q: Array) -> Iterator[Element]:
    gearbox.forces(q, np.zeros_like(q))
    rows, excitation = gearbox.instants.rows[0], gearbox.instants.excitation[0]
    for m, mesh in enumerate(names.MESHES):
        used = slice(0, int(gearbox.laws.mesh.entries[m]))
        stiffness = float(excitation[m, 0]) if gearbox.contact.elastic[m] != 0 else 0.0
        yield Element(
            f"mesh {mesh}", "meshes", rows.place[m : m + 1, used].copy(), rows.normal[m : m + 1, used].copy(),
            np.array([stiffness]),
        )  # fmt: skip


def _bearings(gearbox: Gearbox, q: Array) -> Iterator[Element]:
    """Rollers as springs: d(K delta^n)/d delta along the direction in which each one is compressed."""
    law, exponent = gearbox.laws.bearings, gearbox.bearings.exponent
    for b, bearing in enumerate(names.BEARINGS):
        count = getattr(gearbox.bearings, bearing_kind(bearing)).rollers
        cos, sin = gearbox.instants.cage[0, b]
        direction = np.exp(2j * np.pi * np.arange(count) / count) * (cos + 1j * sin)
        columns = [law.radial[b] * direction.real, law.radial[b] * direction.imag]
        places = list(law.place[b, :2])
        if law.place[b, 2] >= 0:
            columns.append(np.full(count, law.axial[b]))
            places.append(law.place[b, 2])
        rows = np.array(columns).T
        squeeze = np.maximum(rows @ q[places] - law.clearance[b], 0.0)
        tangent = np.where(squeeze > 0, exponent * law.stiffness[b] * squeeze ** (exponent - 1), 0.0)
        yield Element(f"bearing {bearing}", "bearings", np.tile(np.array(places), (count, 1)), rows, tangent)


def _springs(gearbox: Gearbox) -> Iterator[Element]:
    """Shaft and torsion springs and the generator, by the shaft on which they are."""
    law, layout = gearbox.laws.springs, gearbox.layout
    rotations = {node.u for node in layout.nodes.values() if node.u >= 0}
    shafts: dict[str, list[int]] = {}
    for k, first in enumerate(law.first):
        if law.bb[k] == 0:
            kind = "generator"
        else:
            shaft = _shaft(layout.name(int(first)).split()[0])
            kind = f"{'torsion' if int(first) in rotations else 'shaft'} {shaft}"
        shafts.setdefault(kind, []).append(k)
    for name, own in shafts.items():
        a, b = np.sqrt(law.aa[own]), np.sqrt(law.bb[own])
        group = {"shaft": "shafts", "torsion": "torsion", "generator": "generator"}[name.split()[0]]
        places = np.stack([law.first[own], law.second[own]], axis=1)
        yield Element(name, group, places, np.stack([a, -b], axis=1), np.ones(len(own)))


def _shaft(node: str) -> str:
    part, _, planet = node.partition("_")
    return f"planet_{planet}" if planet else {"s": "sun", "sb": "sun", "h1": "sun", "b1": "sun"}.get(part, "output")


def _ring(gearbox: Gearbox) -> Iterator[Element]:
    law, segments, ring = gearbox.laws.ring, gearbox.layout.segments, gearbox.kinematics.ring
    here, beyond = joint_rows(segments, ring.radius, gearbox.kinematics.bodies.ring.base_radius)
    one = np.arange(segments)
    following = (one + 1) % segments
    plane = np.stack([motion * segments + side for side in (one, following) for motion in (0, 1, 2)], axis=1)
    kinds = (("shear", ring.radial), ("extension", ring.tangential), ("bending", ring.rotational))
    for k, (kind, stiffness) in enumerate(kinds):
        row = np.concatenate([here[k], beyond[k]])
        yield Element(f"ring {kind}", "ring", plane, np.tile(row, (segments, 1)), np.full(segments, stiffness))
    axial = 3 * segments + np.stack([one, following], axis=1)
    row = np.array([-1.0, 1.0])
    yield Element("ring axial shear", "ring", axial, np.tile(row, (segments, 1)), np.full(segments, law.axial))
    for kind, first, stiffness in (("radial", 0, law.radial_support), ("axial", 3 * segments, law.axial_support)):
        places = (first + one)[:, None]
        held = np.full(segments, stiffness)
        yield Element(f"ring {kind} support", "ring support", places, np.ones((segments, 1)), held)


def rigid_motions(gearbox: Gearbox, angle: float = 0.0) -> dict[str, Array]:
    """Return motions without any deformation of gears, meshes and joints, each (dof,).

    `x`, `y`, `z`: the whole gearbox moved by 1 m; `rotation`: the ring turned by 1 rad and all gears as their teeth
    demand, u in m. `angle` of the ring, rad.
    """
    layout, kinematics = gearbox.layout, gearbox.kinematics
    motions = {name: np.zeros(layout.size) for name in ("x", "y", "z", "rotation")}
    turned = angle + kinematics.ring.pitch * np.arange(layout.segments)
    motions["x"][layout.ring("w")], motions["x"][layout.ring("v")] = np.cos(turned), -np.sin(turned)
    motions["y"][layout.ring("w")], motions["y"][layout.ring("v")] = np.sin(turned), np.cos(turned)
    motions["z"][layout.ring("z")] = 1.0
    for node in layout.nodes.values():
        for axis, place in (("x", node.x), ("y", node.y), ("z", node.z)):
            if place >= 0:
                motions[axis][place] = 1.0
    rotation, bodies, ratio = motions["rotation"], kinematics.bodies, kinematics.shaft_ratio
    rotation[layout.ring("v")] = kinematics.ring.radius
    rotation[layout.ring("p")] = bodies.ring.base_radius
    for j in range(PLANETS):
        rotation[layout.planet("p1", j).u] = bodies.planet_1.base_radius * ratio["planet"]
        rotation[layout.planet("p2", j).u] = bodies.planet_2.base_radius * ratio["planet"]
    rotation[layout.nodes["s"].u] = bodies.sun.base_radius * ratio["sun"]
    rotation[layout.nodes["h1"].u] = bodies.herringbone_1.base_radius * ratio["sun"]
    rotation[layout.nodes["h2"].u] = bodies.herringbone_2.base_radius * ratio["output"]
    return motions
