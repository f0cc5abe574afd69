"""Mesh forces and bearing forces over time."""

from __future__ import annotations

from bokeh.models import Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.figures.zoom import Zoomed, mark_windows
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


def bearing_force(
    run: RunData, bearings: tuple[str, ...], title: str, time_range: Range1d, zoomed: Zoomed | None
) -> figure | None:
    """Radial forces of some bearings: envelope of every sample in the waveform; where one zooms in, the samples."""
    if run.waveform is None or run.waveform.bearing is None or zoomed is None:
        return None
    chosen = tuple(b for b in bearings if b in run.waveform.bearing.channels)
    if not chosen:
        return None
    fig = style.time_figure(f"{title}: radial force, least to largest", "Force (kN)", time_range, height=250)
    items = []
    for bearing, colour in zip(chosen, style.PALETTE, strict=False):
        line = fig.line("t", f"F_{bearing}", source=zoomed.samples, line_color=colour, line_width=1.2)
        items.append((bearing, [*style.draw_band(fig, zoomed.shown, bearing, colour), line]))
    mark_windows(fig, run)
    style.add_legend(fig, items)
    return fig
