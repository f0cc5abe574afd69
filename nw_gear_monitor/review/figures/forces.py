"""Mesh forces and bearing forces over time."""

from __future__ import annotations

from bokeh.models import Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.figures.history import longest_gap
from nw_gear_monitor.review.rundata import RunData

KILO = 1e-3
BREAK = 1.0


def mesh_force(run: RunData, stage: str, time_range: Range1d) -> figure | None:
    """Mesh forces of one stage at the view rate, positive when they drive; spread per bin and mean."""
    if run.mesh_force is None:
        return None
    band = run.mesh_force.select(names.MESHES_OF_STAGE[stage])
    fig = style.time_figure(f"Stage {stage}: mesh force (momentary values)", "Force (kN)", time_range, height=230)
    source = style.band_source(band, run.start, KILO, max(BREAK, 2.0 * band.width))
    items = [
        (style.mesh_label(m), style.draw_band(fig, source, m, style.MESH_COLOURS[m], mean=True)) for m in band.channels
    ]
    if len(items) > 1:
        style.add_legend(fig, items)
    return fig


def bearing_force(run: RunData, bearings: tuple[str, ...], title: str, time_range: Range1d) -> figure | None:
    """Radial forces of some bearings: envelope of every sample in the waveform."""
    if run.waveform is None or run.waveform.bearing is None:
        return None
    chosen = tuple(b for b in bearings if b in run.waveform.bearing.channels)
    if not chosen:
        return None
    band = run.waveform.bearing.select(chosen)
    fig = style.time_figure(f"{title}: radial force, envelope", "Force (kN)", time_range, height=250)
    source = style.band_source(band, run.start, KILO, longest_gap(run.waveform))
    items = [(b, style.draw_band(fig, source, b, colour)) for b, colour in zip(chosen, style.PALETTE, strict=False)]
    style.add_legend(fig, items)
    return fig
