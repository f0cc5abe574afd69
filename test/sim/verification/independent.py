"""The reference equations as arrays in the order of the fast model's layout: energies, powers, tangent matrices."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim.kinematics import SHAFT_OF_BEARING, bearing_kind
from nw_gear_sim.layout import Layout
from nw_gear_sim.params import Configuration
from nw_gear_sim.reference.bodies import along, minus, polar, turned
from nw_gear_sim.reference.friction import sliding_friction
from nw_gear_sim.reference.model import TINY, ReferenceModel, backlash
from nw_gear_sim.reference.states import turned_together


@dataclass(frozen=True)
class MeshRates:
    """The meshes at an instant, arrays of shape (7,) and rows of shape (7, dof).

    Attributes:
        h: elongation by displacement; h_rate: its time derivative; error_rate: e', m/s.
        x, rate: elongation (m) and its derivative; deflection: f(x, b), m.
        stiffness: K (N/m); stiffness_rate: its time derivative; force: whole mesh force, N.
    """

    h: Array
    h_rate: Array
    error_rate: Array
    x: Array
    rate: Array
    deflection: Array
    stiffness: Array
    stiffness_rate: Array
    force: Array


class Independent:
    """Nothing of the compiled right-hand side is in here, besides the order of the coordinates."""

    def __init__(self, configuration: Configuration) -> None:
        self.reference = ReferenceModel(configuration)
        self.configuration = configuration
        self.kinematics = self.reference.kinematics
        self.layout = Layout(self.reference.ring.count)
        self.index, self.scale = self._order()
        self.mass = np.empty(self.layout.size)
        for name, mass in self.reference.masses.items():
            self.mass[self.index[name]] = mass * self.scale[name] ** 2

    def _order(self) -> tuple[dict[str, int], dict[str, float]]:
        index = {f"{name}.{axis}": getattr(node, axis) for name, node in self.layout.nodes.items() for axis in "uxyz"}
        index = {name: place for name, place in index.items() if place >= 0}
        scale = dict.fromkeys(index, 1.0)
        for motion, column in (("w", "w"), ("v", "v"), ("psi", "p"), ("z", "z")):
            for i in range(self.layout.segments):
                index[f"ring.{motion}.{i}"] = self.layout.ring(column).start + i
                scale[f"ring.{motion}.{i}"] = 1 / self.kinematics.bodies.ring.base_radius if motion == "psi" else 1.0
        return index, scale

    def row(self, coefficients: dict[str, complex] | dict[str, float]) -> Array:
        """Coefficients by name as an array in layout order."""
        out = np.zeros(self.layout.size, dtype=complex)
        for name, c in coefficients.items():
            out[self.index[name]] += c * self.scale[name]
        return out

    @cached_property
    def springs(self) -> tuple[Array, Array, Array]:
        """Elongations of all springs, (springs, dof), stiffness and damping, (springs,)."""
        parts = self.reference.springs()
        rows = np.array([self.row(h).real for h, _, _ in parts])
        return rows, np.array([k for _, k, _ in parts]), np.array([c for _, _, c in parts])

    @cached_property
    def turning(self) -> Array:
        """Displacements where the ring turns by 1 rad and all shafts follow, (dof,)."""
        return np.array([
            value for _, value in sorted(
                (self.index[name], value / self.scale[name])
                for name, value in turned_together(self.reference, 1.0).items()
            )
        ])  # fmt: skip

    def meshes(self, q: Array, v: Array, angle: float, speed: float) -> MeshRates:
        """State of the meshes at displacements q (m), velocities v (m/s), ring angle (rad) and speed (rad/s)."""
        later = angle + 1j * TINY
        h = np.array([self.row(self.reference.approach(mesh, later)) for mesh in names.MESHES])
        error = np.array([self.reference.error(mesh, later) for mesh in names.MESHES])
        stiffness = np.array([self._stiffness(mesh, later) for mesh in names.MESHES])
        h_rate, error_rate = speed * h.imag / TINY, speed * error.imag / TINY
        x = h.real @ q + error.real
        rate = h.real @ v + h_rate @ q + error_rate
        stages = [self.kinematics.stage(mesh) for mesh in names.MESHES]
        deflection = np.array([backlash(one, stage.mesh.backlash) for one, stage in zip(x, stages, strict=True)])
        damping = np.array([stage.stiffness.damping for stage in stages])
        if not self.configuration.mesh.damping_in_gap:
            damping = damping * (deflection != 0)
        force = stiffness.real * deflection + damping * rate
        return MeshRates(
            h.real, h_rate, error_rate, x, rate, deflection, stiffness.real, speed * stiffness.imag / TINY, force
        )

    def _stiffness(self, mesh: str, angle: complex) -> complex:
        stage = self.kinematics.stage(mesh)
        wave = np.cos(self.reference.phase(mesh, angle) - stage.stiffness.phase)
        return complex(stage.stiffness.normal * (1 + stage.stiffness.variation * wave))

    def friction(self, mesh: str, angle: float, speed: float) -> Array:
        """Generalised friction force for 1 N of elastic force in a mesh, (dof,)."""
        if not self.configuration.friction.enabled:
            return np.zeros(self.layout.size)
        reference, stage = self.reference, self.kinematics.stage(mesh)
        normal, pitch = reference.normal(mesh), reference.pitch_point(mesh)
        rub = (-1.0 if stage.name == "II" else 1.0) * turned(normal)

        def at(point: Array) -> Array:
            driver, driven = reference.movements(mesh, angle, point)
            return self.row(along(rub, minus(driven, driver))).real

        phase = reference.phase(mesh, angle).real
        points = np.array(sliding_friction(self.configuration.friction, stage, phase, speed))
        here, slope = at(pitch), at(pitch + normal) - at(pitch)
        return points[:, 1].sum() * here + (points[:, 0] * points[:, 1]).sum() * slope

    def _rollers(self, name: str, angle: float) -> tuple[Array, float, float, Array]:
        """Elongation rows of the rollers (rollers, dof), clearance, load constant, and rows differentiated by angle."""
        kind = bearing_kind(name)
        data = getattr(self.configuration.bearings, kind)
        turn = {"planet": 1, "sun": -1, "output": 1}[SHAFT_OF_BEARING[kind]] * self.kinematics.cage_ratio[kind]
        rows, slopes = (np.zeros((data.rollers, self.layout.size)) for _ in range(2))
        for i in range(data.rollers):
            radial, tangential = polar(turn * angle + 2 * math.pi * i / data.rollers)
            for axis, part, slope in zip("xy", radial, tangential, strict=False):
                place = self.index[f"{name}.{axis}"]
                rows[i, place] = math.cos(data.contact_angle) * part
                slopes[i, place] = math.cos(data.contact_angle) * slope * turn
            if f"{name}.z" in self.index:
                rows[i, self.index[f"{name}.z"]] = math.sin(data.contact_angle)
        return rows, data.clearance, self.kinematics.roller_stiffness[kind], slopes

    def bearings(self, q: Array, angle: float) -> tuple[float, float]:
        """Energy of all rollers (J), and its derivative by the ring's angle at fixed q (J/rad)."""
        exponent, energy, slope = self.configuration.bearings.exponent, 0.0, 0.0
        for name in names.BEARINGS:
            rows, clearance, stiffness, turning = self._rollers(name, angle)
            squeeze = np.maximum(rows @ q - clearance, 0)
            energy += stiffness / (exponent + 1) * float(np.sum(squeeze ** (exponent + 1)))
            slope += stiffness * float(np.sum(squeeze**exponent * (turning @ q)))
        return energy, slope

    def weight(self, angle: float) -> Array:
        """Generalised weight, (dof,)."""
        gravity = self.configuration.gravity
        pull = gravity.acceleration * polar(gravity.direction)[0]
        out = np.zeros(self.layout.size)
        for name, mass in self.reference.masses.items():
            body, motion = name.split(".")[:2]
            if body == "ring" and motion in "wv":
                out[self.index[name]] = mass * pull @ polar(angle + self._at(name))["wv".index(motion)]
            elif motion in "xy":
                out[self.index[name]] = mass * pull["xy".index(motion)]
        return out

    def _at(self, name: str) -> float:
        return float(name.split(".")[2]) * self.reference.ring.pitch

    def torque_row(self) -> tuple[Array, Array]:
        """Rotation (rad) of ring and output shaft by displacement, each (dof,)."""
        ring, output = np.zeros(self.layout.size), np.zeros(self.layout.size)
        ring[self.layout.ring("v")] = 1 / (self.layout.segments * self.reference.ring.radius)
        output[self.layout.nodes["h2"].u] = 1 / self.kinematics.bodies.herringbone_2.base_radius
        return ring, output

    def energy(self, q: Array, v: Array, angle: float = 0.0) -> float:
        """Kinetic energy of v and what springs, rollers and meshes store, J; loads don't count."""
        rows, stiffness, _ = self.springs
        mesh = self.meshes(q, v, angle, 0.0)
        stored = 0.5 * stiffness @ (rows @ q) ** 2 + self.bearings(q, angle)[0]
        return float(stored + 0.5 * self.mass @ v**2 + 0.5 * mesh.stiffness @ mesh.deflection**2)

    def tangent(self, q: Array, angle: float = 0.0) -> tuple[Array, Array]:
        """Stiffness and damping matrices without friction, put together spring by spring, (dof, dof)."""
        rows, stiffness, damping = self.springs
        K, C = rows.T @ (stiffness[:, None] * rows), rows.T @ (damping[:, None] * rows)
        mesh = self.meshes(q, np.zeros_like(q), angle, 0.0)
        closed = mesh.deflection != 0
        K += mesh.h.T @ ((mesh.stiffness * closed)[:, None] * mesh.h)
        per_mesh = np.array([self.kinematics.stage(name).stiffness.damping for name in names.MESHES])
        C += mesh.h.T @ (per_mesh[:, None] * mesh.h)
        exponent = self.configuration.bearings.exponent
        for name in names.BEARINGS:
            rollers, clearance, load, _ = self._rollers(name, angle)
            squeeze = np.maximum(rollers @ q - clearance, 0)
            tangent = np.where(squeeze > 0, load * exponent * squeeze ** (exponent - 1), 0.0)
            K += rollers.T @ (tangent[:, None] * rollers)
        return K, C
