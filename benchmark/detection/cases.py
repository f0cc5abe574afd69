"""Faults and operating conditions of the detection study."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

CONDITIONS = {"rated wind": 1.0, "half load": 0.5**0.5}
"""Mean wind over the rated one."""
SHAPE = 40.0
"""Of the Weibull distribution of the wind: 3 % standard deviation."""
LEARNING_SEEDS = (101, 102, 103)
HEALTHY_SEEDS = tuple(range(201, 211))
FAULT_SEED = 301
LEARNING_SECONDS = 220
SETTLING_SECONDS = 20
"""Before a fault is put in, or a healthy minute begins: the longest window is full by then."""
MINUTE = 60
FACTOR = 3.0
"""Between two severities that are tried."""


@dataclass(frozen=True)
class Fault:
    """One fault.

    Attributes:
        name: for the table; parameter: its severity.
        place: other parameters.
        largest: severity at which the search begins; it is divided by FACTOR `steps` times at most.
        unit: of the severity in the table; scale: of it over SI.
    """

    name: str
    parameter: str
    place: dict[str, Any]
    largest: float
    unit: str = "um"
    scale: float = 1e6
    steps: int = 3


FAULTS = (
    Fault("cracked tooth, ring", "fault_crack", {"fault_crack_gear": "ring"}, 0.8, "%", 100.0),
    Fault("cracked tooth, planet 1 of stage II", "fault_crack", {"fault_crack_gear": "p2_1"}, 0.8, "%", 100.0),
    Fault("cracked tooth, sun", "fault_crack", {"fault_crack_gear": "sun"}, 0.8, "%", 100.0),
    Fault("cracked tooth, pinion", "fault_crack", {"fault_crack_gear": "pinion"}, 0.8, "%", 100.0),
    Fault("wear, stage II: backlash", "fault_wear", {"fault_wear_stage": "II"}, 2e-4),
    Fault("wear, stage III: stiffness", "fault_wear_stiffness", {"fault_wear_stage": "III"}, 0.4, "%", 100.0),
    Fault("pitch error, sun", "fault_pitch", {"fault_pitch_gear": "sun"}, 8e-4),
    Fault("eccentricity, sun", "fault_eccentricity", {"fault_eccentric_gear": "sun"}, 8e-4),
    Fault("eccentricity, pinion", "fault_eccentricity", {"fault_eccentric_gear": "pinion"}, 8e-4),
    Fault("clearance, b1", "fault_clearance", {"fault_clearance_bearing": "b1"}, 2e-4),
    Fault("outer race, b1", "fault_race_depth", {"fault_race_bearing": "b1"}, 4e-5),
    Fault("inner race, b21", "fault_race_depth", {"fault_race_bearing": "b21", "fault_race": "inner"}, 4e-5),
)
