"""Phase diagrams and Poincaré sections of the meshing displacements, one under the other on the same axes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from bokeh.models import ColumnDataSource, Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.rundata import TURNING, RunData, Waveform
from nw_gear_monitor.signals.hermite import interpolate

MICRO = 1e6
MILLI = 1e3
CYCLES = 20
POINTS_PER_CYCLE = 50
"""Paths are interpolated to at least so many points per mesh cycle."""
SLOW_SECONDS = 0.4
"""Length of the moving mean that is taken out, so that a changing load doesn't smear the figures."""


@dataclass(frozen=True)
class Axes:
    """Ranges of displacement (µm) and velocity (mm/s) that both figures of a stage share."""

    x: Range1d
    v: Range1d


def paths(run: RunData, stage: str) -> dict[str, Array]:
    """The last mesh cycles of every mesh of a stage: columns x (m) and v (m/s). Empty at standstill."""
    waveform = run.waveform
    if waveform is None:
        return {}
    frequency = abs(float(waveform.mesh_frequency.mean[-1, names.STAGES.index(stage)]))
    if frequency < TURNING:
        return {}
    tail = waveform.tail
    last = tail.column("time") >= tail.column("time")[-1] - CYCLES / frequency
    time = tail.column("time")[last]
    position = np.arange(0.0, len(time) - 1.0, max(0.02, min(1.0, waveform.rate / (POINTS_PER_CYCLE * frequency))))
    found = {}
    for mesh in names.MESHES_OF_STAGE[stage]:
        x = tail.column(f"x_{mesh}")[last] - slow(waveform, mesh, time)
        values = interpolate(position, x[:, None].copy(), tail.select((f"v_{mesh}",))[last].copy(), 1.0 / waveform.rate)
        found[mesh] = np.hstack(values)
    return found


def slow(waveform: Waveform, mesh: str, time: Array) -> Array:
    """What the load does to a displacement, without the vibration (m), at some times (s).

    A straight line is fitted to the bins within SLOW_SECONDS around each time; away from the ends of the run that is
    the moving mean.
    """
    band = waveform.displacement
    t, x = band.time - band.time[0], band.mean[:, band.channels.index(mesh)]
    first = np.searchsorted(t, t - 0.5 * SLOW_SECONDS)
    last = np.searchsorted(t, t + 0.5 * SLOW_SECONDS, side="right")

    def average(values: Array) -> Array:
        total = np.concatenate([[0.0], np.cumsum(values)])
        mean: Array = (total[last] - total[first]) / (last - first)
        return mean

    centre, level = average(t), average(x)
    spread = average(t * t) - centre**2
    slope = np.where(spread > 0.0, (average(t * x) - centre * level) / np.where(spread > 0.0, spread, 1.0), 0.0)
    found: Array = np.interp(time, band.time, level + slope * (t - centre))
    return found


def points(run: RunData, stage: str) -> Array:
    """Section points of a stage: planet, x about its slow mean where there is a waveform (m), v (m/s)."""
    found = run.sections.get(stage)
    if found is None:
        return np.empty((0, 3))
    moved = found[:, 1:].copy()
    for planet, mesh in enumerate(names.MESHES_OF_STAGE[stage], start=1):
        own = found[:, 1] == planet
        if run.waveform is not None and own.any():
            moved[own, 1] -= slow(run.waveform, mesh, found[own, 0])
    return moved


def axes(run: RunData, stage: str) -> Axes | None:
    """Ranges that hold the paths and the section of a stage, None where there is neither."""
    parts = list(paths(run, stage).values())
    parts.append(points(run, stage)[:, 1:])
    everything = np.concatenate(parts)
    if not len(everything):
        return None
    return Axes(style.padded(MICRO * everything[:, 0]), style.padded(MILLI * everything[:, 1]))


def _plane(title: str, shared: Axes) -> figure:
    return style.make_figure(
        title,
        "Displacement about its slow mean (µm)",
        "Velocity (mm/s)",
        height=340,
        x_range=shared.x,
        y_range=shared.v,
    )


def portrait(run: RunData, stage: str, shared: Axes | None, sources: Mapping[str, ColumnDataSource]) -> figure | None:
    """Velocity over displacement in the last mesh cycles; puts the paths of the meshes into their sources."""
    found = paths(run, stage)
    if not found or shared is None:
        return None
    fig = _plane(f"Stage {stage}: phase diagram, last {CYCLES} mesh cycles", shared)
    items = []
    for mesh, path in found.items():
        sources[mesh].data = {"x": style.small(MICRO * path[:, 0]), "v": style.small(MILLI * path[:, 1])}
        colour = style.MESH_COLOURS[mesh]
        line = fig.line("x", "v", source=sources[mesh], line_color=colour, line_width=0.9, line_alpha=0.8)
        items.append((style.mesh_label(mesh), [line]))
    style.add_legend(fig, items)
    return fig


def section(run: RunData, stage: str, shared: Axes | None, first: float) -> tuple[figure, dict[str, ColumnDataSource]]:
    """Poincaré section: (x, v) once per mesh cycle at a fixed mesh phase, coloured by planet.

    Args:
        run: the run; there are points of the stage.
        stage: I, II or III.
        shared: axes.
        first: begin of the points that are shown, s since the start of the run.

    Returns:
        The figure, and what is shown of each planet, by its number.
    """
    assert shared is not None, "there are points"
    found = points(run, stage)
    found = found[run.sections[stage][:, 0] - run.start >= first]
    title = f"Stage {stage}: Poincaré section, {first:.0f} to {run.duration:.0f} s ({len(found)} points)"
    fig = _plane(title, shared)
    items, sources = [], {}
    for planet in range(1, len(names.MESHES_OF_STAGE[stage]) + 1):
        own = found[found[:, 0] == planet]
        source = ColumnDataSource({"x": style.small(MICRO * own[:, 1]), "v": style.small(MILLI * own[:, 2])})
        colour = style.PLANET_COLOURS[planet]
        dots = fig.scatter("x", "v", source=source, size=3.5, color=colour, alpha=0.6, line_color=None)
        items.append((f"planet {planet}" if len(names.MESHES_OF_STAGE[stage]) > 1 else style.mesh_label(stage), [dots]))
        sources[str(planet)] = source
    style.add_legend(fig, items)
    return fig, sources
