"""What takes computing: phase diagrams, Poincaré maps and spectra, reduced once for all browsers."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.dashboard.feed import Feed, Spectra
from nw_gear_monitor.review.decimate import pool
from nw_gear_monitor.review.figures import phase
from nw_gear_monitor.review.figures.spectra import DECADES, FLOOR, HARMONICS, HIGHEST, HIGHEST_ORDER
from nw_gear_monitor.review.rundata import TURNING, RunData, Waveform

MICRO, MILLI = 1e6, 1e3
BINS = 1200
"""Most points of a drawn spectrum."""
LOOSE = 2.5
"""How many times smaller than its axes a picture may become before they follow."""


@dataclass(frozen=True, eq=False)
class Plane:
    """Phase diagram and Poincaré map of a stage, µm and mm/s.

    Attributes:
        paths: of each mesh, columns x and v.
        points: columns planet, x, v.
        x, v: ranges of the axes.
    """

    paths: dict[str, Array]
    points: Array
    x: tuple[float, float]
    v: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Curve:
    """Amplitudes of the meshes of a stage (µm) over frequency (Hz) or order, with the range of the axis."""

    axis: Array
    amplitude: dict[str, Array]
    shown: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Digest:
    """The pictures of one moment.

    Attributes:
        epoch: of the feed.
        planes: by stage.
        curves: by topic and stage.
        marks: by stage: places of the mesh frequencies (Hz) with their names.
        numbers: of the messages that the curves show, by topic.
    """

    epoch: int = -1
    planes: dict[str, Plane] = field(default_factory=dict)
    curves: dict[tuple[str, str], Curve] = field(default_factory=dict)
    marks: dict[str, list[tuple[float, str, bool]]] = field(default_factory=dict)
    numbers: dict[str, int] = field(default_factory=dict)


def digest(feed: Feed, before: Digest) -> Digest:
    """Compute the pictures of now; spectra that haven't changed and axes that still fit are taken over."""
    with feed.lock:
        epoch, spectra = feed.epoch, dict(feed.spectra)
        waveform = None if feed.waves is None or feed.waves.foreign else feed.waves.reduced()
        sections = {stage: ring.everything() for stage, ring in feed.sections.items()}
    if before.epoch != epoch:
        before = Digest()
    planes = {} if waveform is None else _planes(waveform, sections, before)
    curves = {}
    for topic, found in spectra.items():
        for stage in names.STAGES:
            known = before.curves.get((topic, stage))
            if known is None or before.numbers.get(topic) != found.number:
                known = _curve(topic, stage, found, known)
            if known is not None:
                curves[topic, stage] = known
    marks = {} if waveform is None else {stage: _marks(waveform, stage) for stage in names.STAGES}
    return Digest(epoch, planes, curves, marks, {topic: found.number for topic, found in spectra.items()})


def _planes(waveform: Waveform, sections: dict[str, Array], before: Digest) -> dict[str, Plane]:
    band = waveform.displacement
    known = {
        stage: points[(points[:, 0] >= band.time[0]) & (points[:, 0] <= band.time[-1])]
        for stage, points in sections.items()
    }
    run = RunData(
        source=Path(),
        complete=True,
        remarks=(),
        start=float(band.time[0]),
        end=float(band.time[-1]),
        topics={},
        provenance={},
        waveform=waveform,
        sections={stage: points for stage, points in known.items() if len(points)},
    )
    found = {}
    for stage in names.STAGES:
        axes = phase.axes(run, stage)
        if axes is None:
            continue
        scale = np.array([MICRO, MILLI])
        points = phase.points(run, stage)
        points[:, 1:] *= scale
        paths = {mesh: path * scale for mesh, path in phase.paths(run, stage).items()}
        last = before.planes.get(stage)
        x = settled((axes.x.start, axes.x.end), None if last is None else last.x)
        v = settled((axes.v.start, axes.v.end), None if last is None else last.v)
        found[stage] = Plane(paths, points, x, v)
    return found


def settled(wanted: tuple[float, float], before: tuple[float, float] | None) -> tuple[float, float]:
    """A range that holds what is wanted and doesn't jump about: the one before as long as it fits, with some room."""
    low, high = wanted
    fits = before is not None and before[0] <= low and high <= before[1]
    if before is not None and fits and before[1] - before[0] <= LOOSE * (high - low):
        return before
    room = 0.15 * (high - low)
    return low - room, high + room


def _curve(topic: str, stage: str, found: Spectra, before: Curve | None) -> Curve | None:
    table: Table = found.table
    axis = table.data[:, 0]
    meshes = [m for m in names.MESHES_OF_STAGE[stage] if m in table.columns]
    highest = HIGHEST[stage] if topic == names.SPECTRUM else HIGHEST_ORDER
    shown = (axis <= highest) & (axis >= 0.0)
    if not meshes or not shown.any():
        return None
    factor = -(-int(shown.sum()) // BINS)
    amplitude = {m: np.maximum(MICRO * pool(table.column(m)[shown], factor), FLOOR) for m in meshes}
    everything = np.concatenate(list(amplitude.values()))
    top = max(float(np.nanmax(everything)), 10.0 * FLOOR)
    bottom = max(FLOOR, 0.3 * float(np.nanpercentile(everything, 1.0)), 10.0**-DECADES * top)
    wanted = (float(np.log10(bottom)), float(np.log10(4.0 * top)))
    last = None if before is None else (float(np.log10(before.shown[0])), float(np.log10(before.shown[1])))
    low, high = settled(wanted, last)
    return Curve(axis[shown][::factor], amplitude, (10.0**low, 10.0**high))


def _marks(waveform: Waveform, stage: str) -> list[tuple[float, str, bool]]:
    """Mesh frequencies: of the stage itself with harmonics, and of the others; the last tells which."""
    found = []
    for other, frequency in zip(names.STAGES, waveform.mesh_frequency.mean[-1], strict=True):
        if frequency < TURNING:
            continue
        own = other == stage
        for k in range(1, HARMONICS + 1 if own else 2):
            at = float(k * frequency)
            if at <= HIGHEST[stage]:
                found.append((at, f"{k if k > 1 else ''}f_{other}", own))
    return found
