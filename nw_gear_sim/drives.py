"""What drives the gearbox: the wind, a fixed operating point, a series from a file, somebody else's topic.

A source is asked for the drive of one interval after the other. What it needs from outside (the wind, or speed and
torque) comes in as numbers at the end of the interval; no clock, no ROS.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from typing import Protocol

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_sim.drivefile import DriveSeries
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.rotor import Rotor

WIND, SPEED, TORQUE = "wind", "speed", "torque"
"""Inputs from outside: wind speed (m/s), speed (rad/s) and torque (N m) of the ring."""

DRIVE = "drive"
Inputs = Mapping[str, float]
State = dict[str, float | str]


class Source(Protocol):
    """What drives the gearbox.

    Attributes:
        needs: the inputs that have to be known; description: in words; remarks: what people should know about it.
        longest: longest interval (s) over which it may be taken for linear; inputs are known at the ends of ticks only.
        drive: of the last interval.
    """

    needs: tuple[str, ...]
    description: str
    remarks: tuple[str, ...]
    longest: float
    drive: Drive

    def begin(self, inputs: Inputs) -> Drive:
        """Start at time 0 and return the drive there, the same at both ends."""

    def advance(self, inputs: Inputs, duration: float) -> Drive:
        """Go on by `duration` s, at whose end the inputs are as given."""

    def over(self) -> bool:
        """Whether the source has come to its end."""

    def phase(self) -> str:
        """Return what it is at, in a word; "" where there is nothing to tell."""

    def events(self) -> dict[str, float]:
        """Return what has happened, with its time (s)."""

    def state(self) -> State:
        """Return all that the future depends on."""

    def restore(self, state: Mapping[str, float | str]) -> None:
        """Take over what `state` returned, in the place of `begin`.

        Raises:
            InputError: it is of something else.
        """


class Plain:
    """What most sources have in common. `identity`: what a checkpoint has to share, by its name."""

    kind = ""
    needs: tuple[str, ...] = ()
    description = ""
    remarks: tuple[str, ...] = ()
    longest = math.inf

    def __init__(self) -> None:
        self.identity: dict[str, str] = {DRIVE: self.kind}
        self.drive = Drive(0.0, 0.0, 0.0, 0.0)

    def over(self) -> bool:
        """Never."""
        return False

    def phase(self) -> str:
        """Nothing to tell."""
        return ""

    def events(self) -> dict[str, float]:
        """Nothing happens."""
        return {}

    def state(self) -> State:
        """Return speed and torque, and what they come from."""
        return {**self.identity, SPEED: self.drive.speed_end, TORQUE: self.drive.torque_end}

    def restore(self, state: Mapping[str, float | str]) -> None:
        """Take over speed and torque."""
        for name, here in self.identity.items():
            if state.get(name) != here:
                raise InputError(f"checkpoint: {name}", here, str(state.get(name, "nothing")))
        self.drive = steady(float(state[SPEED]), float(state[TORQUE]))


class FixedPoint(Plain):
    """The operating point of the configuration."""

    description = "at a fixed operating point"
    kind = "fixed"

    def __init__(self, configuration: Configuration) -> None:
        super().__init__()
        fixed = derive(configuration)
        self._drive = steady(fixed.ring_speed, fixed.input_torque)

    def begin(self, inputs: Inputs) -> Drive:
        """Return the operating point."""
        self.drive = self._drive
        return self.drive

    def advance(self, inputs: Inputs, duration: float) -> Drive:
        """Return the operating point."""
        return self.drive


class WindDriven(Plain):
    """The rotor in the wind."""

    needs: tuple[str, ...] = (WIND,)
    description = "driven by the wind"
    kind = "wind"

    def __init__(self, configuration: Configuration) -> None:
        super().__init__()
        self._turbine = configuration.turbine
        self._rotor = Rotor(self._turbine, 0.0)

    def begin(self, inputs: Inputs) -> Drive:
        """Start in the steady state of the wind."""
        self._rotor = Rotor(self._turbine, inputs[WIND])
        self.drive = steady(self._rotor.speed, self._rotor.torque)
        return self.drive

    def advance(self, inputs: Inputs, duration: float) -> Drive:
        """Follow the wind."""
        self.drive = self._rotor.advance(inputs[WIND], duration)
        return self.drive

    def restore(self, state: Mapping[str, float | str]) -> None:
        """Take over speed and torque."""
        super().restore(state)
        self._rotor.restore(self.drive.speed_end, self.drive.torque_end)


class Followed(Plain):
    """Speed and torque as somebody else says."""

    needs: tuple[str, ...] = (SPEED, TORQUE)
    description = "driven by a topic"
    kind = "topic"

    def begin(self, inputs: Inputs) -> Drive:
        """Start at the speed and torque given."""
        self.drive = steady(inputs[SPEED], inputs[TORQUE])
        return self.drive

    def advance(self, inputs: Inputs, duration: float) -> Drive:
        """Go linearly to the speed and torque given."""
        self.drive = Drive(self.drive.speed_end, inputs[SPEED], self.drive.torque_end, inputs[TORQUE])
        return self.drive


class Recorded(Plain):
    """Speed and torque from a file.

    Args:
        series: of the file.
        hold: go on with the last values after its end.
    """

    kind = "file"

    def __init__(self, series: DriveSeries, *, hold: bool) -> None:
        super().__init__()
        self.description = f"driven by {series.source}"
        self.remarks = tuple(f"bridged a gap of {gap.seconds:g} s from {gap.label}" for gap in series.gaps)
        self.longest = float(np.median(np.diff(series.times)))
        values = b"".join(array.tobytes() for array in (series.times, series.speed, series.torque))
        self.identity["drive_file (SHA-256)"] = hashlib.sha256(values).hexdigest()
        self._series, self._hold = series, hold
        self._time = 0.0

    def begin(self, inputs: Inputs) -> Drive:
        """Start at the beginning of the file."""
        self._time = 0.0
        self.drive = steady(*self._series.at(0.0))
        return self.drive

    def advance(self, inputs: Inputs, duration: float) -> Drive:
        """Follow the file."""
        self._time += duration
        speed, torque = self._series.at(self._time)
        self.drive = Drive(self.drive.speed_end, speed, self.drive.torque_end, torque)
        return self.drive

    def over(self) -> bool:
        """Whether the file has come to its end."""
        return not self._hold and self._time >= self._series.duration - 1e-9

    def state(self) -> State:
        """Return speed, torque and the time in the file."""
        return {**super().state(), "time": self._time}

    def restore(self, state: Mapping[str, float | str]) -> None:
        """Take over what `state` returned."""
        super().restore(state)
        self._time = float(state["time"])


def steady(speed: float, torque: float) -> Drive:
    """Return a drive of constant speed (rad/s) and torque (N m)."""
    return Drive(speed, speed, torque, torque)
