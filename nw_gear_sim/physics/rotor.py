"""The wind turbine's rotor: torque and speed from the wind (paper Eq 2), speed with a lag."""

from __future__ import annotations

import math
from typing import Protocol

from nw_gear_sim.physics.drive import Drive

STANDSTILL = 1e-3
"""Share of the rated speed below which a stopping rotor stands still."""


class RotorParameters(Protocol):
    """What the rotor needs to know of the turbine; SI units."""

    @property
    def rated_torque(self) -> float:
        """T_e, torque on the ring at rated wind speed, N m."""

    @property
    def rated_speed(self) -> float:
        """n_e, speed of the ring at rated wind speed, rad/s."""

    @property
    def rated_wind(self) -> float:
        """v_e, m/s."""

    @property
    def cut_in_wind(self) -> float:
        """v_ci, m/s."""

    @property
    def cut_out_wind(self) -> float:
        """v_co, m/s."""

    @property
    def time_constant(self) -> float:
        """Time in which the shaft speed follows the wind, s; 0 = at once."""


def operating_point(parameters: RotorParameters, wind_speed: float) -> tuple[float, float]:
    """Return the steady speed of the ring (rad/s) and the input torque (N m) at a wind speed (m/s).

    T = T_e (v/v_e)^2 and n = n_e v/v_e for v_ci <= v < v_e (paper Eq 2, whose v_vate is read as the rated speed v_e);
    rated values for v_e <= v < v_co; zero below cut-in and from cut-out on. There is no hysteresis: the turbine is
    on or off by the present wind alone, so that a wind about v_co switches it at every crossing.
    """
    if not parameters.cut_in_wind <= wind_speed < parameters.cut_out_wind:
        return 0.0, 0.0
    share = min(1.0, wind_speed / parameters.rated_wind)
    return parameters.rated_speed * share, parameters.rated_torque * share**2


class Rotor:
    """Speed and torque at the ring under a changing wind.

    The torque is that of Eq 2 at the present wind; the speed follows its steady value n through a first-order lag,
    d(speed)/dt = (n - speed)/tau, because a rotor of this size doesn't jump with a gust. A rotor whose steady speed is
    zero stands exactly still once it has fallen below 1e-3 of its rated speed. The lag stands for inertia and speed
    controller together; it isn't fed by the torque, and loads of the gearbox don't act back on it.

    Args:
        parameters: of the turbine.
        wind_speed: m/s at the start; the rotor starts in the steady state that belongs to it.
    """

    def __init__(self, parameters: RotorParameters, wind_speed: float) -> None:
        self._parameters = parameters
        self._speed, self._torque = operating_point(parameters, wind_speed)

    @property
    def speed(self) -> float:
        """Speed of the ring, rad/s."""
        return self._speed

    @property
    def torque(self) -> float:
        """Input torque, N m."""
        return self._torque

    def restore(self, speed: float, torque: float) -> None:
        """Take over a speed (rad/s) and a torque (N m) from before."""
        self._speed, self._torque = speed, torque

    def advance(self, wind_speed: float, duration: float) -> Drive:
        """Go on by `duration` (s) under a wind speed (m/s) and return speed and torque at both ends.

        The speed's lag is solved exactly for a wind that holds during the interval, whatever its length; the torque
        goes linearly from its old value to that of the wind.
        """
        target, torque = operating_point(self._parameters, wind_speed)
        tau = self._parameters.time_constant
        speed = target + (self._speed - target) * math.exp(-duration / tau) if tau > 0.0 else target
        if target == 0.0 and speed < STANDSTILL * self._parameters.rated_speed:
            speed = 0.0
        drive = Drive(self._speed, speed, self._torque, torque)
        self._speed, self._torque = speed, torque
        return drive


class Pitch:
    """A pitch that follows the wind above the rated one with a lag, so that gusts get through there.

    Set for a wind v_p, dv_p/dt = (max(v, v_e) - v_p) / lag; the torque is (max(v, v_e) / v_p)^2 times that of Eq 2,
    which takes v_p = max(v, v_e) for granted. Blades that don't turn meanwhile are taken to follow the square of the
    wind; nothing is said of stall.

    Args:
        rated_wind: v_e, m/s.
        lag: s; 0 = at once.
        wind: v at the start, for which it is set, m/s.

    Attributes:
        wind: v_p, m/s.
        gust: factor on the torque.
    """

    def __init__(self, rated_wind: float, lag: float, wind: float) -> None:
        self._rated, self._lag = rated_wind, lag
        self.wind, self.gust = max(wind, rated_wind), 1.0

    def follow(self, wind: float, duration: float) -> None:
        """Follow a wind (m/s) that holds for a time (s), exactly; `gust` is that at its end."""
        wind = max(wind, self._rated)
        self.wind = wind + (self.wind - wind) * (math.exp(-duration / self._lag) if self._lag > 0.0 else 0.0)
        self.gust = (wind / self.wind) ** 2
