"""What the monitor has to know of the machine it watches: stages, channels, shafts and bearings, and their columns.

The built-in gearbox is one such description (`gearing.gearing`), a file of somebody else's machine another
(`machinefile.load`). Inside the monitor the columns have the same names for every machine: `phase_<stage>` (mesh phase
of planet 1, rad), `x_<channel>`, `v_<channel>`, `fx_<bearing>` and `fy_<bearing>`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.bearing_orders import BearingOrders
from nw_gear_monitor.signals.layout import Layout
from nw_gear_monitor.signals.stream import Second

STROBES_PER_SECOND = 390.0
"""Points of the residual tests per second at the nominal speed, at least."""
LEAST_STROBES = 2
AXES = ("fx", "fy")
"""Names of a bearing's columns inside the monitor; a bearing has one or two."""


@dataclass(frozen=True)
class Stage:
    """One gear stage.

    Attributes:
        name: its name, which is part of the topic `section/<stage>`.
        phase: column of the waveform that tells its phase, rad, unwrapped.
        cycles: mesh cycles per turn of that phase (1 where it is the mesh phase itself).
        frequency: mesh frequency at nominal speed, Hz.
        teeth: of driver and driven gear; None where they aren't known.
        half_gap: displacement at which flanks touch, m; None where it isn't known.
    """

    name: str
    phase: str
    cycles: float
    frequency: float
    teeth: tuple[int, int] | None = None
    half_gap: float | None = None

    @property
    def strobes(self) -> int:
        """Points of the residual tests per mesh cycle: a power of two, STROBES_PER_SECOND or more at nominal speed."""
        wanted = math.ceil(math.log2(max(STROBES_PER_SECOND / self.frequency, 1.0)))
        return max(int(2**wanted), LEAST_STROBES)


@dataclass(frozen=True)
class Channel:
    """One measured vibration, which belongs to a stage.

    Attributes:
        name: part of the topic `indicators/<name>`.
        stage: name of its stage.
        x: column of the waveform.
        v: column of its derivative; None where there's none, so that it is made by differences.
        unit: of x.
        planet: number of the planet, from 1.
        planet_phase: what its mesh phase has more than that of planet 1, rad.
        loaded: whether the mean of x follows the load.
    """

    name: str
    stage: str
    x: str
    v: str | None
    unit: str = "m"
    planet: int = 1
    planet_phase: float = 0.0
    loaded: bool = True


@dataclass(frozen=True)
class Shaft:
    """One shaft: `teeth` mesh cycles of a stage per turn, whole where a gear of that stage sits on it."""

    name: str
    stage: str
    teeth: float


@dataclass(frozen=True)
class Bearing:
    """One bearing.

    Attributes:
        name: part of the topic `indicators/<name>`.
        shaft: name of the shaft that turns in it.
        columns: one or two of the waveform; it is watched where all of them are there.
        unit: of the columns.
        rollers: their number; None where it isn't known.
        orders: knocks per turn of the shaft; None where they aren't known.
        optional: whether a waveform may come without its columns.
    """

    name: str
    shaft: str
    columns: tuple[str, ...]
    unit: str = "N"
    rollers: int | None = None
    orders: BearingOrders | None = None
    optional: bool = False


