"""What drives the gearbox: the wind, a fixed operating point, a series from a file, somebody else's topic, a load case.

A source is asked for the drive of one interval after the other. What it needs from outside (the wind, or speed and
torque) comes in as numbers at the end of the interval; no clock, no ROS.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Protocol

from nw_gear_common.errors import InputError
from nw_gear_sim.drivefile import DriveSeries
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.drivetrain import DriveTrain
from nw_gear_sim.physics.rotor import Rotor

WIND, SPEED, TORQUE = "wind", "speed", "torque"
"""Inputs from outside: wind speed (m/s), speed (rad/s) and torque (N m) of the ring."""

Inputs = Mapping[str, float]
State = dict[str, float | str]


class Source(Protocol):
    """What drives the gearbox.

    Attributes:
        needs: the inputs that have to be known; description: in words; remarks: what people should know about it.
        drive: of the last interval.
    """

    needs: tuple[str, ...]
    description: str
    remarks: tuple[str, ...]
    drive: Drive

    def begin(self, inputs: Inputs) -> Drive:
        """Start at time 0 and return the drive there, the same at both ends."""

    def advance(self, inputs: Inputs, duration: float) -> Drive:
        """Go on by `duration` s, at whose end the inputs are as given."""

    def over(self) -> bool:
        """Whether the source has come to its end."""

    def events(self) -> dict[str, float]:
        """Return what has happened, with its time (s)."""

    def state(self) -> State:
        """Return all that the future depends on."""

    def restore(self, state: Mapping[str, float | str]) -> None:
        """Take over what `state` returned, in the place of `begin`."""


class _Plain:
    """What most sources have in common."""

    needs: tuple[str, ...] = ()
    description = ""
    remarks: tuple[str, ...] = ()

    def __init__(self) -> None:
        self.drive = Drive(0.0, 0.0, 0.0, 0.0)

    def over(self) -> bool:
        """Never."""
        return False

    def events(self) -> dict[str, float]:
        """Nothing happens."""
        return {}

    def state(self) -> State:
        """Return speed and torque."""
        return {SPEED: self.drive.speed_end, TORQUE: self.drive.torque_end}

    def restore(self, state: Mapping[str, float | str]) -> None:
        """Take over speed and torque."""
        self.drive = _steady(float(state[SPEED]), float(state[TORQUE]))


class FixedPoint(_Plain):
    """The operating point of the configuration."""

    description = "at a fixed operating point"

    def __init__(self, configuration: Configuration) -> None:
        super().__init__()
        fixed = derive(configuration)
        self._drive = _steady(fixed.ring_speed, fixed.input_torque)

    def begin(self, inputs: Inputs) -> Drive:
        """Return the operating point."""
        self.drive = self._drive
        return self.drive

    def advance(self, inputs: Inputs, duration: float) -> Drive:
        """Return the operating point."""
        return self.drive


class WindDriven(_Plain):
    """The rotor in the wind."""

    needs: tuple[str, ...] = (WIND,)
    description = "driven by the wind"

    def __init__(self, configuration: Configuration) -> None:
        super().__init__()
        self._turbine = configuration.turbine
        self._rotor = Rotor(self._turbine, 0.0)

    def begin(self, inputs: Inputs) -> Drive:
        """Start in the steady state of the wind."""
        self._rotor = Rotor(self._turbine, inputs[WIND])
        self.drive = _steady(self._rotor.speed, self._rotor.torque)
        return self.drive

    def advance(self, inputs: Inputs, duration: float) -> Drive:
        """Follow the wind."""
        self.drive = self._rotor.advance(inputs[WIND], duration)
        return self.drive

    def restore(self, state: Mapping[str, float | str]) -> None:
        """Take over speed and torque."""
        super().restore(state)
        self._rotor.restore(self.drive.speed_end, self.drive.torque_end)


class Followed(_Plain):
    """Speed and torque as somebody else says."""

    needs: tuple[str, ...] = (SPEED, TORQUE)
    description = "driven by a topic"

    def begin(self, inputs: Inputs) -> Drive:
        """Start at the speed and torque given."""
        self.drive = _steady(inputs[SPEED], inputs[TORQUE])
        return self.drive

    def advance(self, inputs: Inputs, duration: float) -> Drive:
        """Go linearly to the speed and torque given."""
        self.drive = Drive(self.drive.speed_end, inputs[SPEED], self.drive.torque_end, inputs[TORQUE])
        return self.drive


class Recorded(_Plain):
    """Speed and torque from a file.

    Args:
        series: of the file.
        hold: go on with the last values after its end.
    """

    def __init__(self, series: DriveSeries, *, hold: bool) -> None:
        super().__init__()
        self.description = f"driven by {series.source}"
        self.remarks = tuple(f"bridged a gap of {gap.seconds:g} s from {gap.label}" for gap in series.gaps)
        self._series, self._hold = series, hold
        self._time = 0.0

    def begin(self, inputs: Inputs) -> Drive:
        """Start at the beginning of the file."""
        self._time = 0.0
        self.drive = _steady(*self._series.at(0.0))
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


class LoadCase(_Plain):
    """A load case of the drive-train, in the wind or in the steady wind of the fixed operating point.

    Args:
        configuration: turbine, drive-train and operating point.
        scenario: of `drivetrain.SCENARIOS`.
        event_time: when it happens, s.
        windy: whether the wind comes from outside.
    """

    def __init__(self, configuration: Configuration, scenario: str, event_time: float, *, windy: bool) -> None:
        super().__init__()
        self.needs = (WIND,) if windy else ()
        self.description = f"load case {scenario}"
        self._configuration, self._scenario, self._event_time = configuration, scenario, event_time
        self._wind = configuration.turbine.rated_wind * math.sqrt(min(1.0, configuration.operation.load))
        self._train = self._make(self._wind)

    def _make(self, wind: float) -> DriveTrain:
        configuration = self._configuration
        return DriveTrain(configuration.turbine, configuration.drivetrain, self._scenario, self._event_time, wind)

    def begin(self, inputs: Inputs) -> Drive:
        """Start in steady operation, or at standstill where the load case is a start."""
        self._train = self._make(inputs.get(WIND, self._wind))
        self.drive = self._train.drive
        return self.drive

    def advance(self, inputs: Inputs, duration: float) -> Drive:
        """Go on with the load case."""
        self.drive = self._train.advance(inputs.get(WIND, self._wind), duration)
        return self.drive

    def events(self) -> dict[str, float]:
        """Return what has happened so far."""
        return self._train.events()

    def state(self) -> State:
        """Return the state of the drive-train."""
        train = {f"train.{name}": value for name, value in self._train.state().items()}
        return {**super().state(), "event_time": self._event_time, **train}

    def restore(self, state: Mapping[str, float | str]) -> None:
        """Take over what `state` returned.

        Raises:
            InputError: another load case, or another time of it.
        """
        super().restore(state)
        if state.get("event_time", self._event_time) != self._event_time:
            raise InputError("checkpoint: event_time", f"{self._event_time:g} s", f"{state['event_time']} s")
        train = {name.removeprefix("train."): value for name, value in state.items() if name.startswith("train.")}
        self._train.restore(train)


def _steady(speed: float, torque: float) -> Drive:
    return Drive(speed, speed, torque, torque)
