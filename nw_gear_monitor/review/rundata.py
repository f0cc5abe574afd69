"""What the report needs to know about a run: filled by `gather`, drawn by `figures`, worded by `summary`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from nw_gear_common import names
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.review.decimate import Band

OK, WARN, ERROR, SILENT = 0, 1, 2, 3
"""Levels of diagnostic_msgs/DiagnosticStatus (the last is called STALE there)."""
TURNING = 0.01
"""Mesh frequency (Hz) under which a stage counts as standing still."""
LEVEL_WORDS = {OK: "OK", WARN: "warning", ERROR: "error", SILENT: "stale"}


@dataclass(frozen=True)
class Span:
    """A stretch of time in which a diagnostic status kept its level and state.

    Attributes:
        name: of the status, for instance `gear_monitor_node: stage II`.
        start, end: seconds of ROS time; the end is the stamp of the last message that said so.
        level: 0 to 3.
        state: the label, empty where the status has none.
        reason: the message when the stretch began, without the label.
    """

    name: str
    start: float
    end: float
    level: int
    state: str
    reason: str

    @property
    def duration(self) -> float:
        """Seconds."""
        return self.end - self.start


@dataclass(frozen=True)
class Gap:
    """Samples missing in the waveform: when the last good one was (s of ROS time), and how long until the next."""

    start: float
    seconds: float


@dataclass(frozen=True, eq=False)
class Window:
    """A stretch of the waveform sample by sample: why it is shown, and its samples."""

    title: str
    samples: Table


@dataclass(frozen=True, eq=False)
class Waveform:
    """The waveform of the run, reduced.

    Attributes:
        rate: samples per second (Hz), from the stamps.
        samples: how many were recorded.
        displacement: meshing displacements (m), one channel per mesh.
        bearing: radial bearing forces (N), one channel per bearing in the waveform.
        mesh_frequency: mesh frequencies (Hz), one channel per stage, block by block.
        rms, lowest, highest: root mean square about the mean, minimum and maximum of every displacement (m).
        tail: the last seconds at full rate.
        gaps: missing samples.
    """

    rate: float
    samples: int
    displacement: Band
    bearing: Band | None
    mesh_frequency: Band
    rms: Mapping[str, float]
    lowest: Mapping[str, float]
    highest: Mapping[str, float]
    tail: Table
    gaps: tuple[Gap, ...]


@dataclass(frozen=True, eq=False)
class Spectra:
    """Spectra that the monitor published.

    Attributes:
        axis: frequency (Hz) or order, shape (bins,).
        meshes: the columns.
        last: amplitudes (m) of the last message, shape (bins, meshes).
        mean: their mean over the run, shape (bins, meshes).
        times: seconds of ROS time of the rows of the map.
        waterfall: maxima over the meshes of each stage, shape (rows, bins, stages).
        count: how many messages there were.
    """

    axis: Array
    meshes: tuple[str, ...]
    last: Array
    mean: Array
    times: Array
    waterfall: Array
    count: int


@dataclass(frozen=True, eq=False)
class RunData:
    """A recording as the report shows it. What wasn't recorded is None or empty.

    Attributes:
        source: the recording's folder.
        complete: False where the recording was damaged and read through a repaired copy.
        remarks: what a reader has to know about the data (damage, restarts), in words.
        start, end: seconds of ROS time.
        wall_time: whether that is the time of day (else simulated time from 0).
        topics: name to (type, count).
        provenance: metadata of the recording, section to key to text.
        wind: wind speed (m/s).
        speed, torque: of the shafts (rad/s, N m).
        mesh_force: at the view rate (N).
        bearing_radial, bearing_axial: at the view rate (N).
        waveform, spectra, orders: see there.
        sections: points of each stage, stretches spread over the run and all of its end: time, planet, x, v.
        indicators: rows of each mesh.
        bearing_indicators: rows of each bearing.
        spans: history of every diagnostic status by name.
        values: last values of every diagnostic status by name.
        truth: last values of the simulator's truth.
        truth_means: mean over the run of those that are numbers.
        truth_message: its message.
        windows: stretches that are shown sample by sample.
    """

    source: Path
    complete: bool
    remarks: tuple[str, ...]
    start: float
    end: float
    topics: Mapping[str, tuple[str, int]]
    provenance: Mapping[str, Mapping[str, str]]
    wind: Band | None = None
    speed: Band | None = None
    torque: Band | None = None
    mesh_force: Band | None = None
    bearing_radial: Mapping[str, Band] = field(default_factory=dict)
    bearing_axial: Mapping[str, Band] = field(default_factory=dict)
    waveform: Waveform | None = None
    spectra: Spectra | None = None
    orders: Spectra | None = None
    sections: Mapping[str, Array] = field(default_factory=dict)
    indicators: Mapping[str, Table] = field(default_factory=dict)
    bearing_indicators: Mapping[str, Table] = field(default_factory=dict)
    spans: Mapping[str, tuple[Span, ...]] = field(default_factory=dict)
    values: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    truth: Mapping[str, str] = field(default_factory=dict)
    truth_means: Mapping[str, float] = field(default_factory=dict)
    truth_message: str = ""
    windows: tuple[Window, ...] = ()

    @property
    def duration(self) -> float:
        """Seconds from the first to the last sample."""
        return self.end - self.start

    @property
    def wall_time(self) -> bool:
        """Whether the stamps are time of day; simulated time starts at 0 and never comes that far."""
        return self.start > 1e9

    @property
    def monitored(self) -> bool:
        """Whether anything of the monitor is in the recording."""
        return bool(
            self.spectra
            or self.orders
            or self.sections
            or self.indicators
            or any(self.stage_spans(s) for s in self.stage_names)
        )

    @property
    def wind_drove(self) -> bool:
        """Whether the wind drove the gearbox; at a fixed operating point the simulator names no wind."""
        said = next((v for name, v in self.values.items() if name.endswith(": integration")), None)
        return said is None or any(key.startswith("wind speed") for key in said)

    def contact(self, kind: str, mesh: str) -> float | None:
        """Share of the run in which a mesh was `open` or on its `back-flank`, None where the truth isn't known."""
        begin = f"{kind} fraction {mesh}"
        return next((mean for key, mean in self.truth_means.items() if key.split(" (")[0] == begin), None)

    @property
    def stage_names(self) -> tuple[str, ...]:
        """Stages of the machine that was watched: those with a history of states, else the built-in gearbox's."""
        found = tuple(name.split(": stage ")[1] for name in self.spans if ": stage " in name)
        return names.STAGES if set(found) <= set(names.STAGES) else found

    def stage_spans(self, stage: str) -> tuple[Span, ...]:
        """History of the states of one stage."""
        return next((spans for name, spans in self.spans.items() if name.endswith(f": stage {stage}")), ())
