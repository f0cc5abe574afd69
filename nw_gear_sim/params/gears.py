"""Parameters of the gears, their teeth and their meshes.

The pinion of a stage is its smaller gear: planet_1 (I), sun (II), herringbone_2 (III).
"""

from __future__ import annotations

import math
from dataclasses import MISSING, dataclass

from nw_gear_common.quantities import quantity


@dataclass(frozen=True)
class Gear:
    """One gear wheel."""

    teeth: int = quantity(MISSING, "number of teeth", minimum=5, maximum=1000)
    mass: float = quantity(MISSING, "mass", "kg", minimum=1e-3, maximum=1e6)


@dataclass(frozen=True)
class Wheel(Gear):
    """A gear on a shaft: a hollow cylinder between its bore and its reference circle."""

    bore_radius: float = quantity(MISSING, "radius of the bore that gives the inertia", "m", minimum=0.0, maximum=10.0)


@dataclass(frozen=True)
class Gears:
    """The six gears along the power flow; planet_1 and planet_2 are one stepped planet, and there are three."""

    ring: Gear
    planet_1: Wheel
    planet_2: Wheel
    sun: Wheel
    herringbone_1: Wheel
    herringbone_2: Wheel


@dataclass(frozen=True)
class Toothing:
    """The tooth form which both gears of a stage share."""

    normal_module: float = quantity(MISSING, "normal module", "m", minimum=1e-4, maximum=0.2)
    pressure_angle: float = quantity(
        MISSING, "normal pressure angle", "rad", minimum=math.radians(10), maximum=math.radians(35)
    )
    helix_angle: float = quantity(
        MISSING, "helix angle at the reference circle", "rad", minimum=0.0, maximum=math.pi / 4
    )
    face_width: float = quantity(
        MISSING, "face width; of both halves together where herringbone", "m", minimum=1e-3, maximum=10.0
    )
    halves: int = quantity(MISSING, "halves of opposite hand: 1 helical, 2 herringbone", minimum=1, maximum=2)
    addendum: float = quantity(MISSING, "addendum coefficient (in normal modules)", minimum=0.5, maximum=1.5)
    dedendum: float = quantity(MISSING, "dedendum coefficient (in normal modules)", minimum=0.5, maximum=2.0)
    pinion_shift: float = quantity(
        MISSING,
        "profile shift coefficient of the pinion; the wheel's follows from the centre distance",
        minimum=-1.0,
        maximum=2.0,
    )


@dataclass(frozen=True)
class Toothings:
    """Tooth forms of the three stages."""

    I: Toothing  # noqa: E741 - the stage's name in the contract
    II: Toothing
    III: Toothing


@dataclass(frozen=True)
class CentreDistance:
    """Working distances between axes."""

    planets: float = quantity(
        MISSING, "gearbox axis to planet axis: stages I and II share it", "m", minimum=1e-2, maximum=10.0
    )
    output: float | None = quantity(
        MISSING, "gearbox axis to output axis; none = without profile shift", "m", minimum=1e-2, maximum=10.0
    )


@dataclass(frozen=True)
class Mesh:
    """Elasticity, clearance and error of one stage's mesh, along the normal of the tooth flanks."""

    backlash: float = quantity(
        MISSING, "half of the normal backlash: the tooth moves freely by +- this", "m", minimum=0.0, maximum=1e-2
    )
    error_amplitude: float = quantity(
        MISSING, "amplitude of the transmission error at mesh frequency", "m", minimum=0.0, maximum=1e-2
    )
    error_mean: float = quantity(MISSING, "mean of the transmission error", "m", minimum=-1e-2, maximum=1e-2)
    damping_ratio: float = quantity(
        MISSING, "damping ratio of the gear pair on its mesh stiffness", minimum=0.0, maximum=1.0
    )
    stiffness: float | None = quantity(
        MISSING,
        "mean transverse mesh stiffness on the base-circle arc; none = ISO 6336-1 method B",
        "N/m",
        minimum=1e3,
        maximum=1e14,
    )
    stiffness_variation: float | None = quantity(
        MISSING,
        "first harmonic of the stiffness over its mean, signed; none = from the contact length",
        minimum=-0.95,
        maximum=0.95,
    )


@dataclass(frozen=True)
class Meshes:
    """Meshes of the three stages."""

    I: Mesh  # noqa: E741 - the stage's name in the contract
    II: Mesh
    III: Mesh
    damping_in_gap: bool = quantity(MISSING, "whether mesh damping acts while the flanks are apart (paper Eq 35)")


@dataclass(frozen=True)
class Friction:
    """Sliding friction of the flanks: mu(V) = base exp(-decay |V|) + growth sqrt|V| (Buckingham, paper Eq 8)."""

    enabled: bool = quantity(MISSING, "whether the flanks rub")
    base: float = quantity(MISSING, "coefficient of friction at rest", minimum=0.0, maximum=1.0)
    decay: float = quantity(MISSING, "rate of decay with the sliding speed", "s/m", minimum=0.0, maximum=10.0)
    growth: float = quantity(
        MISSING, "coefficient of the square root of the sliding speed", "(s/m)^0.5", minimum=0.0, maximum=1.0
    )
