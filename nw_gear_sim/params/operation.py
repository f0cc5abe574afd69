"""Parameters of the turbine, the wind, the operating point and the computation."""

from __future__ import annotations

import math
from dataclasses import MISSING, dataclass

from nw_gear_common.quantities import quantity


@dataclass(frozen=True)
class Turbine:
    """The wind turbine in front of the gearbox (paper Table 1, Eq 2)."""

    rated_torque: float = quantity(MISSING, "torque on the ring at rated wind speed", "N m", minimum=1.0, maximum=1e9)
    rated_speed: float = quantity(MISSING, "speed of the ring at rated wind speed", "rad/s", minimum=1e-3, maximum=1e3)
    rated_wind: float = quantity(MISSING, "rated wind speed", "m/s", minimum=1.0, maximum=100.0)
    cut_in_wind: float = quantity(MISSING, "wind speed at which the turbine starts", "m/s", minimum=0.0, maximum=100.0)
    cut_out_wind: float = quantity(MISSING, "wind speed at which the turbine stops", "m/s", minimum=1.0, maximum=200.0)
    blade_diameter: float = quantity(MISSING, "diameter of the rotor", "m", minimum=1.0, maximum=1000.0)
    blades: int = quantity(MISSING, "number of blades", minimum=1, maximum=12)
    time_constant: float = quantity(
        MISSING, "time in which the shaft speed follows the wind", "s", minimum=0.0, maximum=1000.0
    )


@dataclass(frozen=True)
class Wind:
    """The default wind: a Weibull distributed process (paper Eq 1), correlated in time."""

    weibull_shape: float = quantity(MISSING, "shape k of the Weibull distribution", minimum=0.5, maximum=50.0)
    weibull_scale: float = quantity(MISSING, "scale C of the Weibull distribution", "m/s", minimum=0.1, maximum=100.0)
    sampling_interval: float = quantity(MISSING, "time between draws", "s", minimum=1e-3, maximum=600.0)
    correlation_time: float = quantity(
        MISSING, "time in which the correlation falls to 1/e", "s", minimum=0.0, maximum=3600.0
    )


@dataclass(frozen=True)
class Drivetrain:
    """Rotor, low-speed shaft and generator, for the load cases (`physics.drivetrain`)."""

    rotor_inertia: float = quantity(MISSING, "moment of inertia of the rotor", "kg m^2", minimum=1e3, maximum=1e10)
    generator_inertia: float = quantity(
        MISSING, "moment of inertia of the generator, referred to the ring's shaft", "kg m^2", minimum=1e3, maximum=1e10
    )
    shaft_stiffness: float = quantity(
        MISSING, "torsional stiffness of the low-speed shaft", "N m/rad", minimum=1e5, maximum=1e12
    )
    shaft_damping_ratio: float = quantity(
        MISSING, "damping ratio of the free torsional oscillation", minimum=0.0, maximum=1.0
    )
    runaway_ratio: float = quantity(
        MISSING, "speed over steady speed at which the wind drives no more", minimum=1.01, maximum=100.0
    )
    feathered_drag: float = quantity(
        MISSING, "drag of feathered blades at rated speed over rated torque", minimum=0.0, maximum=10.0
    )
    start_time: float = quantity(
        MISSING, "time in which the pitch lets the wind act at start-up", "s", minimum=0.0, maximum=1000.0
    )
    connect_time: float = quantity(
        MISSING, "time in which the generator takes over its torque at start-up", "s", minimum=0.0, maximum=1000.0
    )
    shutdown_time: float = quantity(
        MISSING, "time in which wind and generator are ramped down", "s", minimum=0.0, maximum=1000.0
    )
    trip_time: float = quantity(
        MISSING, "time in which the generator's torque vanishes when it trips", "s", minimum=0.0, maximum=10.0
    )
    pitch_lag: float = quantity(
        MISSING, "time in which the pitch follows a wind above the rated one", "s", minimum=0.0, maximum=100.0
    )
    pitch_delay: float = quantity(
        MISSING, "time until the pitch answers to a loss of the grid", "s", minimum=0.0, maximum=1000.0
    )
    pitch_time: float = quantity(
        MISSING, "time in which the pitch takes the wind's torque away in an emergency", "s", minimum=0.0, maximum=100.0
    )
    brake_torque: float = quantity(
        MISSING, "largest torque of the brake, referred to the ring's shaft", "N m", minimum=1.0, maximum=1e9
    )
    brake_time: float = quantity(
        MISSING, "time constant of the braked speed below the largest torque", "s", minimum=0.1, maximum=100.0
    )
    brake_rise_time: float = quantity(
        MISSING, "time in which the brake's torque builds up", "s", minimum=0.0, maximum=10.0
    )
    brake_speed: float = quantity(
        MISSING, "speed over rated speed below which the brake ends a shutdown", minimum=0.0, maximum=2.0
    )


@dataclass(frozen=True)
class Operation:
    """The operating point: from the wind, or fixed."""

    drive: str = quantity(MISSING, "what sets speed and torque", choices=("wind", "fixed"))
    load: float = quantity(MISSING, "torque over rated torque where the drive is fixed", minimum=0.0, maximum=10.0)
    ring_speed: float = quantity(
        MISSING, "speed of the ring where the drive is fixed", "rad/s", minimum=0.0, maximum=1e3
    )


@dataclass(frozen=True)
class Excitation:
    """How the meshes excite the gearbox."""

    mode: str = quantity(
        MISSING,
        "kinematic: each stage at its own mesh frequency; tied: all at that of stage II",
        choices=("kinematic", "tied"),
    )
    omega_e: float | None = quantity(
        MISSING,
        "mesh frequency of stage II over omega_n; given, it replaces operation.ring_speed",
        minimum=0.0,
        maximum=10.0,
    )


@dataclass(frozen=True)
class Gravity:
    """Weight of the parts, in the plane of rotation."""

    acceleration: float = quantity(MISSING, "acceleration of gravity", "m/s^2", minimum=0.0, maximum=1e3)
    direction: float = quantity(
        MISSING, "angle from the x axis of the direction things fall in", "rad", minimum=-math.pi, maximum=math.pi
    )


OWN_STEPS = {"gautschi": 1 / 20480, "etdrk4": 1 / 20480, "rk4": 1 / 40960}
"""Steps where none is given, s: below the bounds with 100 ring segments, and whole parts of 1/5120 s."""


@dataclass(frozen=True)
class Numerics:
    """How the equations are solved."""

    integrator: str = quantity(
        MISSING,
        "gautschi: fast, ring modes below ring_bandwidth; etdrk4: precise, all ring modes; rk4: the paper's",
        choices=("gautschi", "etdrk4", "rk4"),
    )
    step: float | None = quantity(
        MISSING,
        "time step of the integrator; none: its own, 1/20480 s of gautschi and etdrk4, 1/40960 s of rk4",
        "s",
        minimum=1e-7,
        maximum=1e-2,
    )
    ring_bandwidth: float = quantity(
        MISSING,
        "frequency above which gautschi takes ring modes as a static flexibility",
        "Hz",
        minimum=100.0,
        maximum=1e6,
    )
    ring: str = quantity(
        MISSING, "whether the ring's segments can move against each other", choices=("flexible", "rigid")
    )

    @property
    def time_step(self) -> float:
        """The step given, or the integrator's own, s."""
        return self.step if self.step is not None else OWN_STEPS[self.integrator]
