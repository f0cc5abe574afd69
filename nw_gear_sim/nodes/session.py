"""One run of the gearbox with its drive: ticks of a fixed length, wind or a fixed operating point. No ROS, no clock."""

from __future__ import annotations

import math

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.rotor import Rotor
from nw_gear_sim.readings import Block
from nw_gear_sim.simulation import Simulation, steps_per_sample

LONGEST_TICK = 0.0126
"""Seconds of simulated time integrated at once: short enough for views at 50 Hz and a smooth pace."""


class Session:
    """Drives a `Simulation`.

    Args:
        configuration: gearbox, turbine and operating point.
        excitation: `kinematic` or `tied`.
        start: `equilibrium` or `zero`.
        sample_rate: samples per second (Hz).

    Raises:
        InputError: the sample rate gives no whole number of samples per block, or of steps per sample.
    """

    def __init__(self, configuration: Configuration, excitation: str, start: str, sample_rate: float) -> None:
        rows = sample_rate / names.WAVEFORM_BLOCKS_PER_SECOND
        if rows != int(rows):
            raise InputError(
                "parameter sample_rate", f"a multiple of {names.WAVEFORM_BLOCKS_PER_SECOND} Hz", f"{sample_rate:g} Hz"
            )
        steps_per_sample(configuration.numerics.step, sample_rate)
        self.rows = int(rows)
        longest = LONGEST_TICK * sample_rate
        divisors = [d for d in range(1, self.rows + 1) if self.rows % d == 0 and self.rows / d <= longest]
        self._samples = self.rows // divisors[0] if divisors else 1
        self.tick = self._samples / sample_rate
        self._configuration = configuration
        self._excitation, self._start, self._sample_rate = excitation, start, sample_rate
        self.wind_driven = configuration.operation.drive == "wind"
        self._simulation: Simulation | None = None
        self._rotor: Rotor | None = None
        self._drive = Drive(0.0, 0.0, 0.0, 0.0)
        self._wind = math.nan
        self._open = np.zeros(len(names.MESHES))
        self._back = np.zeros(len(names.MESHES))
        self._ticks = 0

    @property
    def time(self) -> float:
        """Seconds of simulated time since the start."""
        return self._simulation.time if self._simulation is not None else 0.0

    @property
    def description(self) -> str:
        """The operating point in words."""
        how = "driven by the wind" if self.wind_driven else "at a fixed operating point"
        speed, torque = self._drive.speed_end * 30.0 / math.pi, self._drive.torque_end / 1e6
        return f"{how}, ring {speed:.2f} r/min, torque {torque:.3f} MN m"

    def begin(self, wind: float | None) -> None:
        """Start from the initial state, at the operating point of this wind (m/s), or of the configuration."""
        if wind is None:
            self._rotor = None
            fixed = derive(self._configuration)
            self._drive = Drive(fixed.ring_speed, fixed.ring_speed, fixed.input_torque, fixed.input_torque)
        else:
            self._rotor = Rotor(self._configuration.turbine, wind)
            self._drive = Drive(self._rotor.speed, self._rotor.speed, self._rotor.torque, self._rotor.torque)
            self._wind = wind
        self._simulation = Simulation(
            self._configuration,
            self._drive,
            start=self._start,
            excitation=self._excitation,
            sample_rate=self._sample_rate,
        )
        self._forget_second()

    def advance(self, wind: float | None) -> Block:
        """Integrate one tick, at whose end the wind is as given (m/s), and return its samples."""
        assert self._simulation is not None, "begin comes first"
        if self._rotor is not None and wind is not None:
            self._wind = wind
            self._drive = self._rotor.advance(wind, self.tick)
        block = self._simulation.advance(self._samples, self._drive)
        self._open += block.open_fraction
        self._back += block.back_fraction
        self._ticks += 1
        return block

    def values(self) -> dict[str, str]:
        """What drives the gearbox now, for diagnostics."""
        values = {
            "ring speed (r/min)": f"{self._drive.speed_end * 30 / math.pi:.4f}",
            "input torque (N m)": f"{self._drive.torque_end:.6g}",
        }
        return {"wind speed (m/s)": f"{self._wind:.3f}", **values} if self.wind_driven else values

    def truth(self) -> dict[str, str]:
        """Ground truth since the last call: excitation and how often each mesh was open or on its back flank."""
        ticks = max(1, self._ticks)
        values = {"excitation": self._excitation}
        for mesh, share, back in zip(names.MESHES, self._open / ticks, self._back / ticks, strict=True):
            values[f"open fraction {mesh} (1)"] = f"{share:.6f}"
            values[f"back-flank fraction {mesh} (1)"] = f"{back:.6f}"
        self._forget_second()
        return values

    def _forget_second(self) -> None:
        self._open[:] = 0.0
        self._back[:] = 0.0
        self._ticks = 0
