"""One run of the gearbox with what drives it: ticks of a fixed length, counts for the truth. No ROS, no clock."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_sim.drives import Inputs, Source
from nw_gear_sim.faults.injection import check_faults
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.params.faults import FaultSettings
from nw_gear_sim.readings import Block, joined, thinned
from nw_gear_sim.simulation import Simulation, steps_per_sample

LONGEST_TICK = 0.0126
"""Seconds of simulated time integrated at once: short enough for views at 50 Hz and a smooth pace."""

_SIMULATION, _SOURCE = "simulation.", "source."


class Session:
    """Drives a `Simulation`.

    Args:
        configuration: gearbox, turbine and operating point.
        source: what drives it.
        excitation: `kinematic` or `tied`.
        start: `equilibrium` or `zero`.
        sample_rate: samples per second (Hz).
        every_step: whether `fine` has a sample of every step; the samples that `advance` returns stay the same, bit
            for bit.

    Attributes:
        fine_rate: samples per second of `fine`, Hz.
        fine: samples of the last tick.

    Raises:
        InputError: the sample rate gives no whole number of samples per block, or of steps per sample.
    """

    def __init__(
        self,
        configuration: Configuration,
        source: Source,
        excitation: str,
        start: str,
        sample_rate: float,
        *,
        every_step: bool = False,
    ) -> None:
        rows = sample_rate / names.WAVEFORM_BLOCKS_PER_SECOND
        if rows != int(rows):
            raise InputError(
                "parameter sample_rate", f"a multiple of {names.WAVEFORM_BLOCKS_PER_SECOND} Hz", f"{sample_rate:g} Hz"
            )
        steps = steps_per_sample(configuration.numerics, sample_rate)
        self._finer = steps if every_step else 1
        self.fine_rate = sample_rate * self._finer
        self.fine: Block | None = None
        self.rows = int(rows)
        longest = LONGEST_TICK * sample_rate
        divisors = [d for d in range(1, self.rows + 1) if self.rows % d == 0 and self.rows / d <= longest]
        every = self.rows // divisors[0] if divisors else 1
        self.tick = every / sample_rate
        parts = min(every, max(1, math.ceil(self.tick / source.longest - 1e-9)))
        self._pieces = [every * (k + 1) // parts - every * k // parts for k in range(parts)]
        self.source = source
        self._configuration = configuration
        self._excitation, self._start, self._sample_rate = excitation, start, sample_rate
        self._simulation: Simulation | None = None
        self._inputs: Inputs = {}
        self._kinematics = derive(configuration)
        self.faults = FaultSettings()
        self._open = np.zeros(len(names.MESHES))
        self._back = np.zeros(len(names.MESHES))
        self._ticks = 0

    @property
    def begun(self) -> bool:
        """Whether there is a state to go on from."""
        return self._simulation is not None

    def forget(self) -> None:
        """Be as before `begin`."""
        self._simulation = None

    @property
    def time(self) -> float:
        """Seconds of simulated time since the start."""
        return self._simulation.time if self._simulation is not None else 0.0

    @property
    def description(self) -> str:
        """What drives the gearbox and where it is, in words."""
        drive = self.source.drive
        speed, torque = drive.speed_end * 30.0 / math.pi, drive.torque_end / 1e6
        return f"{self.source.description}, ring {speed:.2f} r/min, torque {torque:.3f} MN m"

    def begin(self, inputs: Inputs) -> None:
        """Start from the initial state, with the inputs that the source needs."""
        self._inputs = inputs
        self._simulation = Simulation(
            self._configuration,
            self.source.begin(inputs),
            start=self._start,
            excitation=self._excitation,
            sample_rate=self.fine_rate,
        )
        self._simulation.inject(self.faults)
        self._forget_second()

    def inject(self, faults: FaultSettings) -> None:
        """Have these faults from now on, or from the beginning of a run.

        Raises:
            InputError: a gear hasn't so many teeth; nothing is changed.
        """
        check_faults(faults, self._kinematics)
        if self._simulation is not None:
            self._simulation.inject(faults)
        self.faults = faults

    def checkpoint(self) -> dict[str, Any]:
        """Return all that the future depends on: simulation and source."""
        assert self._simulation is not None, "begin comes first"
        simulation = {_SIMULATION + name: value for name, value in self._simulation.checkpoint().items()}
        return {**simulation, **{_SOURCE + name: value for name, value in self.source.state().items()}}

    def resume(self, checkpoint: Mapping[str, Any]) -> None:
        """Go on from what `checkpoint` returned, in the place of `begin`.

        Raises:
            InputError: the checkpoint is of another kind of run, or incomplete.
        """

        def part(prefix: str) -> dict[str, Any]:
            return {name.removeprefix(prefix): v for name, v in checkpoint.items() if name.startswith(prefix)}

        try:
            self.source.restore(part(_SOURCE))
            self._simulation = Simulation.resume(
                self._configuration, part(_SIMULATION), excitation=self._excitation, sample_rate=self.fine_rate
            )
        except (KeyError, TypeError, ValueError) as error:
            got = f"one without a usable {error}" if isinstance(error, KeyError) else str(error)
            raise InputError("checkpoint", f"that of a run {self.source.description}", got) from error
        self.faults = self._simulation.faults
        self._forget_second()

    def advance(self, inputs: Inputs) -> Block:
        """Integrate one tick, at whose end the inputs are as given, and return its samples.

        A source that changes faster is asked several times within the tick, each time for whole samples.
        """
        assert self._simulation is not None, "begin comes first"
        self._inputs = inputs
        blocks = []
        for samples in self._pieces:
            drive = self.source.advance(inputs, samples / self._sample_rate)
            blocks.append(self._simulation.advance(samples * self._finer, drive))
        self.fine = joined(blocks)
        block = thinned(self.fine, self._finer)
        self._open += block.open_fraction
        self._back += block.back_fraction
        self._ticks += 1
        return block

    def values(self) -> dict[str, str]:
        """What drives the gearbox now, for diagnostics."""
        drive = self.source.drive
        values = {
            "ring speed (r/min)": f"{drive.speed_end * 30 / math.pi:.4f}",
            "input torque (N m)": f"{drive.torque_end:.6g}",
        }
        if self.source.phase():
            values["load case"] = self.source.phase()
        wind = self._inputs.get("wind")
        return values if wind is None else {"wind speed (m/s)": f"{wind:.3f}", **values}

    def fault_names(self) -> list[str]:
        """The kinds of faults that are there, in words."""
        return self._simulation.fault_names() if self._simulation is not None else []

    def truth(self) -> dict[str, str]:
        """Ground truth since the last call: excitation, events, how often each mesh was open or on its back flank."""
        ticks = max(1, self._ticks)
        values = {"excitation": self._excitation, "drive": self.source.description}
        values |= {f"{event} (s)": f"{time:.6f}" for event, time in self.source.events().items()}
        values |= self._simulation.truth() if self._simulation is not None else {}
        for mesh, share, back in zip(names.MESHES, self._open / ticks, self._back / ticks, strict=True):
            values[f"open fraction {mesh} (1)"] = f"{share:.6f}"
            values[f"back-flank fraction {mesh} (1)"] = f"{back:.6f}"
        self._forget_second()
        return values

    def _forget_second(self) -> None:
        self._open[:] = 0.0
        self._back[:] = 0.0
        self._ticks = 0
