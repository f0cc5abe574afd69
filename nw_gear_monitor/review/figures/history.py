"""Meshing displacements over time: the envelope of the whole run, and stretches of it sample by sample."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.figures.zoom import Zoomed, mark_windows
from nw_gear_monitor.review.rundata import TURNING, RunData, Window

CYCLES_SHOWN = 30
"""Mesh periods that the figure of samples shows at first; the rest of the stretch is to the left."""


def envelope(run: RunData, stage: str, time_range: Range1d, zoomed: Zoomed) -> figure:
    """Minimum and maximum of the meshing displacements of one stage; where one zooms in, its samples."""
    assert run.waveform is not None, "only called where there is a waveform"
    meshes = names.MESHES_OF_STAGE[stage]
    fig = style.time_figure(
        f"Stage {stage}: meshing displacement, least to largest", "Displacement (µm)", time_range, height=250
    )
    items = []
    for mesh in meshes:
        colour = style.MESH_COLOURS[mesh]
        line = fig.line("t", mesh, source=zoomed.samples, line_color=colour, line_width=1.2)
        items.append((style.mesh_label(mesh), [*style.draw_band(fig, zoomed.shown, mesh, colour), line]))
    mark_windows(fig, run)
    if len(items) > 1:
        style.add_legend(fig, items)
    return fig


def samples_source(run: RunData, window: ColumnDataSource, begin: float) -> ColumnDataSource:
    """The stretch that is chosen at first, with time since the start of the run; shared by the stages."""
    data = {"t": begin + np.asarray(window.data["dt"], dtype=np.float64)}
    columns = [*names.MESHES, *(c for c in window.data if c.startswith("F_"))]
    return ColumnDataSource({**data, **{c: window.data[c] for c in columns}})


def mesh_frequency(window: Window, stage: str) -> float:
    """Mean mesh frequency in a stretch (Hz), from the turned phase."""
    time, phase = window.samples.column("time"), window.samples.column(f"phase_{stage}")
    return abs(float(phase[-1] - phase[0])) / (2.0 * np.pi * float(time[-1] - time[0]))


def samples(run: RunData, stage: str, source: ColumnDataSource, window: Window) -> figure:
    """Meshing displacements of one stage in the chosen stretch, sample by sample."""
    time = np.asarray(source.data["t"])
    begin, end = float(time[0]), float(time[-1])
    frequency = mesh_frequency(window, stage)
    shown = min(end - begin, CYCLES_SHOWN / frequency) if frequency > TURNING else end - begin
    meshes = names.MESHES_OF_STAGE[stage]
    visible = time >= end - shown
    heights = np.concatenate([np.asarray(source.data[m])[visible] for m in meshes])
    span = Range1d(end - shown, end, bounds=(begin, end))
    title = f"Stage {stage}: every sample (pan back for more)"
    fig = style.make_figure(title, "Time since start (s)", "Displacement (µm)", height=250, x_range=span)
    fig.y_range = style.padded(heights)
    lines = [fig.line("t", m, source=source, line_color=style.MESH_COLOURS[m], line_width=1.2) for m in meshes]
    if len(meshes) > 1:
        style.add_legend(fig, [(style.mesh_label(m), [line]) for m, line in zip(meshes, lines, strict=True)])
    style.hover(
        fig, lines[:1], [("time", "@t{0.0000} s"), *((style.mesh_label(m), f"@{m}{{0.00}} µm") for m in meshes)]
    )
    return fig
