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


@dataclass(frozen=True)
class Numerics:
    """How the equations are solved."""

    integrator: str = quantity(
        MISSING,
        "gautschi: fast, ring modes below ring_bandwidth; etdrk4: precise, all ring modes; rk4: the paper's",
        choices=("gautschi", "etdrk4", "rk4"),
    )
    step: float = quantity(MISSING, "time step of the integrator", "s", minimum=1e-7, maximum=1e-2)
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
