"""Speed and accuracy of the batched sweeps: many parameter points in the lanes of one core."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from nw_gear_common.benchmarking import Figure
from nw_gear_common.tables import Array
from nw_gear_sim import config
from nw_gear_sim.batch.batch import Batch
from nw_gear_sim.batch.measure import points_per_second
from nw_gear_sim.bench.accuracy import SETTLED
from nw_gear_sim.bench.cases import RATE
from nw_gear_sim.params import Configuration


@dataclass(frozen=True)
class Setting:
    """How a sweep runs, and the points x physical seconds per CPU second that are wanted."""

    name: str
    ring: str
    step: float
    goal: float


SETTINGS = (
    Setting("accurate", "flexible", 1.0 / 40960.0, 55.0),
    Setting("fast", "flexible", 1.0 / 20480.0, 100.0),
    Setting("rigid_fast", "rigid", 1.0 / 20480.0, 170.0),
)


def measure(configuration: Configuration, exact: Array, steps: int) -> tuple[dict[str, Any], list[Figure]]:
    """Return values and lines of all settings.

    Args:
        configuration: of the gearbox; the points differ in load.
        exact: elongations x_n at rated load by the reference at RATE, (samples, 7).
        steps: of each timing.
    """
    values: dict[str, Any] = {}
    figures = []
    for setting in SETTINGS:
        speed = points_per_second(configuration, ring=setting.ring, step=setting.step, steps=steps)
        off = error(configuration, setting, exact)
        values[setting.name] = {"step": setting.step, "points_per_second": speed, "error_um": 1e6 * off}
        name = f"sweep, {setting.ring} ring, step 1/{1.0 / setting.step:.0f} s"
        figures += [
            Figure(f"{name}: points a second", f"{speed:.4g}", f">= {setting.goal:g}", speed >= setting.goal),
            Figure(f"{name}: error at rated load", f"{1e6 * off:.3g} um"),
        ]
    return values, figures


def error(configuration: Configuration, setting: Setting, exact: Array) -> float:
    """Return the largest settled difference of x_n from the reference (m), that of the contact models included."""
    whole = config.with_values({"operation.load": 1.0}, configuration)
    batch = Batch([whole], ring=setting.ring, step=setting.step, sample_rate=RATE, threads=1)
    span = batch.advance((len(exact) - 1) / RATE)
    place = np.rint(span.time * RATE).astype(np.int64)
    there = (place >= SETTLED) & (place < len(exact))
    return float(np.max(np.abs(span.x[0, there] - exact[place[there]])))
