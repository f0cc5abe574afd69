"""What drives the gearbox over one interval: speed and torque at the ring's shaft."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Drive:
    """Speed and torque of the input shaft at both ends of an interval, linear in between.

    Attributes:
        speed_start, speed_end: angular speed of the ring, rad/s.
        torque_start, torque_end: input torque, N m.
    """

    speed_start: float
    speed_end: float
    torque_start: float
    torque_end: float
