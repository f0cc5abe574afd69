"""Meshing displacements over time: the envelope of the whole run, and the last seconds sample by sample."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.rundata import TURNING, RunData, Waveform

MICRO = 1e6
CYCLES_SHOWN = 30
"""Mesh periods that the zoomed figure shows at first; the rest of the last seconds is to the left."""


def longest_gap(waveform: Waveform) -> float:
    """Seconds between bins of the envelope above which samples are missing."""
    return max(1.5 * waveform.displacement.width, 2.0 / waveform.rate)


def envelope(run: RunData, stage: str, time_range: Range1d) -> figure | None:
    """Minimum and maximum of the meshing displacements of one stage over the whole run."""
    if run.waveform is None:
        return None
    band = run.waveform.displacement.select(names.MESHES_OF_STAGE[stage])
    title = f"Stage {stage}: meshing displacement, envelope (min to max in {1e3 * band.width:.3g} ms)"
    fig = style.time_figure(title, "Displacement (µm)", time_range, height=250)
    source = style.band_source(band, run.start, MICRO, longest_gap(run.waveform))
    items = [(style.mesh_label(m), style.draw_band(fig, source, m, style.MESH_COLOURS[m])) for m in band.channels]
    if len(items) > 1:
        style.add_legend(fig, items)
    return fig


def tail_source(run: RunData) -> ColumnDataSource | None:
    """The last seconds of the meshing displacements (µm) at full rate, shared by the stages."""
    if run.waveform is None:
        return None
    tail = run.waveform.tail
    time = tail.column("time") - run.start
    data: dict[str, object] = {"t": time if time[-1] > 100.0 else style.small(time)}
    broken = np.flatnonzero(np.diff(time) > 1.5 / run.waveform.rate)
    for mesh in names.MESHES:
        x = style.small(MICRO * tail.column(f"x_{mesh}"))
        x[broken] = np.nan
        data[mesh] = x
    return ColumnDataSource(data)


def samples(run: RunData, stage: str, source: ColumnDataSource) -> figure | None:
    """The last seconds of the meshing displacements of one stage, sample by sample."""
    waveform = run.waveform
    if waveform is None:
        return None
    end = run.waveform.tail.column("time")[-1] - run.start if run.waveform else 0.0
    begin = float(source.data["t"][0])
    frequency = abs(float(waveform.mesh_frequency.mean[-1, names.STAGES.index(stage)]))
    shown = min(end - begin, CYCLES_SHOWN / frequency) if frequency > TURNING else end - begin
    meshes = names.MESHES_OF_STAGE[stage]
    visible = np.asarray(source.data["t"]) >= end - shown
    heights = np.concatenate([np.asarray(source.data[m])[visible] for m in meshes])
    span = Range1d(end - shown, end, bounds=(begin, end))
    title = (
        f"Stage {stage}: last {shown:.2g} s, every sample at {waveform.rate:.0f} Hz (pan back for {end - begin:.2g} s)"
    )
    fig = style.make_figure(title, "Time since start (s)", "Displacement (µm)", height=250, x_range=span)
    fig.y_range = style.padded(heights)
    lines = [fig.line("t", m, source=source, line_color=style.MESH_COLOURS[m], line_width=1.2) for m in meshes]
    if len(meshes) > 1:
        style.add_legend(fig, [(style.mesh_label(m), [line]) for m, line in zip(meshes, lines, strict=True)])
    style.hover(
        fig, lines[:1], [("time", "@t{0.0000} s"), *((style.mesh_label(m), f"@{m}{{0.00}} µm") for m in meshes)]
    )
    return fig
