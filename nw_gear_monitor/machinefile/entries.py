"""What stands in the file of a machine, declared once: keys, units, bounds and what they mean."""

from __future__ import annotations

from dataclasses import MISSING, dataclass

from nw_gear_common.quantities import quantity


@dataclass(frozen=True, kw_only=True)
class Reference:
    """What tells where the machine is in its turn."""

    shaft: str = quantity(MISSING, "shaft whose phase is measured")
    phase: str = quantity(MISSING, "column with its unwrapped phase, rad")
    speed: float = quantity(MISSING, "its nominal speed", "rad/s", minimum=1e-3, maximum=1e5)


@dataclass(frozen=True, kw_only=True)
class Gear:
    """One gear of a stage."""

    shaft: str = quantity(MISSING, "shaft it sits on")
    teeth: int = quantity(MISSING, "number of teeth", minimum=5, maximum=1000)


@dataclass(frozen=True, kw_only=True)
class StageEntry:
    """One gear stage."""

    name: str = quantity(MISSING, "part of the topic section/<name>")
    driver: Gear | None = None
    driven: Gear | None = None
    cycles: float | None = quantity(
        None, "mesh cycles per turn of the reference shaft, where teeth alone don't tell", minimum=1e-3, maximum=1e5
    )
    phase: str = quantity("", "column with the unwrapped mesh phase itself, rad")
    half_backlash: float | None = quantity(
        None, "displacement at which the flanks touch", "m", minimum=0.0, maximum=1e-2
    )


@dataclass(frozen=True, kw_only=True)
class ShaftEntry:
    """A shaft that no stage tells the speed of."""

    name: str = quantity(MISSING, "name")
    ratio: float = quantity(MISSING, "its speed over that of the reference shaft", minimum=1e-4, maximum=1e4)


@dataclass(frozen=True, kw_only=True)
class ChannelEntry:
    """One measured vibration."""

    name: str = quantity(MISSING, "part of the topic indicators/<name>")
    stage: str = quantity(MISSING, "stage it belongs to")
    column: str = quantity(MISSING, "column of the waveform")
    velocity: str = quantity("", "column with its derivative; made by differences where there is none")
    unit: str = quantity(MISSING, "unit of the column, for people")
    load: bool = quantity(False, "whether its mean follows the load")
    planet: int = quantity(1, "number of the planet", minimum=1, maximum=100)
    planet_phase: float = quantity(
        0.0, "what its mesh phase has more than that of planet 1", "rad", minimum=-1e4, maximum=1e4
    )


@dataclass(frozen=True, kw_only=True)
class BearingEntry:
    """One bearing: geometry, or rollers and cage factor, or orders."""

    name: str = quantity(MISSING, "part of the topic indicators/<name>")
    shaft: str = quantity(MISSING, "shaft that turns in it")
    columns: tuple[str, ...] = quantity(MISSING, "one or two columns of the waveform")
    unit: str = quantity(MISSING, "unit of the columns, for people")
    rollers: int | None = quantity(None, "their number", minimum=3, maximum=500)
    roller_diameter: float | None = quantity(None, "diameter of a roller", "m", minimum=1e-4, maximum=1.0)
    pitch_diameter: float | None = quantity(None, "diameter of the rollers' circle", "m", minimum=1e-3, maximum=10.0)
    contact_angle: float = quantity(0.0, "contact angle", "rad", minimum=0.0, maximum=1.5)
    cage_factor: float | None = quantity(None, "speed of the cage over that of the shaft", minimum=0.01, maximum=0.99)
    outer: float | None = quantity(None, "knocks of a spot of the outer race per turn", minimum=0.1, maximum=500.0)
    inner: float | None = quantity(None, "knocks of a spot of the inner race per turn", minimum=0.1, maximum=500.0)
    cage: float | None = quantity(None, "turns of the cage per turn", minimum=0.01, maximum=0.99)
    roller: float | None = quantity(None, "turns of a roller about its axis per turn", minimum=0.1, maximum=500.0)


@dataclass(frozen=True, kw_only=True)
class Entries:
    """A whole file.

    Attributes:
        places: file and line of `reference`, and of every entry as `<list>[<number>]`.
    """

    name: str
    sidebands: int
    reference: Reference
    stages: tuple[StageEntry, ...]
    channels: tuple[ChannelEntry, ...]
    shafts: tuple[ShaftEntry, ...]
    bearings: tuple[BearingEntry, ...]
    places: dict[str, str]
