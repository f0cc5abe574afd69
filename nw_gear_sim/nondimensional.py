"""The nondimensional form of the equations (paper Eqs 50-62): scales, conversion both ways, and parameters.

Length is measured in b, the half backlash of stage II, and time in 1 / omega_n, omega_n = sqrt(K_m / M_e) of stage II.
Each equation is divided by the mass m of its own body (I / r_b^2 where u is the motion), so that

    q^ = q / b    tau = omega_n t    q^' = q' / (b omega_n)    f = F / (m b omega_n^2)    f_g = g / (b omega_n^2)
    k = K / (m omega_n^2)      zeta = C / (2 m omega_n)      t = T / (r_b m_u b omega_n^2)

The paper prints T / (m_u b^2 omega_n^2), which has no r_b and is no pure number. Nothing is computed in these units;
they are for input and output.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.kinematics import Kinematics, bearing_kind
from nw_gear_sim.params import Configuration

Value = TypeVar("Value", float, Array)


@dataclass(frozen=True)
class Scales:
    """The units of the nondimensional form.

    Attributes:
        length: b of stage II, m; frequency: omega_n, rad/s.
    """

    length: float
    frequency: float

    @property
    def time(self) -> float:
        """1 / omega_n, s."""
        return 1 / self.frequency

    @property
    def velocity(self) -> float:
        """Unit b omega_n, m/s."""
        return self.length * self.frequency

    @property
    def acceleration(self) -> float:
        """Unit b omega_n^2, m/s^2; gravity is f_g of it."""
        return self.length * self.frequency**2

    def force(self, mass: Value) -> Value:
        """Unit m b omega_n^2 (N) of the forces on a body of `mass` (kg)."""
        return mass * self.acceleration

    def torque(self, mass: float, base_radius: float) -> float:
        """Unit r_b m_u b omega_n^2 (N m) of torques on a gear whose u moves `mass` (kg), base radius in m."""
        return base_radius * mass * self.acceleration

    def stiffness(self, mass: Value) -> Value:
        """Unit m omega_n^2 (N/m) of the springs at a body of `mass` (kg)."""
        return mass * self.frequency**2

    def damping(self, mass: Value) -> Value:
        """Unit 2 m omega_n (N s/m), in which a damper at a body of `mass` (kg) is its zeta."""
        return 2 * mass * self.frequency


def scales(configuration: Configuration, kinematics: Kinematics) -> Scales:
    """Return the scales of a gearbox.

    Raises:
        InputError: without backlash in stage II there is no unit of length.
    """
    length = configuration.mesh.II.backlash
    if length <= 0:
        raise InputError(
            "mesh.II.backlash", "more than 0, the unit of length of the nondimensional form", f"{length:g}"
        )
    return Scales(length, kinematics.omega_n)


_Unit = Callable[[Configuration, Kinematics, Scales], float]


def _units() -> dict[str, tuple[str, _Unit]]:
    """The parameters that may be given nondimensionally: symbol, and the SI value of 1."""
    out: dict[str, tuple[str, _Unit]] = {}

    def length(key: str, symbol: str) -> None:
        out[key] = (f"{symbol} / b_II", lambda _c, _k, s: s.length)

    for stage in names.STAGES:
        if stage != "II":
            length(f"mesh.{stage}.backlash", "b")
            out[f"mesh.{stage}.stiffness"] = (
                "k_m = K_m / (M_e omega_n^2)",
                lambda _c, k, s, stage=stage: s.stiffness(k.stage(stage).stiffness.effective_mass),  # type: ignore[misc]
            )
        length(f"mesh.{stage}.error_amplitude", "e_r")
        length(f"mesh.{stage}.error_mean", "e_a")
    for kind in dict.fromkeys(bearing_kind(bearing) for bearing in names.BEARINGS):
        length(f"bearings.{kind}.clearance", "c")
        out[f"bearings.{kind}.damping"] = (
            "zeta = C / (2 m omega_n)",
            lambda c, _k, s, kind=kind: s.damping(getattr(c.bearings, kind).mass),  # type: ignore[misc]
        )
        out[f"bearings.{kind}.stiffness"] = (
            "K b^(n - 1) / (m omega_n^2)",
            lambda c, _k, s, kind=kind: (  # type: ignore[misc]
                s.stiffness(getattr(c.bearings, kind).mass) / s.length ** (c.bearings.exponent - 1)
            ),
        )
    for key, body in (
        ("shafts.planet_radial", "planet_1"),
        ("shafts.planet_axial", "planet_1"),
        ("shafts.sun_radial", "sun"),
        ("shafts.sun_axial", "sun"),
        ("shafts.output_radial", "herringbone_2"),
    ):
        symbol = f"k = K / (m omega_n^2), m of {body}"
        out[key] = (symbol, lambda _c, k, s, body=body: s.stiffness(getattr(k.bodies, body).mass))  # type: ignore[misc]
    for key, body in (
        ("torsion.planet", "planet_1"),
        ("torsion.sun", "sun"),
        ("generator.stiffness", "herringbone_2"),
    ):
        symbol = f"k = K / (I omega_n^2), I of {body}"
        out[key] = (symbol, lambda _c, k, s, body=body: s.stiffness(getattr(k.bodies, body).inertia))  # type: ignore[misc]
    out["ring.radial_support"] = (
        "k of a segment = 2 K / (m omega_n^2), m of the ring",
        lambda _c, k, s: s.stiffness(k.bodies.ring.mass) / 2,
    )
    out["ring.axial_support"] = (
        "k of a segment = K / (m omega_n^2), m of the ring",
        lambda _c, k, s: s.stiffness(k.bodies.ring.mass),
    )
    out["gravity.acceleration"] = ("f_g = g / (b_II omega_n^2)", lambda _c, _k, s: s.acceleration)
    out["turbine.rated_torque"] = (
        "t_in = T / (r_b m_u b_II omega_n^2) of the ring",
        lambda _c, k, s: s.torque(k.bodies.ring.base_mass, k.bodies.ring.base_radius),
    )
    for key in ("operation.ring_speed", "turbine.rated_speed"):
        out[key] = ("omega / omega_n", lambda _c, _k, s: s.frequency)
    for section in ("shafts", "torsion", "generator"):
        out[f"{section}.damping_time"] = ("tau = omega_n t", lambda _c, _k, s: s.time)
    out["ring.joint_damping_time"] = ("tau = omega_n t", lambda _c, _k, s: s.time)
    return out


UNITS = _units()
"""Parameters by dotted key: definition of the number, and the function that gives the SI value of 1.

