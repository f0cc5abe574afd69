"""Turns the last seconds of the waveform into a state per stage: line fit, residual tests, judgement, persistence."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.explained_lines import Explained, LineExplainer, LineSecond
from nw_gear_monitor.indicators.line_residual import line_residual, strobes
from nw_gear_monitor.indicators.noise_floor import noise_floor
from nw_gear_monitor.indicators.repetition import change_after, common_period, detrended
from nw_gear_monitor.indicators.tonal_share import tonal_share
from nw_gear_monitor.indicators.window import LineResult
from nw_gear_monitor.indicators.zero_one import zero_one
from nw_gear_monitor.machine import Machine
from nw_gear_monitor.signals import decimate
from nw_gear_monitor.signals.history import History
from nw_gear_monitor.stage_state import LEAST_SECONDS, REGULAR_RHO, Evidence, Persistence, State, judge

ZERO_ONE_STROBES = 1500
REPEATED_SECONDS = 4
"""Seconds in the window that must have been compared with one period before."""


@dataclass(frozen=True)
class StageReport:
    """The state of a stage that is shown, that of this window alone, and the evidence (None without a window)."""

    state: State
    window_state: State
    evidence: Evidence | None


class Labeller:
    """Labels the stages of one machine, second by second.

    Args:
        machine: what is watched.
        seconds: length of the window, s.
    """

    def __init__(self, machine: Machine, seconds: int) -> None:
        self._machine = machine
        self._explainer = LineExplainer(
            machine.line_frequency,
            machine.places,
            shafts=machine.sideband_shafts,
            sidebands=machine.sidebands,
            loaded=[i for i, channel in enumerate(machine.channels) if channel.loaded],
        )
        self._window: deque[LineSecond] = deque(maxlen=seconds)
        self._checks: deque[_Check] = deque(maxlen=seconds)
        self._period = math.nan if machine.sidebands else common_period(machine.rated_frequency)
        self._persistence = {stage: Persistence() for stage in machine.stage_names}

    def flush(self, reason: str) -> dict[str, StageReport]:
        """Drop the window (gap, standstill, reset); every stage is unknown from now on."""
        self._window.clear()
        self._checks.clear()
        state = State(names.UNKNOWN, reason)
        return {stage: StageReport(p.reset(state), state, None) for stage, p in self._persistence.items()}

    def add(self, history: History) -> tuple[dict[str, StageReport], dict[str, LineResult]]:
        """Take in the newest second of the history; returns the stages' states and the channels' numbers."""
        self._window.append(_line_second(self._machine, history))
        self._checks.append(_check(self._machine, history, self._period))
        seconds = len(self._window)
        if seconds < LEAST_SECONDS:
            self._explainer.prepare(list(self._window))
            state = State(names.UNKNOWN, f"{seconds} of at least {LEAST_SECONDS} s seen")
            return {stage: StageReport(p.reset(state), state, None) for stage, p in self._persistence.items()}, {}
        explained = self._explainer.explain(list(self._window))
        reports: dict[str, StageReport] = {}
        numbers: dict[str, LineResult] = {}
        for stage in self._machine.stage_names:
            tau, unlisted, k = self._residual_tests(stage, explained, history)
            evidence = self._evidence(stage, explained, history, (tau, unlisted, k))
            state = judge(stage, evidence)
            reports[stage] = StageReport(self._persistence[stage].add(state), state, evidence)
            for place in self._machine.places[stage]:
                rho = explained.channel_rho(place)
                numbers[self._machine.channel_names[place]] = LineResult(rho, tau, k)
        return reports, numbers

    def _residual_tests(self, stage: str, explained: Explained, history: History) -> tuple[float, float, float]:
        """Tonal share, order of the strongest unlisted line and K of the stage's channel with the largest residual."""
        if not explained.rho[stage] > REGULAR_RHO:
            return float("nan"), 0.0, float("nan")
        machine = self._machine
        channel = max(machine.places[stage], key=lambda c: explained.fit.residual[c])
        watched = machine.channels[channel]
        wanted = ("time", *machine.phase_columns, machine.x_columns[channel], machine.v_columns[channel])
        seconds = len(explained.fit.seconds)
        columns = history.select(wanted, seconds)
        time, phase, x, v = columns[:, 0], columns[:, 1:-2], columns[:, -2], columns[:, -1]
        own = phase[:, machine.stage_names.index(stage)] + watched.planet_phase
        per_cycle = machine.stage(stage).strobes
        starts = np.array([second.start for second in self._window])[-seconds:]
        rest = line_residual(explained.fit, starts, time, machine.line_phase(phase), own, x, v, channel, per_cycle)
        tau, cycles_per_point, _ = tonal_share(rest)
        return tau, cycles_per_point * per_cycle, zero_one(strobes(rest, per_cycle)[-ZERO_ONE_STROBES:])

    def _evidence(
        self, stage: str, explained: Explained, history: History, tests: tuple[float, float, float]
    ) -> Evidence:
        channels = self._machine.places[stage]
        seconds = len(explained.fit.modulation.maps)
        samples = history.newest.rate * seconds
        found = explained.subharmonic
        tau, unlisted, k = tests
        level = max(float(np.max(np.abs(history.newest.column(self._machine.x_columns[c])))) for c in channels)
        return Evidence(
            seconds=seconds,
            rho=explained.rho[stage],
            noise=_part(self._checks, "noise", channels),
            repetition=_part(self._checks, "moved", channels),
            tau=tau,
            k=k,
            subharmonic_stage=self._machine.stage_names[found[0]] if found else "",
            subharmonic_order=found[1] if found else 1,
            subharmonic_share=explained.shares[stage],
            unlisted_order=unlisted,
            deviation=float(np.sqrt(np.mean(explained.fit.energy[channels]) / samples)),
            level=level,
            speed_spread=explained.fit.modulation.speed_spread,
            speed_rate=explained.fit.modulation.speed_rate,
            load_spread=explained.fit.modulation.load_spread,
            lines=explained.fit.lines,
        )


