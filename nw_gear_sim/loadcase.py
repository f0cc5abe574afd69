"""Load cases as a source of the drive: the drive-train in the wind, or in the steady wind of an operating point."""

from __future__ import annotations

import math
from collections.abc import Mapping

from nw_gear_common.errors import InputError
from nw_gear_sim.drives import DRIVE, WIND, Inputs, Plain, State
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.drivetrain import DriveTrain
from nw_gear_sim.physics.rotor import operating_point

NOTABLE = 0.01
"""Share by which a load case may begin beside the configured operating point before people are told."""


class LoadCase(Plain):
    """A load case of the drive-train, in the wind or in the steady wind of the fixed operating point.

    Args:
        configuration: turbine, drive-train and operating point.
        scenario: of `drivetrain.SCENARIOS`.
        event_time: when it happens, s.
        windy: whether the wind comes from outside.

    Raises:
        InputError: the turbine stands still in the wind of the fixed operating point.
    """

    def __init__(self, configuration: Configuration, scenario: str, event_time: float, *, windy: bool) -> None:
        super().__init__()
        self.needs = (WIND,) if windy else ()
        self.description = f"load case {scenario}"
        self._configuration, self._scenario, self._event_time = configuration, scenario, event_time
        self._wind = configuration.turbine.rated_wind * math.sqrt(min(1.0, configuration.operation.load))
        self.identity = {DRIVE: f"{'wind' if windy else 'fixed'}, {scenario}", "scenario_time": f"{event_time!r} s"}
        if not windy:
            self.remarks = _beside(configuration, self._wind)
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

    def phase(self) -> str:
        """Return the phase of the drive-train."""
        return self._train.phase

    def state(self) -> State:
        """Return the state of the drive-train."""
        return {**super().state(), **{f"train.{name}": value for name, value in self._train.state().items()}}

    def restore(self, state: Mapping[str, float | str]) -> None:
        """Take over what `state` returned."""
        super().restore(state)
        train = {name.removeprefix("train."): value for name, value in state.items() if name.startswith("train.")}
        self._train.restore(train)


def _beside(configuration: Configuration, wind: float) -> tuple[str, ...]:
    """Say where a load case begins, unless that is the fixed operating point (whose speed and torque are free)."""
    turbine, fixed = configuration.turbine, derive(configuration)
    speed, torque = operating_point(turbine, wind)
    if speed == 0.0:
        least = (turbine.cut_in_wind / turbine.rated_wind) ** 2
        expected = f"at least {least:.3g} for a load case, a wind above cut-in"
        raise InputError("operation.load", expected, f"{configuration.operation.load:g}")
    if abs(speed - fixed.ring_speed) < NOTABLE * speed and abs(torque - fixed.input_torque) < NOTABLE * torque:
        return ()
    here, there = (
        f"{w * 30.0 / math.pi:.2f} r/min and {t / 1e6:.3f} MN m"
        for w, t in ((speed, torque), (fixed.ring_speed, fixed.input_torque))
    )
    return (f"a load case follows the turbine (paper Eq 2): {here} instead of the configured {there}",)
