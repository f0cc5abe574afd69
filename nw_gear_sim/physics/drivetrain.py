"""Load cases: rotor, low-speed shaft and generator as two inertias on a spring, through start, stops and loss of grid.

    J_1 dw_1/dt = T_a - T_s,   J_2 dw_2/dt = T_s - T_g - T_b,   T_s = k x + c (w_1 - w_2),   dx/dt = w_1 - w_2

with J_1 of the rotor, J_2 of the generator referred to the ring's shaft and c = 2 zeta sqrt(k J_1 J_2 / (J_1 + J_2)).
The gearbox sits between shaft and generator: it turns with w_2 and carries T_s, which falls below zero where the shaft
springs back.

Wind: T_a = p u T min(1, (s - w_1/n) / (s - 1)) - (1 - p) d T_e (w_1/n_e)^2, not below -u T in its first part, with n
and T of paper Eq 2, the pitch's share p and the factor u of gusts (`Pitch`); a rotor without load settles at s n.
Generator: T_g = g T_e min(1, w_2/n_e)^2, which is Eq 2 without the wind. Brake, on the generator's side:
T_b = b min(T_max, (J_1 + J_2) w_2 / tau).

Validity: the gearbox is taken as stiff and without inertia. Seen from the ring, its gears have 1.77e5 kg m^2 (ring 10,
planets 43, sun and herringbone 121, output 3 thousand), 3.8 % of J_2 and 0.4 % of J_1; the largest acceleration,
0.91 rad/s^2 after a loss of the grid at rated torque, asks 0.16 MN m of them, 3.8 % of the rated torque. Tower, blades
and the generator's controller (active damping) are left out, and the gearbox doesn't act back on the drive-train.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from nw_gear_common.errors import InputError
from nw_gear_sim.params import Drivetrain
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.rotor import STANDSTILL, Pitch, RotorParameters, operating_point

SCENARIOS = ("start_up", "shutdown", "emergency_stop", "grid_loss")
LONGEST_STEP = 2e-3
STEP_ANGLE = 0.03
"""Largest angle of the torsional oscillation in a step, rad: the error of RK4 is then 2e-10 of it a step."""
SLACK = 0.01
"""Share of the rated torque below which the shaft of a rotor that stands still counts as unwound."""

_STATE = ("twist", "rotor_speed", "ring_speed", "wind_work", "generator_work", "brake_work", "shaft_work")
_SHARES = ("pitch", "generator", "brake")

State = tuple[float, ...]
"""Values in the order of _STATE: rad, rad/s, rad/s, and work done since the start in J."""


class Ramp(NamedTuple):
    """A share that goes linearly from `first` at `begin` (s) to `last` at `end` (s)."""

    begin: float
    end: float
    first: float
    last: float

    def at(self, time: float) -> float:
        """Return the share at a time (s)."""
        if time >= self.end:
            return self.last
        return self.first + (self.last - self.first) * max(0.0, time - self.begin) / (self.end - self.begin)


class DriveTrain:
    """A turbine's drive-train through one load case.

    `start_up`: the pitch lets the wind accelerate the rotor; at its steady speed the generator is connected and its
    torque ramps up. `shutdown`: wind and generator are ramped down together; the feathered blades slow the rotor down,
    and at a low speed the brake stops it. `emergency_stop`: generator off, pitch and brake at once. `grid_loss`: the
    generator's torque vanishes within milliseconds, the shaft springs back, and after a delay the pitch ends it as in
    a shutdown.

    Args:
        turbine: rated point and range of the wind.
        parameters: of the drive-train.
        scenario: one of SCENARIOS.
        event_time: seconds from the start to the event.
        wind: m/s at the start; the start is in steady operation at it, or at standstill for `start_up`.

    Raises:
        InputError: unknown scenario, or an event before the start.
    """

    def __init__(
        self, turbine: RotorParameters, parameters: Drivetrain, scenario: str, event_time: float, wind: float
    ) -> None:
        if scenario not in SCENARIOS:
            raise InputError("scenario", "one of " + ", ".join(SCENARIOS), repr(scenario))
        if not (math.isfinite(event_time) and event_time >= 0.0):
            raise InputError("event_time", "a number of seconds >= 0", f"{event_time:g}")
        self._turbine, self._parameters = turbine, parameters
        self._scenario, self._event_time = scenario, event_time
        rotor, generator = parameters.rotor_inertia, parameters.generator_inertia
        reduced = rotor * generator / (rotor + generator)
        self._damping = 2.0 * parameters.shaft_damping_ratio * math.sqrt(parameters.shaft_stiffness * reduced)
        self._brake_rate = (rotor + generator) / parameters.brake_time
        self._step = min(LONGEST_STEP, STEP_ANGLE * math.sqrt(reduced / parameters.shaft_stiffness))
        self.time = 0.0
        self._events: dict[str, float] = {}
        self._steady = operating_point(turbine, wind)
        self._pitch = Pitch(turbine.rated_wind, parameters.pitch_lag, wind)
        if scenario == "start_up":
            self.phase, share, at_first = "standstill", 0.0, (0.0, 0.0)
        else:
            self.phase, share, at_first = "running", 1.0, self._steady
        self._shares = {name: Ramp(0.0, 0.0, share, share) for name in ("pitch", "generator")}
        self._shares["brake"] = Ramp(0.0, 0.0, 1.0 - share, 1.0 - share)
        speed, torque = at_first
        self._state: State = (torque / parameters.shaft_stiffness, speed, speed, 0.0, 0.0, 0.0, 0.0)

    @property
    def drive(self) -> Drive:
        """Speed (rad/s) and torque (N m) of the ring now, the same at both ends."""
        speed, torque = self._ring()
        return Drive(speed, speed, torque, torque)

    def advance(self, wind: float, duration: float) -> Drive:
        """Go on by `duration` (s) under a wind speed (m/s) and return speed and torque of the ring at both ends.

        Classical Runge-Kutta steps of at most 2 ms end where a ramp begins or ends. What depends on the speed
        (connecting the generator, the brake, standstill) happens at the end of a step.
        """
        before = self._ring()
        self._steady = operating_point(self._turbine, wind)
        self._pitch.follow(wind, duration)
        end = self.time + duration
        self._decide()
        while self.time < end:
            until = min([end, *(time for time in self._corners() if time > self.time)])
            steps = 1 if self.phase == "standstill" else max(1, math.ceil((until - self.time) / self._step - 1e-9))
            length = (until - self.time) / steps
            if self.phase != "standstill":
                self._go(length)
            self.time = until if steps == 1 else self.time + length
            self._decide()
        after = self._ring()
        return Drive(before[0], after[0], before[1], after[1])

    def events(self) -> dict[str, float]:
        """Return what has happened so far, with its time (s since the start), in that order."""
        return dict(self._events)

    def energies(self) -> dict[str, float]:
        """Return the energy stored now and the work since the start, J: stored changes by wind less all others.

        Keys: stored (motion and twist), wind, generator, brake, shaft (its damping).
        """
        parameters = self._parameters
        twist, rotor, ring, *work = self._state
        stored = parameters.rotor_inertia * rotor**2 + parameters.generator_inertia * ring**2
        stored += parameters.shaft_stiffness * twist**2
        return {"stored": 0.5 * stored, **dict(zip(("wind", "generator", "brake", "shaft"), work, strict=True))}

    def state(self) -> dict[str, float | str]:
        """Return all that the future depends on besides the arguments and the wind to come."""
        now = {"scenario": self._scenario, "phase": self.phase, "time": self.time, "pitched_wind": self._pitch.wind}
        shares = {f"{name}.{key}": value for name in _SHARES for key, value in self._shares[name]._asdict().items()}
        events = {f"event.{name}": time for name, time in self._events.items()}
        return {**now, **dict(zip(_STATE, self._state, strict=True)), **shares, **events}

    def restore(self, state: Mapping[str, float | str]) -> None:
        """Go on from what `state` returned, bit for bit.

        Raises:
            InputError: it is of another scenario, or incomplete.
        """
        if state.get("scenario") != self._scenario:
            raise InputError("drive-train: scenario", self._scenario, str(state.get("scenario", "nothing")))
        wanted = [
            *_STATE,
            "time",
            "pitched_wind",
            "phase",
            *(f"{name}.{key}" for name in _SHARES for key in Ramp._fields),
        ]
        for name in wanted:
            if name not in state:
                raise InputError(f"drive-train: {name}", "a value", "nothing")
        self._state = tuple(float(state[name]) for name in _STATE)
        self.time, self.phase = float(state["time"]), str(state["phase"])
        self._pitch.wind = float(state["pitched_wind"])
        for name in _SHARES:
            self._shares[name] = Ramp(*(float(state[f"{name}.{key}"]) for key in Ramp._fields))
        events = {name.removeprefix("event."): value for name, value in state.items() if name.startswith("event.")}
        self._events = {name: float(value) for name, value in events.items()}

    def _ring(self) -> tuple[float, float]:
        twist, rotor, ring = self._state[:3]
        return ring, self._parameters.shaft_stiffness * twist + self._damping * (rotor - ring)

    def _corners(self) -> list[float]:
        return [self._event_time, *(time for ramp in self._shares.values() for time in ramp[:2])]

    def _ramp(self, name: str, last: float, duration: float, delay: float = 0.0) -> None:
        begin = self.time + delay
        self._shares[name] = Ramp(begin, begin + duration, self._shares[name].at(self.time), last)

    def _happened(self, name: str) -> bool:
        """Note an event at its first time, and return whether this was it."""
        if name in self._events:
            return False
        self._events[name] = self.time
        return True

    # --- what is done when ---

    def _decide(self) -> None:
        if self.time >= self._event_time and self._happened("event"):
            self._begin()
        if self.phase == "starting":
            steady, ring = self._steady[0], self._state[2]
            if 0.0 < steady <= ring and self._happened("generator_on"):
                self.phase = "connecting"
                self._ramp("generator", 1.0, self._parameters.connect_time)
        elif self.phase == "connecting" and self.time >= self._shares["generator"].end:
            self.phase = "running"
            self._happened("running")
        elif self.phase == "stopping":
            self._stop()

    def _begin(self) -> None:
        parameters = self._parameters
        if self._scenario == "start_up":
            self.phase = "starting"
            self._ramp("brake", 0.0, 0.0)
            self._ramp("pitch", 1.0, parameters.start_time)
            return
        self.phase = "stopping"
        if self._scenario == "shutdown":
            self._ramp("pitch", 0.0, parameters.shutdown_time)
            self._ramp("generator", 0.0, parameters.shutdown_time)
            return
        self._ramp("generator", 0.0, parameters.trip_time)
        self._ramp("pitch", 0.0, parameters.pitch_time, parameters.pitch_delay * (self._scenario == "grid_loss"))
        if self._scenario == "emergency_stop":
            self._happened("brake")
            self._ramp("brake", 1.0, parameters.brake_rise_time)

    def _stop(self) -> None:
        parameters, turbine = self._parameters, self._turbine
        if self.time >= self._shares["generator"].end:
            self._happened("generator_off")
        if self.time < self._shares["pitch"].end:
            return
        self._happened("feathered")
        rotor, ring = self._state[1:3]
        if ring <= parameters.brake_speed * turbine.rated_speed and self._happened("brake"):
            self._ramp("brake", 1.0, parameters.brake_rise_time)
        still = max(abs(rotor), ring) < STANDSTILL * turbine.rated_speed
        unwound = abs(self._ring()[1]) < SLACK * turbine.rated_torque
        if still and unwound and "brake" in self._events and "generator_off" in self._events:
            self._happened("standstill")
            self.phase = "standstill"
            wind, generator, brake, shaft = self._state[3:]
            self._state = (0.0, 0.0, 0.0, wind, generator, brake + self.energies()["stored"], shaft)

    # --- motion ---

    def _go(self, h: float) -> None:
        time, y = self.time, self._state
        a = self._rates(time, y)
        b = self._rates(time + 0.5 * h, tuple(v + 0.5 * h * r for v, r in zip(y, a, strict=True)))
        c = self._rates(time + 0.5 * h, tuple(v + 0.5 * h * r for v, r in zip(y, b, strict=True)))
        d = self._rates(time + h, tuple(v + h * r for v, r in zip(y, c, strict=True)))
        y = tuple(v + h / 6.0 * (k + 2.0 * (p + q) + r) for v, k, p, q, r in zip(y, a, b, c, d, strict=True))
        twist, rotor, ring, wind, generator, brake, shaft = y
        if ring < 0.0:  # a backstop
            brake += 0.5 * self._parameters.generator_inertia * ring**2
            ring = 0.0
        self._state = (twist, rotor, ring, wind, generator, brake, shaft)

    def _rates(self, time: float, y: State) -> State:
        parameters, turbine = self._parameters, self._turbine
        twist, rotor, ring = y[:3]
        share = turbine.rated_torque * min(1.0, max(0.0, ring) / turbine.rated_speed) ** 2
        generator = self._shares["generator"].at(time) * share
        most = parameters.brake_torque
        brake = self._shares["brake"].at(time) * max(-most, min(most, self._brake_rate * ring))
        wind = self._wind(self._shares["pitch"].at(time), rotor)
        slip = rotor - ring
        damper = self._damping * slip
        shaft = parameters.shaft_stiffness * twist + damper
        return (
            slip,
            (wind - shaft) / parameters.rotor_inertia,
            (shaft - generator - brake) / parameters.generator_inertia,
            wind * rotor,
            generator * ring,
            brake * ring,
            damper * slip,
        )

    def _wind(self, pitch: float, rotor: float) -> float:
        """Torque of the wind (N m) at a share of the pitch and a speed of the rotor (rad/s)."""
        parameters, turbine = self._parameters, self._turbine
        speed, torque = self._steady
        drag = parameters.feathered_drag * turbine.rated_torque * rotor * abs(rotor) / turbine.rated_speed**2
        if torque == 0.0:
            return -(1.0 - pitch) * drag
        ratio = parameters.runaway_ratio
        torque *= self._pitch.gust
        return pitch * torque * max(-1.0, min(1.0, (ratio - rotor / speed) / (ratio - 1.0))) - (1.0 - pitch) * drag