@dataclass(frozen=True, eq=False)
class _Check:
    """What a second shows without a fit, (channels,) m^2; `moved` is NaN where history is too short.

    Attributes:
        noise: variance of white noise; own: variance of x without slow changes.
        moved: half the mean square of the change over the common period.
    """

    noise: Array
    own: Array
    moved: Array


def _check(machine: Machine, history: History, period: float) -> _Check:
    rows = len(history.newest.data)
    rate = history.newest.rate
    newest = history.select(machine.x_columns, 1)
    noise = noise_floor(newest) / decimate.factor(rate)  # the fit sees the decimated signal
    lead, x_end = machine.phase_columns[0], 1 + len(machine.channels)
    turned = history.newest.column(lead)
    cycles = (turned[-1] - turned[0]) / (2.0 * np.pi)
    own = detrended(newest).var(axis=0)
    nothing = _Check(noise, own, np.full_like(own, np.nan))
    if not (math.isfinite(period) and cycles > 0.0 and period / cycles < len(history) + 1):
        return nothing
    seconds = math.ceil(1.2 * period / cycles) + 2
    data = history.select((lead, *machine.x_columns, *machine.v_columns), seconds)
    change = change_after(data[:, 0], data[:, 1:x_end], data[:, x_end:], rows, 2.0 * np.pi * period, rate)
    return nothing if change is None else _Check(noise, own, 0.5 * change)


def _part(checks: Iterable[_Check], name: str, channels: list[int]) -> float:
    """A quantity over the variance, all channels of a stage and all seconds that have it; NaN with too few."""
    pairs = [(getattr(check, name)[channels].sum(), check.own[channels].sum()) for check in checks]
    there = np.array([pair for pair in pairs if math.isfinite(pair[0])])
    if len(there) < REPEATED_SECONDS or not there[:, 1].sum() > 0.0:
        return math.nan
    return float(there[:, 0].sum() / there[:, 1].sum())


def _line_second(machine: Machine, history: History) -> LineSecond:
    second = history.newest
    every = decimate.factor(second.rate)
    half = decimate.half_length(every)
    wanted = ("time", *machine.phase_columns, *machine.x_columns)
    rows = len(second.data) + 2 * half
    data = history.select(wanted, 2 if half else 1)[-rows:]
    first = 1 + len(machine.stages)
    x = decimate.decimate(data[:, first:], every)
    centres = data[half : half + every * len(x) : every]
    time, phase = centres[:, 0], machine.line_phase(centres[:, 1:first])
    return LineSecond(float(second.start), second.rate / every, time, phase, np.ascontiguousarray(x))