`mesh.II.backlash` and `mesh.II.stiffness` aren't among them: they, the teeth and the masses make the scales.
"""


def unit(key: str, configuration: Configuration, kinematics: Kinematics) -> float:
    """Return the SI value of 1 of a parameter (see UNITS).

    Raises:
        KeyError: the parameter has no nondimensional form.
    """
    return UNITS[key][1](configuration, kinematics, scales(configuration, kinematics))


def parameters(configuration: Configuration, kinematics: Kinematics) -> dict[str, float]:
    """Return every parameter that has a nondimensional form as a pure number, by dotted key, besides those unset."""
    values = {}
    for key in UNITS:
        value: object = configuration
        for name in key.split("."):
            value = getattr(value, name)
        if isinstance(value, float):
            values[key] = value / unit(key, configuration, kinematics)
    return values


def derived(configuration: Configuration, kinematics: Kinematics) -> dict[str, float]:
    """Return the numbers of the nondimensional equations that follow from the parameters.

    `omega_I` .. `omega_III`: mesh frequencies at the fixed operating point over omega_n; `k_m_I` ..: mean mesh
    stiffness; `k_I` ..: its first harmonic over the mean; `zeta_I` ..: of the meshes; `f_g`, `t_in`.
    """
    scale = scales(configuration, kinematics)
    ring = kinematics.bodies.ring
    out = {}
    for stage in kinematics.stages:
        stiffness = stage.stiffness
        out[f"omega_{stage.name}"] = stage.mesh_ratio * kinematics.ring_speed / scale.frequency
        out[f"k_m_{stage.name}"] = stiffness.transverse / scale.stiffness(stiffness.effective_mass)
        out[f"k_{stage.name}"] = stiffness.variation
        damping = 2 * stage.mesh.damping_ratio * np.sqrt(stiffness.transverse * stiffness.effective_mass)
        out[f"zeta_{stage.name}"] = float(damping / scale.damping(stiffness.effective_mass))
    out["f_g"] = configuration.gravity.acceleration / scale.acceleration
    out["t_in"] = kinematics.input_torque / scale.torque(ring.base_mass, ring.base_radius)
    return out


def bearing_masses(configuration: Configuration) -> Array:
    """Masses of the bearings' rings in the order of names.BEARINGS, kg: their forces are f = F / (m b omega_n^2)."""
    return np.array([getattr(configuration.bearings, bearing_kind(name)).mass for name in names.BEARINGS])


def mesh_masses(kinematics: Kinematics) -> Array:
    """Effective masses M_e of the meshes in the order of names.MESHES, kg: their f = F / (M_e b omega_n^2)."""
    return np.array([kinematics.stage(mesh).stiffness.effective_mass for mesh in names.MESHES])


def signals(
    si: Mapping[str, Array], configuration: Configuration, kinematics: Kinematics, *, back: bool = False
) -> dict[str, Array]:
    """Convert sampled quantities, such as the attributes of a `simulation.Block`, to nondimensional form.

    Args:
        si: by name, among `time` (n,), `x`, `v`, `force` (n, 7), `bearing_force` (n, 10, 3), `shaft_speed` (n, 4),
            `shaft_torque` (n, 4), `phase`, `shaft_angle` (angles stay as they are); `vars(block)` will do.
        configuration, kinematics: of the gearbox.
        back: convert from nondimensional form to SI instead.

    Raises:
        InputError: an unknown name.
    """
    scale, bodies = scales(configuration, kinematics), kinematics.bodies
    gears = (bodies.ring, bodies.planet_1, bodies.sun, bodies.herringbone_2)
    unit_of: dict[str, Array | float] = {
        "time": scale.time,
        "x": scale.length,
        "v": scale.velocity,
        "force": scale.force(mesh_masses(kinematics)),
        "bearing_force": scale.force(bearing_masses(configuration))[:, None],
        "shaft_speed": scale.frequency,
        "shaft_torque": np.array([scale.torque(gear.base_mass, gear.base_radius) for gear in gears]),
        **dict.fromkeys(("phase", "shaft_angle", "open_fraction", "back_fraction"), 1.0),
    }
    unknown = [name for name in si if name not in unit_of]
    if unknown:
        raise InputError("nondimensional signals", "one of " + ", ".join(unit_of), unknown[0])
    return {name: value * unit_of[name] if back else value / unit_of[name] for name, value in si.items()}