@dataclass(frozen=True)
class Machine:
    """Everything the monitor knows of one machine.

    Attributes:
        sidebands: expected lines on either side of mesh lines at the speed of every shaft; 0 where the shafts leave no
            trace in regular motion.
    """

    name: str
    stages: tuple[Stage, ...]
    channels: tuple[Channel, ...]
    shafts: tuple[Shaft, ...] = ()
    bearings: tuple[Bearing, ...] = ()
    sidebands: int = 0

    @cached_property
    def stage_names(self) -> tuple[str, ...]:
        """Names of the stages, in order."""
        return tuple(stage.name for stage in self.stages)

    @cached_property
    def channel_names(self) -> tuple[str, ...]:
        """Names of the channels, in order."""
        return tuple(channel.name for channel in self.channels)

    @cached_property
    def members(self) -> dict[str, tuple[str, ...]]:
        """Stage -> names of its channels."""
        return {s: tuple(c.name for c in self.channels if c.stage == s) for s in self.stage_names}

    @cached_property
    def places(self) -> dict[str, list[int]]:
        """Stage -> numbers of its channels."""
        return {s: [i for i, c in enumerate(self.channels) if c.stage == s] for s in self.stage_names}

    @cached_property
    def planet_phase(self) -> dict[str, float]:
        """Channel -> what its mesh phase has more than that of its stage's planet 1, rad."""
        return {channel.name: channel.planet_phase for channel in self.channels}

    @cached_property
    def phase_columns(self) -> tuple[str, ...]:
        """Mesh phases inside the monitor."""
        return tuple(f"phase_{name}" for name in self.stage_names)

    @cached_property
    def x_columns(self) -> tuple[str, ...]:
        """Signals of the channels inside the monitor."""
        return tuple(f"x_{name}" for name in self.channel_names)

    @cached_property
    def v_columns(self) -> tuple[str, ...]:
        """Their derivatives inside the monitor."""
        return tuple(f"v_{name}" for name in self.channel_names)

    @cached_property
    def rated_frequency(self) -> Array:
        """Mesh frequencies of the stages at nominal speed, (stages,), Hz."""
        return np.array([stage.frequency for stage in self.stages])

    @cached_property
    def ratios(self) -> Array:
        """Mesh frequencies over that of the first stage, (stages,)."""
        ratios: Array = self.rated_frequency / self.rated_frequency[0]
        return ratios

    @cached_property
    def sideband_shafts(self) -> list[int]:
        """For each shaft with sidebands, the number of its stage."""
        return [self.stage_names.index(shaft.stage) for shaft in self.shafts] if self.sidebands else []

    @cached_property
    def line_frequency(self) -> Array:
        """Nominal frequencies of the phases that lines follow, (phases,), Hz: meshes, then shafts with sidebands."""
        frequency: Array = self.line_phase(self.rated_frequency[None, :])[0]
        return frequency

    def line_phase(self, phase: Array) -> Array:
        """Phases that lines follow, (samples, phases), from the mesh phases (samples, stages), rad."""
        if not self.sideband_shafts:
            return phase
        teeth = np.array([shaft.teeth for shaft in self.shafts], dtype=np.float64)
        return np.hstack([phase, phase[:, self.sideband_shafts] / teeth])

    @cached_property
    def derived(self) -> Mapping[str, str]:
        """Column that is made by differences -> column that it is made of."""
        return {f"v_{c.name}": f"x_{c.name}" for c in self.channels if c.v is None}

    @cached_property
    def layout(self) -> Layout:
        """What the stream has to hold."""
        values = tuple(c.x for c in self.channels) + tuple(c.v for c in self.channels if c.v is not None)
        values += tuple(column for b in self.bearings if not b.optional for column in b.columns)
        optional = tuple(column for b in self.bearings if b.optional for column in b.columns)
        cycles: dict[str, float] = {}
        for stage in self.stages:
            cycles[stage.phase] = max(stage.cycles, cycles.get(stage.phase, 0.0))
        return Layout(tuple(cycles), tuple(cycles.values()), tuple(dict.fromkeys(values)), optional)

    def stage(self, name: str) -> Stage:
        """A stage by its name."""
        return self.stages[self.stage_names.index(name)]

    def channel(self, name: str) -> Channel:
        """A channel by its name."""
        return self.channels[self.channel_names.index(name)]

    def shaft(self, name: str) -> Shaft:
        """A shaft by its name."""
        return next(shaft for shaft in self.shafts if shaft.name == name)

    def inside(self, second: Second) -> Second:
        """The same second with the columns that the monitor uses, whatever they are called in the waveform."""
        names, sources = self._sources(second.columns)
        if all(name == source and factor == 1.0 for name, (source, factor) in zip(names, sources, strict=True)):
            return second
        where = [second.columns.index(source) for source, _ in sources]
        data = second.data[:, where] * np.array([factor for _, factor in sources])
        return Second(second.start, second.epoch, second.rate, names, data)

    def source(self, name: str) -> str:
        """Column of the waveform that one inside the monitor comes from."""
        everything = tuple(column for bearing in self.bearings for column in bearing.columns)
        inside, sources = self._sources(everything)
        return sources[inside.index(name)][0]

    def _sources(self, columns: tuple[str, ...]) -> tuple[tuple[str, ...], list[tuple[str, float]]]:
        """Names inside, and for each the waveform's column and a factor."""
        found: dict[str, tuple[str, float]] = {"time": ("time", 1.0)}
        found |= {f"phase_{s.name}": (s.phase, s.cycles) for s in self.stages}
        found |= {f"x_{c.name}": (c.x, 1.0) for c in self.channels}
        found |= {f"v_{c.name}": (c.v, 1.0) for c in self.channels if c.v is not None}
        for bearing in self.bearings:
            if all(column in columns for column in bearing.columns):
                found |= {f"{a}_{bearing.name}": (c, 1.0) for a, c in zip(AXES, bearing.columns, strict=False)}
        return tuple(found), list(found.values())
