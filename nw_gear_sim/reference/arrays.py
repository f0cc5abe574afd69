"""The reference equations on whole arrays: the right-hand side as one writes it with NumPy and SciPy.

Rows and matrices are read off the plain equations once; at a time there are only sums over segments, meshes and
rollers, without a loop. Speed and torque are constant, and the friction shares are tabulated over the mesh phase.
"""

import math

import numpy as np
import numpy.typing as npt
import scipy.sparse

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.kinematics import PLANET_ANGLES, bearing_kind
from nw_gear_sim.reference.bodies import along, minus, turned
from nw_gear_sim.reference.friction import sliding_friction
from nw_gear_sim.reference.model import ReferenceModel

PHASES = 128
"""Entries of a friction table; its error is below 1e-3 of the mesh force."""
RING_MESHES = slice(0, 3)


class ArrayModel:
    """Accelerations of the whole gearbox at a constant drive.

    Args:
        reference: the plain equations.
        speed: of the ring, rad/s; at t = 0 it is unturned.
        torque: input torque, N m.
    """

    def __init__(self, reference: ReferenceModel, speed: float, torque: float) -> None:
        self.reference = reference
        self.speed, self.torque = speed, torque
        self.names = tuple(reference.masses)
        self._index = {name: i for i, name in enumerate(self.names)}
        self._mass = np.array(list(reference.masses.values()))
        self._set_springs()
        self._set_meshes()
        self._set_friction()
        self._set_ring_contact()
        self._set_bearings()
        self._set_loads()

    def accelerations(self, time: float, q: Array, v: Array) -> Array:
        """Second derivatives, m/s^2 (rad/s^2 of ring.psi), of the coordinates in the order of `names`.

        Args:
            time: s.
            q, v: displacements (m, rad) and rates, shape (dof,).
        """
        angle = self.speed * time
        out = self._load - self._stiffness @ q - self._damping @ v
        self._add_ring_weight(angle, out)
        self._add_bearings(angle, q, out)
        self._add_meshes(angle, q, v, out)
        acceleration: Array = out / self._mass
        return acceleration

    # --- springs and loads --------------------------------------------------------------------------------------------

    def _matrix(self, rows: list[dict[str, float]]) -> scipy.sparse.csr_array:
        entries = [(i, self._index[name], c) for i, row in enumerate(rows) for name, c in row.items()]
        i, j, c = zip(*entries, strict=True)
        return scipy.sparse.csr_array((c, (i, j)), shape=(len(rows), len(self.names)))

    def _set_springs(self) -> None:
        elongation, stiffness, damping = zip(*self.reference.springs(), strict=True)
        rows = self._matrix(list(elongation))
        self._stiffness = (rows.T @ scipy.sparse.diags_array(stiffness) @ rows).tocsr()
        self._damping = (rows.T @ scipy.sparse.diags_array(damping) @ rows).tocsr()

    def _set_loads(self) -> None:
        reference, ring = self.reference, self.reference.ring
        gravity = reference.configuration.gravity
        self._load = np.zeros(len(self.names))
        for name, i in self._index.items():
            motion = name.split(".")[1]
            if motion == "x":
                self._load[i] = self._mass[i] * gravity.acceleration * math.cos(gravity.direction)
            elif motion == "y":
                self._load[i] = self._mass[i] * gravity.acceleration * math.sin(gravity.direction)
        radius = reference.kinematics.bodies.herringbone_2.base_radius
        self._load[self._index["h2.u"]] -= self.torque / reference.kinematics.total_ratio / radius
        self._segments = np.array([[self._index[f"ring.{m}.{i}"] for i in range(ring.count)] for m in ("w", "v")])
        self._load[self._segments[1]] += self.torque / (ring.count * ring.radius)
        self._place = np.arange(ring.count) * ring.pitch - gravity.direction
        self._ring_weight = ring.mass * gravity.acceleration

    def _add_ring_weight(self, angle: float, out: Array) -> None:
        place = self._place + angle
        out[self._segments[0]] += self._ring_weight * np.cos(place)
        out[self._segments[1]] -= self._ring_weight * np.sin(place)

    # --- bearings -----------------------------------------------------------------------------------------------------

    def _set_bearings(self) -> None:
        reference, dof = self.reference, len(self.names)
        kinds = [bearing_kind(name) for name in names.BEARINGS]
        given = [getattr(reference.configuration.bearings, kind) for kind in kinds]
        counts = [bearing.rollers for bearing in given]
        self._first = np.concatenate([[0], np.cumsum(counts)[:-1]])
        self._of = np.repeat(np.arange(len(counts)), counts)
        self._start = np.concatenate([2 * math.pi * np.arange(count) / count for count in counts])
        sense = np.array([-1 if kind in {"sb", "b1"} else 1 for kind in kinds])
        cages = sense * [reference.kinematics.cage_ratio[kind] for kind in kinds]
        self._cage = cages[self._of]
        contact = np.array([bearing.contact_angle for bearing in given])[self._of]
        self._flat, self._rise = np.cos(contact), np.sin(contact)
        self._clearance = np.array([bearing.clearance for bearing in given])[self._of]
        self._roller = np.array([reference.kinematics.roller_stiffness[kind] for kind in kinds])[self._of]
        entries = [[self._index.get(f"{name}.{axis}", dof) for axis in "xyz"] for name in names.BEARINGS]
        self._shift = np.array(entries)
        self._exponent = reference.configuration.bearings.exponent

    def _add_bearings(self, angle: float, q: Array, out: Array) -> None:
        place = self._start + self._cage * angle
        axes = np.column_stack([self._flat * np.cos(place), self._flat * np.sin(place), self._rise])
        shift = np.append(q, 0.0)[self._shift]
        squeeze = np.maximum(np.sum(axes * shift[self._of], axis=1) - self._clearance, 0.0)
        load = self._roller * squeeze**self._exponent
        force = np.add.reduceat(load[:, None] * axes, self._first)
        there = self._shift < len(out)
        out[self._shift[there]] -= force[there]

    # --- meshes -------------------------------------------------------------------------------------------------------

    def _set_meshes(self) -> None:
        reference = self.reference
        approaches = [reference.approach(mesh, 0.0) for mesh in names.MESHES]
        rows = [{n: c.real for n, c in row.items() if not n.startswith("ring")} for row in approaches]
        self._rows = self._matrix(rows)
        self._pushes = self._rows.T.tocsr()
        stages = [reference.kinematics.stage(mesh) for mesh in names.MESHES]
        tied = reference.configuration.excitation.mode == "tied"
        leaders = [reference.kinematics.stage("II") if tied else stage for stage in stages]
        self._ratio = np.array([stage.mesh_ratio for stage in leaders])
        self._phase = np.array([reference.phase(mesh, 0.0).real for mesh in names.MESHES])
        self._peak = np.array([reference.peak(stage) for stage in stages])
        law = [stage.stiffness for stage in stages]
        self._normal = np.array([one.normal for one in law])
        self._variation = np.array([one.variation for one in law])
        self._shape = np.array([one.phase for one in law])
        self._mesh_damping = np.array([one.damping for one in law])
        self._gap = np.array([stage.mesh.backlash for stage in stages])
        self._mean = np.array([stage.mesh.error_mean for stage in stages])
        self._amplitude = np.array([stage.mesh.error_amplitude for stage in stages])
        self._damped_in_gap = reference.configuration.mesh.damping_in_gap

    def _set_friction(self) -> None:
        """Tabulate sum share and sum share s over the phase; rows of a friction force at the pitch point and at 1 m."""
        reference = self.reference
        phases = 2 * math.pi * np.arange(PHASES) / PHASES
        rubbing = reference.configuration.friction
        self._phases, self._tables, rows = phases, np.zeros((3, 2, PHASES)), []
        for table, stage in zip(self._tables, reference.kinematics.stages, strict=True):
            if rubbing.enabled:
                points = [sliding_friction(rubbing, stage, phase, self.speed) for phase in phases]
                table[:] = [[sum(g * s**k for s, g in point) for point in points] for k in (0, 1)]
        for distance in (0.0, 1.0):
            for mesh in names.MESHES:
                normal = reference.normal(mesh)
                driver, driven = reference.movements(mesh, 0.0, reference.pitch_point(mesh) + distance * normal)
                sign = -1.0 if mesh.startswith("II_") else 1.0
                row = along(sign * turned(normal), minus(driven, driver))
                rows.append({n: c.real for n, c in row.items() if not n.startswith("ring")})
        pitch, one = self._matrix(rows[:7]), self._matrix(rows[7:])
        self._slides, self._rolls = pitch.T.tocsr(), (one - pitch).T.tocsr()
        self._stages = [[names.MESHES.index(m) for m in names.MESHES_OF_STAGE[s]] for s in names.STAGES]

    def _set_ring_contact(self) -> None:
        reference, ring = self.reference, self.reference.ring
        helix = reference.kinematics.stage("I_1").pair.base_helix
        normal = np.array([reference.normal(mesh) for mesh in names.MESHES[RING_MESHES]])
        self._direction = (math.cos(helix) * normal)[:, None, :2]
        self._axial = math.sin(helix)
        self._tangent = np.array([turned(n) for n in normal])[:, None, :2]
        self._point = np.array([reference.pitch_point(mesh) for mesh in names.MESHES[RING_MESHES]])[:, None, :2]
        self._planets = np.array(PLANET_ANGLES)
        motions = ("w", "v", "z", "psi")
        self._of_segment = np.array([[self._index[f"ring.{m}.{i}"] for m in motions] for i in range(ring.count)])

    def _ring_rows(self, angle: float) -> tuple[npt.NDArray[np.int64], Array, Array, Array]:
        """Entries, approach, its derivative by the angle, friction row; each (3 planets, 2 segments, w v z psi)."""
        ring, d, t = self.reference.ring, self._direction, self._tangent
        place = (self._planets - angle) / ring.pitch
        first = np.floor(place).astype(np.int64)
        near = np.stack([1.0 - (place - first), place - first], axis=1)[:, :, None]
        nearer = np.array([1.0, -1.0])[None, :, None] / ring.pitch
        segments = np.stack([first, first + 1], axis=1)
        cos, sin = np.cos(angle + segments * ring.pitch), np.sin(angle + segments * ring.pitch)
        radial, tangential = np.stack([cos, sin], axis=-1), np.stack([-sin, cos], axis=-1)
        lever = self._point - ring.radius * radial
        axial, nothing = np.full(segments.shape, self._axial), np.zeros(segments.shape)
        row = np.stack([dot(d, radial), dot(d, tangential), axial, cross(lever, d)], axis=2)
        moving = [dot(d, tangential), -dot(d, radial), nothing, -ring.radius * cross(tangential, d)]
        rub = np.stack([dot(t, radial), dot(t, tangential), nothing, cross(lever, t)], axis=2)
        derivative = nearer * row + near * np.stack(moving, axis=2)
        return self._of_segment[segments % ring.count], near * row, derivative, near * rub

    def _add_meshes(self, angle: float, q: Array, v: Array, out: Array) -> None:
        phase = self._phase + self._ratio * angle
        entries, row, derivative, rub = self._ring_rows(angle)
        x = self._rows @ q + self._mean + self._amplitude * np.sin(phase - self._peak)
        rate = self._rows @ v + self.speed * self._ratio * self._amplitude * np.cos(phase - self._peak)
        x[RING_MESHES] += np.sum(row * q[entries], axis=(1, 2))
        rate[RING_MESHES] += np.sum(row * v[entries] + self.speed * derivative * q[entries], axis=(1, 2))
        pressed = x - np.clip(x, -self._gap, self._gap)
        elastic = self._normal * (1.0 + self._variation * np.cos(phase - self._shape)) * pressed
        damped = rate if self._damped_in_gap else np.where(pressed == 0.0, 0.0, rate)
        force = elastic + self._mesh_damping * damped
        share, moment = np.empty(7), np.empty(7)
        for table, meshes in zip(self._tables, self._stages, strict=True):
            for values, target in zip(table, (share, moment), strict=True):
                target[meshes] = np.interp(phase[meshes], self._phases, values, period=2 * math.pi)
        carried = np.abs(elastic)
        out -= self._pushes @ force
        out += self._slides @ (share * carried) + self._rolls @ (moment * carried)
        on_ring = row * force[RING_MESHES, None, None] + rub * (share * carried)[RING_MESHES, None, None]
        on_ring[:, :, 3] += (moment * carried)[RING_MESHES, None] * self._nearness(angle)
        np.subtract.at(out, entries, on_ring)

    def _nearness(self, angle: float) -> Array:
        place = (self._planets - angle) / self.reference.ring.pitch
        rest = place - np.floor(place)
        return np.stack([1.0 - rest, rest], axis=1)


def dot(a: Array, b: Array) -> Array:
    """Sum of products in the plane over the last axis."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]


def cross(a: Array, b: Array) -> Array:
    """Component z of a x b."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
