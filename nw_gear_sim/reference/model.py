"""The gearbox's equations a second time: slow, plain, and derived another way than the fast ones.

Every body tells how a point fixed to it moves with the coordinates. A mesh is one scalar, the approach of the two
bodies at the pitch point along the flank normal; a spring is one scalar too; friction is a force at each point of the
contact lines. Generalised forces follow from these by virtual work alone, so that levers, signs and moments aren't
written down anywhere but in the movement of a rigid body. Time derivatives of the moving geometry are taken by
complex steps. Nothing here is shared with the fast right-hand side besides the parameters and what is derived from
them.

Coordinates are named: `ring.w.17` (radial), `ring.v.17` (tangential), `ring.psi.17` (rad), `ring.z.17` of a segment
in the frame that turns with the ring; `p1_2.u`, `p1_2.x`, ... of a gear, `pb1_2.x`, ... of a bearing. u is base
radius times rotation, in the sense in which the gear turns.
"""

import math
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from nw_gear_common import names
from nw_gear_sim.kinematics import PLANET_ANGLES, Stage, bearing_kind, derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.params.faults import FaultSettings
from nw_gear_sim.reference.bodies import Gear, Movement, X, Y, Z, along, minus, polar, turned
from nw_gear_sim.reference.faults import TeethThatDiffer, peak_phase, sinking
from nw_gear_sim.reference.friction import sliding_friction

TINY = 1e-40
"""Complex step: the imaginary part of f(t + i TINY) over TINY is f'(t) without any difference being taken."""

Scalars = dict[str, float]


def backlash(x: float, b: float) -> float:
    """Paper Eq 10."""
    return x - b if x > b else x + b if x < -b else 0.0


@dataclass(frozen=True)
class Instant:
    """Where the kinematics are: ring angle (rad, complex for derivatives), speed (rad/s), input torque (N m)."""

    angle: complex
    speed: float
    torque: float


@dataclass(frozen=True)
class MeshState:
    """What one mesh does: displacement (m), velocity (m/s), force (N) and its elastic part, mesh phase (rad)."""

    x: float
    v: float
    force: float
    elastic: float
    phase: float


