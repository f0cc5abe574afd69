"""Runs the monitor once on noise, so that every compiled kernel is there before the first sample comes."""

from __future__ import annotations

import math

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.alarms.center import AlarmCenter
from nw_gear_monitor.alarms.features import SHORT
from nw_gear_monitor.alarms.settings import AlarmSettings
from nw_gear_monitor.machine import Machine
from nw_gear_monitor.operating import Operating
from nw_gear_monitor.pipeline import Pipeline
from nw_gear_monitor.stage_state import LEAST_SECONDS

LEAST_RATE = 640
SAMPLES_PER_CYCLE = 3.0
"""Of the fastest mesh: with fewer the monitor wouldn't look for lines."""
SAMPLE = "rms"
"""An indicator that raises alarms."""


def warm_up(machine: Machine) -> None:
    """Feed a noise of a little more than the shortest labelled window through a pipeline of its own."""
    rate = max(LEAST_RATE, math.ceil(SAMPLES_PER_CYCLE * float(np.max(machine.rated_frequency))))
    samples = rate * LEAST_SECONDS + 1
    layout = machine.layout
    bearings = (column for bearing in machine.bearings for column in bearing.columns)
    columns = tuple(dict.fromkeys(("time", *layout.phases, *layout.values, *bearings)))
    data = 1e-6 * np.random.default_rng(0).standard_normal((samples, len(columns)))
    data[:, 0] = np.arange(samples) / rate
    turns = [next(s.frequency / s.cycles for s in machine.stages if s.phase == phase) for phase in layout.phases]
    data[:, 1 : 1 + len(turns)] = 2.0 * np.pi * np.outer(data[:, 0], turns)
    Pipeline(machine).feed(Table(names.ROW_SAMPLE, columns, data))
    _warm_up_alarms()


def _warm_up_alarms() -> None:
    """Two windows of one feature, and its limits."""
    center = AlarmCenter(AlarmSettings(least_windows=1), {SHORT: 1})
    point, feature = Operating(torque=1.0, speed=1.0), f"mesh/{SAMPLE}"
    for time in (1.0, 2.0, 3.0):
        center.update(time, point, {feature: 1.0})
    for key in center.baseline.bins:
        center.limits(key, feature)
