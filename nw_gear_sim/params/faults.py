"""What can go wrong with the gearbox, and by how much: the same numbers as live parameters of `gear_sim_node`."""

from __future__ import annotations

from dataclasses import dataclass

from nw_gear_common import names
from nw_gear_common.quantities import quantity

GEARS = ("ring", *(f"p1_{j}" for j in (1, 2, 3)), *(f"p2_{j}" for j in (1, 2, 3)), "sun", "wheel", "pinion")
"""The gears: planets of stage I and II, wheel and pinion of stage III."""
RACES = ("outer", "inner")


@dataclass(frozen=True)
class FaultSettings:
    """One fault of each kind; those of severity 0 aren't there."""

    fault_crack_gear: str = quantity("sun", "Gear with a cracked tooth.", live=True, choices=GEARS)
    fault_crack_tooth: int = quantity(0, "Number of the cracked tooth.", live=True, minimum=0, maximum=1000)
    fault_crack: float = quantity(
        0.0, "Loss of stiffness of the pair that holds the cracked tooth, over its own.", "1", live=True,
        minimum=0.0, maximum=1.0,
    )  # fmt: skip
    fault_pitch_gear: str = quantity("sun", "Gear with a single pitch error.", live=True, choices=GEARS)
    fault_pitch_tooth: int = quantity(
        0, "Number of the tooth that is out of place.", live=True, minimum=0, maximum=1000
    )
    fault_pitch: float = quantity(
        0.0, "Pitch error of that tooth; positive closes the gap.", "m", live=True, minimum=-1e-3, maximum=1e-3
    )
    fault_eccentric_gear: str = quantity("sun", "Eccentric gear.", live=True, choices=GEARS)
    fault_eccentricity: float = quantity(
        0.0, "Amplitude of the transmission error once a turn of that gear.", "m", live=True, minimum=0.0, maximum=1e-3
    )
    fault_wear_stage: str = quantity("II", "Stage with worn flanks.", live=True, choices=names.STAGES)
    fault_wear: float = quantity(
        0.0, "Growth of half the backlash of that stage.", "m", live=True, minimum=0.0, maximum=1e-3
    )
    fault_wear_stiffness: float = quantity(
        0.0, "Loss of mesh stiffness of that stage, over its own.", "1", live=True, minimum=0.0, maximum=0.9
    )
    fault_clearance_bearing: str = quantity("b1", "Bearing with too much clearance.", live=True, choices=names.BEARINGS)
    fault_clearance: float = quantity(
        0.0, "Growth of that bearing's radial clearance (half the play).", "m", live=True, minimum=0.0, maximum=1e-3
    )
    fault_race_bearing: str = quantity("b1", "Bearing with a defect of a race.", live=True, choices=names.BEARINGS)
    fault_race: str = quantity("outer", "Race of the defect: outer stands still.", live=True, choices=RACES)
    fault_race_depth: float = quantity(
        0.0, "Depth by which rollers sink into the defect.", "m", live=True, minimum=0.0, maximum=1e-3
    )
    fault_race_width: float = quantity(
        0.02, "Half the extent of the defect along the race.", "rad", live=True, minimum=1e-3, maximum=0.5
    )
    fault_race_angle: float = quantity(
        0.0, "Place of the defect, counted from the mean force on the housing.", "rad", live=True,
        minimum=-3.15, maximum=3.15,
    )  # fmt: skip
    fault_ramp: float = quantity(
        0.0, "Simulated time in which a severity goes from its old to its new value.", "s", live=True,
        minimum=0.0, maximum=1e6,
    )  # fmt: skip


SEVERITIES = {
    "crack": ("fault_crack",),
    "pitch": ("fault_pitch",),
    "eccentricity": ("fault_eccentricity",),
    "wear": ("fault_wear", "fault_wear_stiffness"),
    "clearance": ("fault_clearance",),
    "race": ("fault_race_depth",),
}
"""Kind of fault -> its severities; everything else says where it is."""
PLACES = {
    "crack": ("fault_crack_gear", "fault_crack_tooth"),
    "pitch": ("fault_pitch_gear", "fault_pitch_tooth"),
    "eccentricity": ("fault_eccentric_gear",),
    "wear": ("fault_wear_stage",),
    "clearance": ("fault_clearance_bearing",),
    "race": ("fault_race_bearing", "fault_race", "fault_race_width", "fault_race_angle"),
}
"""Kind of fault -> where it is; a change of the place begins with a severity of 0 there."""
