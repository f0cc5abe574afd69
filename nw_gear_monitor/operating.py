"""The operating point of one second: how fast the machine turns and how much it carries."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from nw_gear_monitor.machine import Machine
from nw_gear_monitor.signals.stream import Second


@dataclass(frozen=True)
class Operating:
    """Means over one second.

    Attributes:
        torque: anything that grows with the torque (N m, N, or the displacement of a mesh, m); nan = unknown.
        speed: anything that grows in proportion to the speed (a mesh frequency, Hz).
        wind: m/s; counts where the torque is unknown; nan = unknown.
    """

    torque: float
    speed: float
    wind: float = math.nan

    @property
    def load(self) -> float:
        """Torque, or else wind."""
        return self.wind if math.isnan(self.torque) else self.torque


def operating_point(second: Second, machine: Machine) -> Operating:
    """Read the operating point from the waveform alone.

    Speed is the mesh frequency (Hz) of the first stage. For the torque stands the mean displacement of the last stage
    whose channels follow the load: x = half gap + F / k grows with the mesh force F; nan where no channel follows it.
    """
    phase = second.column(machine.phase_columns[0])
    speed = float(phase[-1] - phase[0]) * second.rate / (2.0 * np.pi * (phase.size - 1))
    return Operating(_load(second, machine), speed)


def _load(second: Second, machine: Machine) -> float:
    for stage in reversed(machine.stage_names):
        loaded = [name for name in machine.members[stage] if machine.channel(name).loaded]
        if loaded:
            return float(np.mean([np.mean(second.column(f"x_{name}")) for name in loaded]))
    return math.nan
