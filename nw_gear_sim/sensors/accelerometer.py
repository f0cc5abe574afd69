"""Accelerometers on the bearings' housings: path, sensor, anti-aliasing filter, converter."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.signal import firwin, kaiser_beta

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.params import Housing
from nw_gear_sim.sensors import kernels
from nw_gear_sim.sensors.path import make_path

PASS, STOP = 0.4, 0.6
"""Edges of the anti-aliasing filter, in units of the sample rate: what is above STOP would fold to below PASS."""
ATTENUATION = 80.0
"""Of the filter beyond STOP, and its largest error below PASS, dB."""
HALF_LENGTH = math.ceil((ATTENUATION - 7.95) / (2.285 * 2 * math.pi * (STOP - PASS)) / 2)
"""Of the filter, in samples that come out (Kaiser's formula); the delay that it causes is taken out of the times."""


@dataclass(frozen=True)
class Sensor:
    """An accelerometer with its amplifier and converter.

    Attributes:
        rate: of the samples that come out, Hz.
        range: largest acceleration of the sensor, m/s^2.
        noise: density of its white noise (one-sided), m/s^2/sqrt(Hz).
        sensitivity: V per m/s^2; voltage: largest that the converter takes, V.
        bits: of the converter, over +-voltage; 0 = no rounding.
    """

    rate: float
    range: float
    noise: float
    sensitivity: float
    voltage: float
    bits: int

    @property
    def limit(self) -> float:
        """Acceleration at which sensor or converter is at its end, m/s^2."""
        return min(self.range, self.voltage / self.sensitivity)

    @property
    def resolution(self) -> float:
        """One step of the converter, m/s^2; 0 = none."""
        return 2.0 * self.voltage / self.sensitivity / 2**self.bits if self.bits else 0.0


class Accelerometers:
    """Turns forces on housings into what sensors show of their accelerations.

    Forces come at a fixed rate. Sensors that are faster take them as straight lines between samples, slower ones filter
    before they leave samples out. Noise is drawn before the filter. Sample k stands at the time k / rate after the
    first force, and is known `delay` later.

    Args:
        housings: one for each channel.
        sensor: all are alike.
        force_rate: of the forces, Hz.
        seed: of the noise.

    Raises:
        InputError: neither rate is a multiple of the other.
    """

    def __init__(self, housings: Sequence[Housing], sensor: Sensor, force_rate: float, seed: int) -> None:
        self._parts, self._every = _ratios(sensor.rate, force_rate)
        self._sensor, self._seed = sensor, seed
        path_rate = force_rate * self._parts
        self._path = make_path(housings, 1.0 / path_rate)
        self._half = HALF_LENGTH * self._every if self._every > 1 else 0
        self._taps = _taps(self._half, self._every)
        self._deviation = sensor.noise * math.sqrt(0.5 * path_rate)
        self.delay = self._half / path_rate
        self.channels = len(housings)
        self.forget()

    def forget(self) -> None:
        """Be as at the beginning: housings at rest under the first force that will come."""
        self._noise = np.random.Generator(np.random.PCG64(self._seed))
        self._force = np.empty(0)
        self._motion = np.zeros((self.channels, 2))
        self._waiting = np.empty((0, self.channels))
        self._given = 0
        self.clipped = np.zeros(self.channels)

    def compile(self) -> None:
        """Compile the kernels, or load them from the cache."""
        kernels.compile_kernels(self._path)

    def advance(self, force: Array) -> tuple[int, Array]:
        """Take forces and return the samples that are complete.

        Args:
            force: (samples, channels), N, following those before.

        Returns:
            number of the first sample, and the samples (n, channels) in m/s^2; n may be 0.
        """
        fresh = [self._waiting]
        if not self._force.size:
            fresh.append(self._sensed(np.zeros((self._half, self.channels))))
            self._force = force[0].copy()
            self._motion[:, 0] = self._path.compliance * self._force
            fresh.append(self._sensed(np.zeros((1, self.channels))))
            force = force[1:]
        shaken = np.empty((len(force) * self._parts, self.channels))
        kernels.shake(self._path, np.ascontiguousarray(force), self._force, self._motion, self._parts, shaken)
        values = np.concatenate([*fresh, self._sensed(shaken)])
        windows = max(0, (len(values) - len(self._taps)) // self._every + 1)
        out = np.empty((windows, self.channels))
        kernels.thin(values, self._taps, self._every, out)
        self._waiting = values[windows * self._every :].copy()
        first = self._given
        self._given += windows
        return first, self._converted(out)

    def state(self) -> dict[str, Any]:
        """Return all that the future depends on: arrays, plain numbers and a dictionary of them."""
        return {
            "force": self._force.copy(),
            "motion": self._motion.copy(),
            "waiting": self._waiting.copy(),
            "clipped": self.clipped.copy(),
            "given": self._given,
            "rate": self._sensor.rate,
            "noise": self._noise.bit_generator.state,
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Take over what `state` returned.

        Raises:
            InputError: it is of other sensors, or incomplete.
        """
        place = "checkpoint: sensors.acceleration"
        if state.get("rate") != self._sensor.rate:
            raise InputError(f"{place}.rate", f"{self._sensor.rate:g} Hz", f"{state.get('rate', 'nothing')}")
        try:
            arrays = {
                name: np.array(state[name], dtype=np.float64) for name in ("force", "motion", "waiting", "clipped")
            }
            given, noise = int(state["given"]), dict(state["noise"])
            fits = arrays["motion"].shape == self._motion.shape and arrays["clipped"].shape == (self.channels,)
            fits &= arrays["force"].size in (0, self.channels) and arrays["waiting"].shape[1:] == (self.channels,)
            if not fits or arrays["waiting"].shape[0] >= len(self._taps) + self._every:
                raise InputError(place, f"that of {self.channels} channels at this rate", "another")
            self._noise.bit_generator.state = noise
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(place, "the state of all accelerometers", f"one without a usable {error}") from error
        self._force, self._motion = arrays["force"], arrays["motion"]
        self._waiting, self.clipped, self._given = arrays["waiting"], arrays["clipped"], given

    def _sensed(self, acceleration: Array) -> Array:
        """What the sensors make of accelerations (n, channels): noise on top, and no more than they can show."""
        if self._deviation:
            acceleration += self._deviation * self._noise.standard_normal(acceleration.shape)
        kernels.limit(acceleration, self._sensor.limit, self.clipped)
        return acceleration

    def _converted(self, values: Array) -> Array:
        most, step = self._sensor.limit, self._sensor.resolution
        held = np.clip(values, -most, most)
        return np.asarray(np.rint(held / step) * step) if step else held


def _ratios(rate: float, force_rate: float) -> tuple[int, int]:
    """Steps of the path between forces, and samples of the path between those that come out."""
    parts = max(1, round(rate / force_rate))
    every = max(1, round(force_rate / rate))
    if abs(rate * every - force_rate * parts) > 1e-9 * force_rate:
        raise InputError("acceleration_rate", f"{force_rate:g} Hz times or over a whole number", f"{rate:g} Hz")
    return parts, every


def _taps(half: int, every: int) -> Array:
    """Symmetric low-pass of 2 half + 1 weights whose sum is 1; (1,) where nothing is left out."""
    if half == 0:
        return np.ones(1)
    weights = firwin(2 * half + 1, 1.0 / every, window=("kaiser", kaiser_beta(ATTENUATION)))
    return np.asarray(weights, dtype=np.float64)
