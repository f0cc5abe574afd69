"""Phase diagrams and Poincaré sections of the meshing displacements, one under the other on the same axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from bokeh.models import Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.rundata import RunData

MICRO = 1e6
MILLI = 1e3
CYCLES = 20
MARGIN = 0.08
LEAST_ROOM = 1e-3


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
    if frequency == 0.0:
        return {}
    tail = waveform.tail
    last = tail.column("time") >= tail.column("time")[-1] - CYCLES / frequency
    return {m: tail.select((f"x_{m}", f"v_{m}"))[last] for m in names.MESHES_OF_STAGE[stage]}


def axes(run: RunData, stage: str) -> Axes | None:
    """Ranges that hold the paths and the section of a stage, None where there is neither."""
    parts = list(paths(run, stage).values())
    if stage in run.sections:
        parts.append(run.sections[stage][:, 2:4])
    points = np.concatenate(parts) if parts else np.empty((0, 2))
    if not len(points):
        return None
    return Axes(_range(MICRO * points[:, 0]), _range(MILLI * points[:, 1]))


def _range(values: Array) -> Range1d:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = max(MARGIN * (high - low), LEAST_ROOM)
    return Range1d(low - room, high + room)


def _plane(title: str, shared: Axes) -> figure:
    return style.make_figure(
        title, "Displacement (µm)", "Velocity (mm/s)", height=340, x_range=shared.x, y_range=shared.v
    )


def portrait(run: RunData, stage: str, shared: Axes | None) -> figure | None:
    """Velocity over displacement in the last mesh cycles."""
    found = paths(run, stage)
    if not found or shared is None:
        return None
    fig = _plane(f"Stage {stage}: phase diagram, last {CYCLES} mesh cycles", shared)
    items = []
    for mesh, path in found.items():
        x, v = style.small(MICRO * path[:, 0]), style.small(MILLI * path[:, 1])
        line = fig.line(x, v, line_color=style.MESH_COLOURS[mesh], line_width=0.9, line_alpha=0.8)
        items.append((style.mesh_label(mesh), [line]))
    style.add_legend(fig, items)
    return fig


def section(run: RunData, stage: str, shared: Axes | None) -> figure | None:
    """Poincaré section: (x, v) once per mesh cycle at a fixed mesh phase, the last seconds, coloured by planet."""
    points = run.sections.get(stage)
    if points is None or shared is None:
        return None
    seconds = points[-1, 0] - points[0, 0]
    fig = _plane(f"Stage {stage}: Poincaré section, last {seconds:.0f} s ({len(points)} points)", shared)
    items = []
    for planet in np.unique(points[:, 1]).astype(int).tolist():
        own = points[points[:, 1] == planet]
        x, v = style.small(MICRO * own[:, 2]), style.small(MILLI * own[:, 3])
        colour = style.PLANET_COLOURS.get(planet, style.BLUE)
        dots = fig.scatter(x, v, size=3.5, color=colour, alpha=0.6, line_color=None)
        items.append((f"planet {planet}" if len(names.MESHES_OF_STAGE[stage]) > 1 else style.mesh_label(stage), [dots]))
    style.add_legend(fig, items)
    return fig
