"""Parameters of what carries the gears: bearings, shafts, the flexible ring, the generator's coupling, housings."""

from __future__ import annotations

import math
from dataclasses import MISSING, dataclass

from nw_gear_common.quantities import quantity


@dataclass(frozen=True)
class Bearing:
    """One kind of rolling bearing with its ring's mass."""

    rollers: int = quantity(
        MISSING, "number of rollers; the first one is on the x axis at t = 0", minimum=3, maximum=500
    )
    roller_length: float = quantity(MISSING, "effective length of a roller", "m", minimum=1e-3, maximum=2.0)
    contact_angle: float = quantity(
        MISSING,
        "contact angle; its sign is the axial direction the bearing holds",
        "rad",
        minimum=-math.pi / 3,
        maximum=math.pi / 3,
    )
    clearance: float = quantity(
        MISSING, "radial clearance: half of the mounted diametral one", "m", minimum=0.0, maximum=1e-2
    )
    stiffness: float | None = quantity(
        MISSING,
        "load constant K of Q = K delta^n of a roller; none = Palmgren's law",
        "N/m^n",
        minimum=1e3,
        maximum=1e14,
    )
    cage_factor: float = quantity(
        MISSING, "cage speed over shaft speed: r_i / (r_i + r_o) (paper Eq 20)", minimum=0.0, maximum=1.0
    )
    mass: float = quantity(MISSING, "mass of the moving bearing ring", "kg", minimum=1e-3, maximum=1e5)
    damping: float = quantity(
        MISSING, "viscous damping of the moving ring to ground", "N s/m", minimum=0.0, maximum=1e9
    )


@dataclass(frozen=True)
class Bearings:
    """The kinds of bearings; pb1 and pb2 occur on each of the three planets."""

    pb1: Bearing
    pb2: Bearing
    sb: Bearing
    b1: Bearing
    b21: Bearing
    b22: Bearing
    exponent: float = quantity(
        MISSING, "exponent n of the roller load, 10/9 for rollers, 3/2 for balls", minimum=1.0, maximum=2.0
    )


@dataclass(frozen=True)
class Shafts:
    """Bending and axial springs between neighbours on a shaft (bearing - gear - gear - bearing)."""

    planet_radial: float = quantity(MISSING, "radial spring K_px on the planet pins", "N/m", minimum=0.0, maximum=1e13)
    planet_axial: float = quantity(MISSING, "axial spring K_pz on the planet pins", "N/m", minimum=0.0, maximum=1e13)
    sun_radial: float = quantity(MISSING, "radial spring K_sx on the sun shaft", "N/m", minimum=0.0, maximum=1e13)
    sun_axial: float = quantity(MISSING, "axial spring K_sz on the sun shaft", "N/m", minimum=0.0, maximum=1e13)
    output_radial: float = quantity(MISSING, "radial spring K_2x on the output shaft", "N/m", minimum=0.0, maximum=1e13)
    damping_time: float = quantity(MISSING, "damping over stiffness of these springs", "s", minimum=0.0, maximum=1e-2)


@dataclass(frozen=True)
class Torsion:
    """Torsion springs between the two gears of a shaft."""

    planet: float = quantity(MISSING, "planet_1 to planet_2", "N m/rad", minimum=1.0, maximum=1e13)
    sun: float = quantity(MISSING, "sun to herringbone_1", "N m/rad", minimum=1.0, maximum=1e13)
    damping_time: float = quantity(MISSING, "damping over stiffness of these springs", "s", minimum=0.0, maximum=1e-2)


@dataclass(frozen=True)
class Ring:
    """The flexible ring: rigid segments with elastic joints, supported radially and axially."""

    segments: int = quantity(MISSING, "number M of segments", minimum=12, maximum=1000)
    outer_radius: float = quantity(MISSING, "outer radius of the rim", "m", minimum=1e-2, maximum=10.0)
    elastic_modulus: float = quantity(MISSING, "Young's modulus", "Pa", minimum=1e6, maximum=1e13)
    poisson_ratio: float = quantity(MISSING, "Poisson's ratio", minimum=0.0, maximum=0.499)
    joint_damping_time: float = quantity(
        MISSING, "damping over stiffness of the joints", "s", minimum=0.0, maximum=1e-2
    )
    radial_support: float = quantity(
        MISSING,
        "stiffness of the whole ring against a radial shift; each segment has 2/M of it",
        "N/m",
        minimum=0.0,
        maximum=1e13,
    )
    axial_support: float = quantity(
        MISSING,
        "stiffness of the whole ring against an axial shift; each segment has 1/M of it",
        "N/m",
        minimum=0.0,
        maximum=1e13,
    )
    support_damping_ratio: float = quantity(
        MISSING, "damping ratio of a segment on its support", minimum=0.0, maximum=1.0
    )


@dataclass(frozen=True)
class Generator:
    """Coupling of the output shaft to a speed-controlled generator."""

    stiffness: float = quantity(MISSING, "torsion spring K_u2", "N m/rad", minimum=1.0, maximum=1e13)
    damping_time: float = quantity(MISSING, "damping over stiffness of that spring", "s", minimum=0.0, maximum=1.0)


@dataclass(frozen=True)
class Housing:
    """What stands under an accelerometer: the housing at one kind of bearing as an oscillator, alike in x and y."""

    mass: float = quantity(MISSING, "modal mass of the housing at the bearing", "kg", minimum=1.0, maximum=1e6)
    frequency: float = quantity(MISSING, "natural frequency of the housing there", "Hz", minimum=1.0, maximum=1e4)
    damping_ratio: float = quantity(MISSING, "damping ratio of the housing there", minimum=0.0, maximum=1.0)


@dataclass(frozen=True)
class Housings:
    """The housing at each kind of bearing; it doesn't act back on the gears, accelerometers alone see it."""

    pb1: Housing
    pb2: Housing
    sb: Housing
    b1: Housing
    b21: Housing
    b22: Housing