class ReferenceModel:
    """Forces and accelerations of the whole gearbox."""

    def __init__(self, configuration: Configuration, faults: FaultSettings | None = None, loaded: float = 0.0) -> None:
        """Set up a gearbox; `loaded`: direction of the force on the housing of the bearing with a race defect, rad."""
        self.configuration = configuration
        self.kinematics = derive(configuration)
        self.faults = faults or FaultSettings()
        self._loaded = loaded
        self._differing = TeethThatDiffer(self.kinematics, self.faults)
        self.ring = self.kinematics.ring
        self.masses = self._masses()

    # --- bodies -------------------------------------------------------------------------------------------------------

    def _masses(self) -> Scalars:
        bodies, bearings, ring = self.kinematics.bodies, self.configuration.bearings, self.ring
        masses: Scalars = {}
        for i in range(ring.count):
            masses |= {f"ring.{motion}.{i}": ring.mass for motion in "wvz"} | {f"ring.psi.{i}": ring.inertia}
        gears = {f"p1_{j}": bodies.planet_1 for j in (1, 2, 3)} | {f"p2_{j}": bodies.planet_2 for j in (1, 2, 3)}
        gears |= {"s": bodies.sun, "h1": bodies.herringbone_1, "h2": bodies.herringbone_2}
        for name, body in gears.items():
            masses[f"{name}.u"] = body.base_mass
            masses |= {f"{name}.{axis}": body.mass for axis in ("xy" if name == "h2" else "xyz")}
        for name in names.BEARINGS:
            mass = getattr(bearings, bearing_kind(name)).mass
            masses |= {f"{name}.{axis}": mass for axis in ("xy" if name in {"b21", "b22"} else "xyz")}
        return masses

    def gears(self, mesh: str) -> tuple[Gear | None, Gear]:
        """Driver and driven gear of a mesh; None stands for the ring."""
        pair = self.kinematics.stage(mesh).pair
        origin = np.zeros(3)
        if mesh == "III":
            output = pair.centre_distance * X
            return (
                Gear("h1", origin, -1, pair.driver.base_radius),
                Gear("h2", output, 1, pair.driven.base_radius, axial=False),
            )
        stage, number = mesh.split("_")
        centre = pair.centre_distance * polar(PLANET_ANGLES[int(number) - 1])[0]
        if stage == "I":
            return None, Gear(f"p1_{number}", centre, 1, pair.driven.base_radius)
        return Gear(f"p2_{number}", centre, 1, pair.driver.base_radius), Gear("s", origin, -1, pair.driven.base_radius)

    def segment(self, i: int, angle: complex, point: np.ndarray) -> Movement:
        """Movement of a point fixed to ring segment i, the ring having turned by `angle`."""
        radial, tangential = polar(angle + i * self.ring.pitch)
        return {
            f"ring.w.{i}": radial,
            f"ring.v.{i}": tangential,
            f"ring.z.{i}": Z,
            f"ring.psi.{i}": turned(point - self.ring.radius * radial),
        }

    def ring_movement(self, planet: int, angle: complex, point: np.ndarray) -> Movement:
        """Movement of the ring at planet 1, 2, 3: of the two segments beside it, weighted by nearness."""
        place = (PLANET_ANGLES[planet - 1] - angle) / self.ring.pitch
        first = math.floor(place.real)
        out: Movement = {}
        for i, weight in ((first, 1 - (place - first)), (first + 1, place - first)):
            parts = self.segment(i % self.ring.count, angle, point)
            out |= {name: weight * vector for name, vector in parts.items()}
        return out

    # --- meshes -------------------------------------------------------------------------------------------------------

    def normal(self, mesh: str) -> np.ndarray:
        """Unit normal along which the driver pushes the driven gear (transverse part only)."""
        angle = self.kinematics.stage(mesh).pair.working_angle
        if mesh == "III":
            return math.sin(angle) * X - math.cos(angle) * Y
        stage, number = mesh.split("_")
        radial, tangential = polar(PLANET_ANGLES[int(number) - 1])
        push = math.cos(angle) * tangential
        return -math.sin(angle) * radial + (push if stage == "I" else -push)

    def pitch_point(self, mesh: str) -> np.ndarray:
        """Where the pitch circles touch, m."""
        pair = self.kinematics.stage(mesh).pair
        if mesh == "III":
            return pair.driver.pitch_radius * X
        stage, number = mesh.split("_")
        radius = pair.driver.pitch_radius if stage == "I" else pair.driven.pitch_radius
        return radius * polar(PLANET_ANGLES[int(number) - 1])[0]

    def movements(self, mesh: str, angle: complex, point: np.ndarray) -> tuple[Movement, Movement]:
        """Movement of driver and driven gear at a point."""
        driver, driven = self.gears(mesh)
        if driver is None:
            return self.ring_movement(int(mesh[-1]), angle, point), driven.movement(point)
        return driver.movement(point), driven.movement(point)

    def approach(self, mesh: str, angle: complex) -> dict[str, complex]:
        """Coefficients h of the approach of the two flanks along their normal."""
        pair = self.kinematics.stage(mesh).pair
        axial = 0.0 if pair.halves == 2 else math.sin(pair.base_helix)
        direction = math.cos(pair.base_helix) * self.normal(mesh) + axial * Z
        return along(direction, minus(*self.movements(mesh, angle, self.pitch_point(mesh))))

    def peak(self, stage: Stage) -> float:
        """Mesh phase at which the stiffness is largest."""
        return peak_phase(stage)

    def phase(self, mesh: str, angle: complex) -> complex:
        """Mesh phase, zero where a tooth enters; with the ring unturned planet 1 is at the largest stiffness."""
        stage = self.kinematics.stage(mesh)
        leader = self.kinematics.stage("II") if self.configuration.excitation.mode == "tied" else stage
        number = 0 if mesh == "III" else int(mesh[-1]) - 1
        return leader.mesh_ratio * angle + self.peak(stage) + stage.planet_phases[number]

    def error(self, mesh: str, angle: complex) -> complex:
        """Transmission error, rising through its mean where the stiffness is largest."""
        stage = self.kinematics.stage(mesh)
        wave = np.sin(self.phase(mesh, angle) - self.peak(stage))
        return complex(stage.mesh.error_mean + stage.mesh.error_amplitude * wave)

    def mesh_state(self, mesh: str, q: Mapping[str, float], v: Mapping[str, float], now: Instant) -> MeshState:
        """What one mesh does at coordinates q and rates v; the moving geometry is differentiated by complex steps."""
        stage = self.kinematics.stage(mesh)
        later = now.angle + 1j * TINY
        h = self.approach(mesh, later)
        error = self.error(mesh, later) + self._differing.error(mesh, later)
        growth, left = self._differing.worn(mesh)
        gap = stage.mesh.backlash + growth
        x = math.fsum(c.real * q[name] for name, c in h.items()) + error.real
        moving = math.fsum(c.imag / TINY * q[name] for name, c in h.items()) + error.imag / TINY
        rate = math.fsum(c.real * v[name] for name, c in h.items()) + now.speed * moving
        phase = self.phase(mesh, now.angle).real
        stiffness = stage.stiffness.normal * (1 + stage.stiffness.variation * math.cos(phase - stage.stiffness.phase))
        stiffness *= left * (1.0 - self._differing.loss(mesh, later).real)
        elastic = stiffness * backlash(x, gap)
        damped = self.configuration.mesh.damping_in_gap or abs(x) > gap
        force = elastic + (stage.stiffness.damping * rate if damped else 0.0)
        return MeshState(x, rate, force, elastic, phase)

    def _mesh_forces(self, mesh: str, state: MeshState, now: Instant, forces: Scalars) -> None:
        for name, c in self.approach(mesh, now.angle).items():
            forces[name] -= c.real * state.force
        if not self.configuration.friction.enabled:
            return
        stage, normal = self.kinematics.stage(mesh), self.normal(mesh)
        sign = -1.0 if stage.name == "II" else 1.0
        for s, share in sliding_friction(self.configuration.friction, stage, state.phase, now.speed):
            point = self.pitch_point(mesh) + s * normal
            rubbing = sign * share * abs(state.elastic) * turned(normal)
            driver, driven = self.movements(mesh, now.angle, point)
            for name, c in along(rubbing, minus(driven, driver)).items():
                forces[name] += c.real

    # --- springs ------------------------------------------------------------------------------------------------------

    def springs(self) -> list[tuple[Scalars, float, float]]:
        """Linear springs: coefficients of the elongation, stiffness, damping."""
        shafts, torsion, c = self.configuration.shafts, self.configuration.torsion, self.configuration
        out: list[tuple[Scalars, float, float]] = []

        def spring(h: Scalars, stiffness: float, time: float) -> None:
            out.append((h, stiffness, stiffness * time))

        chains = [([f"pb1_{j}", f"p1_{j}", f"pb2_{j}", f"p2_{j}"], "planet") for j in (1, 2, 3)]
        chains += [(["sb", "s", "h1", "b1"], "sun"), (["b21", "h2", "b22"], "output")]
        for chain, shaft in chains:
            for first, second in pairwise(chain):
                for axis in "xy" if shaft == "output" else "xyz":
                    stiffness = getattr(shafts, f"{shaft}_{'axial' if axis == 'z' else 'radial'}")
                    spring({f"{first}.{axis}": 1.0, f"{second}.{axis}": -1.0}, stiffness, shafts.damping_time)
        bodies = self.kinematics.bodies
        driver, driven = 1 / bodies.planet_1.base_radius, 1 / bodies.planet_2.base_radius
        for j in (1, 2, 3):
            spring({f"p1_{j}.u": driver, f"p2_{j}.u": -driven}, torsion.planet, torsion.damping_time)
        driver, driven = 1 / bodies.sun.base_radius, 1 / bodies.herringbone_1.base_radius
        spring({"s.u": driver, "h1.u": -driven}, torsion.sun, torsion.damping_time)
        spring({"h2.u": 1 / bodies.herringbone_2.base_radius}, c.generator.stiffness, c.generator.damping_time)
        for name in names.BEARINGS:
            damping = getattr(c.bearings, bearing_kind(name)).damping
            out.extend(({f"{name}.{axis}": 1.0}, 0.0, damping) for axis in "xyz" if f"{name}.{axis}" in self.masses)
        return out + self._ring_springs()

    def _ring_springs(self) -> list[tuple[Scalars, float, float]]:
        """Joints, each between the ends of two segments that meet there, and supports.

        The ring looks the same at every angle, so the joints are set up with the ring unturned.
        """
        ring = self.ring
        out: list[tuple[Scalars, float, float]] = []
        for i in range(ring.count):
            following = (i + 1) % ring.count
            radial, tangential = polar((i + 0.5) * ring.pitch)
            joint = ring.radius * radial
            gap = minus(self.segment(following, 0.0, joint), self.segment(i, 0.0, joint))
            kinds = ((radial, ring.radial), (tangential, ring.tangential), (Z, ring.axial))
            for direction, stiffness in kinds:
                h = {name: c.real for name, c in along(direction, gap).items()}
                out.append((h, stiffness, stiffness * ring.damping_time))
            twist = {f"ring.psi.{following}": 1.0, f"ring.psi.{i}": -1.0}
            out.append((twist, ring.rotational, ring.rotational * ring.damping_time))
            out.append(({f"ring.w.{i}": 1.0}, ring.radial_support, ring.radial_support_damping))
            out.append(({f"ring.z.{i}": 1.0}, ring.axial_support, ring.axial_support_damping))
        return out

    # --- bearings and loads -------------------------------------------------------------------------------------------

    def rollers(self, name: str, q: Mapping[str, float], angle: float) -> list[tuple[np.ndarray, float]]:
        """Direction in which each roller of a bearing presses on the housing, and its load (paper Eqs 21-26)."""
        kind = bearing_kind(name)
        bearing = getattr(self.configuration.bearings, kind)
        sense = -1 if kind in {"sb", "b1"} else 1
        shift = np.array([q.get(f"{name}.{axis}", 0.0) for axis in "xyz"])
        out = []
        for i in range(bearing.rollers):
            place = 2 * math.pi * i / bearing.rollers + sense * self.kinematics.cage_ratio[kind] * angle
            axis = math.cos(bearing.contact_angle) * polar(place)[0] + math.sin(bearing.contact_angle) * Z
            sunk = sinking(self.kinematics, self.faults, name, place, self._loaded, angle)
            worn = self.faults.fault_clearance if name == self.faults.fault_clearance_bearing else 0.0
            squeeze = max(float(axis @ shift) - bearing.clearance - worn - sunk, 0.0)
            out.append((axis, self.kinematics.roller_stiffness[kind] * squeeze**self.configuration.bearings.exponent))
        return out

    def bearing_force(self, name: str, q: Mapping[str, float], angle: float) -> np.ndarray:
        """Force of the rollers on the housing (paper Eq 27); on the bearing's moving ring it is the opposite."""
        return sum((load * axis for axis, load in self.rollers(name, q, angle)), np.zeros(3))

    def roller_loads(self, name: str, q: Mapping[str, float], angle: float) -> float:
        """Sum of the loads of a bearing's rollers, or 1 N where all are free."""
        return sum(load for _, load in self.rollers(name, q, angle)) or 1.0

    def _loads(self, now: Instant, forces: Scalars) -> None:
        gravity = self.configuration.gravity
        pull = gravity.acceleration * (math.cos(gravity.direction) * X + math.sin(gravity.direction) * Y)
        for name, mass in self.masses.items():
            body, motion = name.split(".")[:2]
            if motion in "xy":
                forces[name] += mass * float(pull @ (X if motion == "x" else Y))
            elif body == "ring" and motion in "wv":
                directions = polar(now.angle.real + int(name.split(".")[2]) * self.ring.pitch)
                forces[name] += mass * float(pull @ directions["wv".index(motion)])
        for i in range(self.ring.count):
            forces[f"ring.v.{i}"] += now.torque / (self.ring.count * self.ring.radius)
        output = now.torque / self.kinematics.total_ratio
        forces["h2.u"] -= output / self.kinematics.bodies.herringbone_2.base_radius

    # --- everything -------------------------------------------------------------------------------------------------

    def forces(self, q: Mapping[str, float], v: Mapping[str, float], now: Instant) -> Scalars:
        """Generalised force on each coordinate, N (N m on ring.psi)."""
        forces: Scalars = defaultdict(float)
        for mesh in names.MESHES:
            self._mesh_forces(mesh, self.mesh_state(mesh, q, v, now), now, forces)
        for h, stiffness, damping in self.springs():
            tension = sum(c * (stiffness * q[name] + damping * v[name]) for name, c in h.items())
            for name, c in h.items():
                forces[name] -= c * tension
        for name in names.BEARINGS:
            for axis, force in zip("xyz", self.bearing_force(name, q, now.angle.real), strict=True):
                if f"{name}.{axis}" in self.masses:
                    forces[f"{name}.{axis}"] -= float(force)
        self._loads(now, forces)
        return forces

    def accelerations(self, q: Mapping[str, float], v: Mapping[str, float], now: Instant) -> Scalars:
        """Second derivative of each coordinate, m/s^2 (rad/s^2 of ring.psi)."""
        forces = self.forces(q, v, now)
        return {name: forces[name] / mass for name, mass in self.masses.items()}
