"""Envelopes over time that stay fast on an hour: coarse at first, finer where one zooms, then single samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from bokeh.models import BoxAnnotation, ColumnDataSource, CustomJS, Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.review.decimate import Band
from nw_gear_monitor.review.figures import scripts, style
from nw_gear_monitor.review.rundata import RunData, Waveform, Window

MICRO, MILLI, KILO = 1e6, 1e3, 1e-3
COARSE = 2000
"""Bins that are drawn at once."""
LONGEST = 12.0
"""Visible seconds below which single samples are shown."""


@dataclass(frozen=True)
class Zoomed:
    """A band that rebins itself: what is drawn of it, and single samples where some are known."""

    shown: ColumnDataSource
    samples: ColumnDataSource


def window_source(run: RunData, window: Window) -> ColumnDataSource:
    """Samples of a stretch: `dt` (s since its begin), displacement (µm), `v_` (mm/s), radial forces `F_` (kN)."""
    assert run.waveform is not None, "windows are cut out of it"
    table = window.samples
    time = table.column("time")
    data = {"dt": style.small(time - time[0])}
    broken = np.flatnonzero(np.diff(time) > 1.5 / run.waveform.rate)
    for mesh in names.MESHES:
        data[mesh] = style.small(MICRO * table.column(f"x_{mesh}"))
        data[f"v_{mesh}"] = style.small(MILLI * table.column(f"v_{mesh}"))
    for bearing in bearings(run.waveform):
        radial = np.hypot(table.column(f"fx_{bearing}"), table.column(f"fy_{bearing}"))
        data[f"F_{bearing}"] = style.small(KILO * radial)
    for name, values in data.items():
        if name != "dt":
            values[broken] = np.nan
    return ColumnDataSource(data)


def bearings(waveform: Waveform) -> tuple[str, ...]:
    """Bearings whose forces are in the samples."""
    return () if waveform.bearing is None else waveform.bearing.channels


def begins(run: RunData) -> list[float]:
    """When each stretch of samples begins, s since the start of the run."""
    return [float(window.samples.column("time")[0]) - run.start for window in run.windows]


def follow(
    run: RunData, band: Band, scale: float, prefix: str, windows: Sequence[ColumnDataSource], time_range: Range1d
) -> Zoomed:
    """Make a band follow the time range of the page.

    Args:
        run: the run.
        band: fine envelope.
        scale: to the unit shown.
        prefix: of the columns of its channels in the windows.
        windows: made by `window_source`.
        time_range: shared by the figures.
    """
    assert run.waveform is not None, "a band is made of it"
    gap = max(1.5 * band.width, 2.0 / run.waveform.rate)
    fine = style.band_source(band, run.start, scale, gap, mean=False)
    coarse = band.coarser(COARSE)
    shown = style.band_source(coarse, run.start, scale, max(1.5 * coarse.width, gap), mean=False)
    empty: Array = np.empty(0)
    samples = ColumnDataSource({"t": empty, **{f"{prefix}{c}": empty for c in band.channels}})
    shown.name, samples.name = f"{prefix}envelope", f"{prefix}samples"
    arguments = {
        "fine": fine,
        "shown": shown,
        "samples": samples,
        "windows": list(windows),
        "begins": begins(run),
        "range": time_range,
        "most": COARSE,
        "longest": LONGEST,
    }
    callback = CustomJS(args=arguments, code=scripts.ZOOM)
    time_range.js_on_change("start", callback)
    time_range.js_on_change("end", callback)
    return Zoomed(shown, samples)


def mark_windows(fig: figure, run: RunData) -> None:
    """Shade where single samples are on the page."""
    for begin, window in zip(begins(run), run.windows, strict=True):
        time = window.samples.column("time")
        end = begin + float(time[-1] - time[0])
        fig.add_layout(BoxAnnotation(left=begin, right=end, fill_color=style.GREY, fill_alpha=0.18, level="underlay"))
