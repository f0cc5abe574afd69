"""Runs of the full model in wind through the monitor and its alarms: learning, healthy minutes, faults. No ROS."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from detection.cases import (
    CONDITIONS,
    FAULT_SEED,
    LEARNING_SECONDS,
    LEARNING_SEEDS,
    MINUTE,
    SETTLING_SECONDS,
    SHAPE,
    Fault,
)
from nw_gear_common import names
from nw_gear_common.tables import Table
from nw_gear_monitor.alarms.center import AlarmCenter, Transition
from nw_gear_monitor.alarms.features import LONG, SHORT, features
from nw_gear_monitor.alarms.settings import AlarmSettings
from nw_gear_monitor.gearing import gearing
from nw_gear_monitor.pipeline import Hop, Pipeline, Windows
from nw_gear_sim import config
from nw_gear_sim.params.faults import FaultSettings
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.rotor import Rotor
from nw_gear_sim.physics.wind_weibull import WeibullWind
from nw_gear_sim.simulation import Simulation

TICK = 0.1
BEARINGS = [names.BEARINGS.index(bearing) for bearing in names.WAVEFORM_BEARINGS]


@dataclass(frozen=True)
class Finding:
    """What the alarms said of a run.

    Attributes:
        warn, error: seconds after the fault (or the start of the healthy minute) until the first alarm of at least that
            level, None for none.
        features: those that raised it first, in their order.
    """

    warn: float | None
    error: float | None
    features: tuple[str, ...]


def learn(condition: str) -> AlarmCenter:
    """Let an alarm centre learn a condition, and return it with its baseline frozen."""
    center = _new_center()
    for seed in LEARNING_SEEDS:
        center.interrupt()
        for hop in _hops(condition, seed, SETTLING_SECONDS + LEARNING_SECONDS):
            _update(center, hop)
    center.reset()
    center.learn = False
    return center


def healthy(center: AlarmCenter, condition: str, seed: int) -> Finding:
    """Watch a healthy minute."""
    return _watch(center, condition, seed, None, 0.0)


def faulty(center: AlarmCenter, condition: str, fault: Fault, severity: float) -> Finding:
    """Put a fault in, and watch for a minute."""
    return _watch(center, condition, FAULT_SEED, fault, severity)


def _watch(center: AlarmCenter, condition: str, seed: int, fault: Fault | None, severity: float) -> Finding:
    center = copy.deepcopy(center)
    center.interrupt()
    seen: list[Transition] = []
    for hop in _hops(condition, seed, SETTLING_SECONDS + MINUTE, fault, severity):
        transitions = _update(center, hop)
        if hop.time > SETTLING_SECONDS:
            seen += transitions
    raised = [t for t in seen if t.alarm.level > t.before]
    first = {
        level: next((t.time - SETTLING_SECONDS for t in raised if t.alarm.level >= level), None) for level in (1, 2)
    }
    at = [t.alarm.feature for t in raised if first[1] is not None and t.time - SETTLING_SECONDS == first[1]]
    return Finding(first[1], first[2], tuple(at))


def _new_center() -> AlarmCenter:
    windows = Windows()
    return AlarmCenter(AlarmSettings(), {SHORT: windows.spectrum_seconds, LONG: windows.label_seconds})


def _update(center: AlarmCenter, hop: Hop) -> list[Transition]:
    if hop.restarted:
        center.interrupt()
    return center.update(hop.time, hop.operating, features(hop.indicators, hop.bearing_indicators))


def _hops(condition: str, seed: int, seconds: int, fault: Fault | None = None, severity: float = 0.0) -> Iterator[Hop]:
    configuration = config.load(None)
    wind, turbine = configuration.wind, configuration.turbine
    scale = CONDITIONS[condition] * turbine.rated_wind
    process = WeibullWind(SHAPE, scale, wind.sampling_interval, wind.correlation_time, seed)
    rotor = Rotor(turbine, process.at(0.0))
    simulation = Simulation(configuration, Drive(rotor.speed, rotor.speed, rotor.torque, rotor.torque))
    pipeline = Pipeline(gearing(configuration))
    samples = round(TICK * simulation.sample_rate)
    columns = names.waveform_columns()
    for tick in range(round(seconds / TICK) + 1):
        if fault is not None and tick == round(SETTLING_SECONDS / TICK):
            asked: dict[str, Any] = {**fault.place, fault.parameter: severity}
            simulation.inject(FaultSettings(**asked))
        block = simulation.advance(samples, rotor.advance(process.at(TICK * (tick + 1)), TICK))
        forces = block.bearing_force[:, BEARINGS, :2].reshape(len(block.time), -1)
        data = np.column_stack([block.time, block.phase, block.x, block.v, forces])
        yield from pipeline.feed(Table(names.ROW_SAMPLE, columns, data))
