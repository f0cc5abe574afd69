"""Healthy minutes of the full model in turbulent wind, seen by the monitor second by second. No ROS, no clock."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.gearing import gearing
from nw_gear_monitor.pipeline import Hop, Pipeline
from nw_gear_sim import config
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.rotor import Rotor
from nw_gear_sim.physics.wind_weibull import WeibullWind
from nw_gear_sim.simulation import Simulation

TICK = 0.1
"""Seconds between two values of the wind."""
BEARINGS = [names.BEARINGS.index(bearing) for bearing in names.WAVEFORM_BEARINGS]


@dataclass(frozen=True, eq=False)
class Recording:
    """What the monitor saw.

    Attributes:
        columns: `<mesh>/<indicator>` and `bearing <bearing>/<indicator>`.
        values: (seconds, columns); nan where a window gave no value.
        speed, load: (seconds,) operating points of the seconds.
    """

    columns: tuple[str, ...]
    values: Array
    speed: Array
    load: Array

    def save(self, path: Path) -> None:
        """Write it as NPZ."""
        np.savez_compressed(path, columns=np.array(self.columns), values=self.values, speed=self.speed, load=self.load)

    @classmethod
    def open(cls, path: Path) -> Recording:
        """Read what `save` wrote."""
        with np.load(path) as data:
            columns = tuple(str(name) for name in data["columns"])
            return cls(columns, data["values"], data["speed"], data["load"])


def record(seed: int, seconds: int) -> Recording:
    """Let the default gearbox turn in the configured Weibull wind of a seed.

    Args:
        seed: of the wind.
        seconds: simulated.
    """
    rows = [_row(hop) for hop in hops(seed, seconds)]
    columns = tuple(rows[0][0])
    values = np.array([list(row.values()) for row, _, _ in rows])
    return Recording(columns, values, np.array([r[1] for r in rows]), np.array([r[2] for r in rows]))


def hops(seed: int, seconds: int) -> Iterator[Hop]:
    """The monitor's results, second by second."""
    configuration = config.load(None)
    wind = configuration.wind
    process = WeibullWind(wind.weibull_shape, wind.weibull_scale, wind.sampling_interval, wind.correlation_time, seed)
    rotor = Rotor(configuration.turbine, process.at(0.0))
    simulation = Simulation(configuration, Drive(rotor.speed, rotor.speed, rotor.torque, rotor.torque))
    pipeline = Pipeline(gearing(configuration))
    samples = round(TICK * simulation.sample_rate)
    columns = names.waveform_columns()
    for tick in range(round(seconds / TICK) + 1):
        block = simulation.advance(samples, rotor.advance(process.at(TICK * (tick + 1)), TICK))
        forces = block.bearing_force[:, BEARINGS, :2].reshape(len(block.time), -1)
        data = np.column_stack([block.time, block.phase, block.x, block.v, forces])
        yield from pipeline.feed(Table(names.ROW_SAMPLE, columns, data))


def _row(hop: Hop) -> tuple[dict[str, float], float, float]:
    row: dict[str, float] = {}
    for prefix, tables in (("", hop.indicators), ("bearing ", hop.bearing_indicators)):
        for element, table in tables.items():
            for column, value in zip(table.columns[1:], table.data[0, 1:], strict=True):
                row[f"{prefix}{element}/{column}"] = float(value)
    return row, hop.operating.speed, hop.operating.load
