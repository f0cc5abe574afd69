"""Wind and load over time: wind speed, shaft speed, torque and power."""

from __future__ import annotations

import math

import numpy as np
from bokeh.models import ColumnDataSource, Range1d
from bokeh.models.renderers import GlyphRenderer
from bokeh.plotting import figure

from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.measured import Measured
from nw_gear_monitor.review.rundata import RunData

RPM = 30.0 / math.pi
BREAK = 1.0
"""Seconds without a message after which a line is broken."""


def wind(run: RunData, time_range: Range1d, measured: Measured | None = None) -> figure | None:
    """Wind speed: what was published and drove the rotor, with the measured record that it was drawn around."""
    if run.wind is None:
        return None
    fig = style.time_figure("Wind speed at the rotor", "Wind speed (m/s)", time_range)
    source = style.band_source(run.wind, run.start, 1.0, max(BREAK, 2.0 * run.wind.width))
    used = fig.line("t", "mean_wind", source=source, line_color=style.BLUE, line_width=1.5)
    style.hover(fig, [used], [("time", "@t{0.0} s"), ("wind", "@mean_wind{0.00} m/s")], "vline")
    if measured is not None:
        style.add_legend(fig, [("drawn, published and used", [used]), *_measured(fig, measured, run.duration)])
    return fig


def _measured(fig: figure, measured: Measured, duration: float) -> list[tuple[str, list[GlyphRenderer]]]:
    """Rows of the file that fall into the run; means hold over their interval, with a band of a standard deviation."""
    begin = max(0, int(np.searchsorted(measured.times, 0.0, side="right")) - 1)
    rows = slice(begin, int(np.searchsorted(measured.times, duration, side="right")) + 1)
    times, speeds = measured.times[rows], measured.speeds[rows]
    if measured.deviations is None:
        return [("measured", [fig.scatter(times, speeds, size=6, color=style.VERMILION)])]
    deviations = measured.deviations[rows]
    ends = np.append(times[1:], times[-1] + measured.interval)
    band = fig.quad(
        left=times,
        right=ends,
        bottom=speeds - deviations,
        top=speeds + deviations,
        color=style.VERMILION,
        alpha=0.15,
        line_color=None,
    )
    mean = fig.segment(times, speeds, ends, speeds, line_color=style.VERMILION, line_width=2)
    return [("measured mean", [mean]), ("measured standard deviation", [band])]


def speed(run: RunData, time_range: Range1d) -> figure | None:
    """Speed of the input shaft."""
    if run.speed is None:
        return None
    fig = style.time_figure("Speed of the input shaft (ring)", "Speed (r/min)", time_range, height=210)
    source = style.band_source(run.speed.select(("ring",)), run.start, RPM, max(BREAK, 2.0 * run.speed.width))
    line = style.draw_band(fig, source, "ring", style.BLUE, mean=True)[-1]
    style.level(fig, source.data["mean_ring"])
    style.hover(fig, [line], [("time", "@t{0.0} s"), ("speed", "@mean_ring{0.00} r/min")], "vline")
    return fig


def torque(run: RunData, time_range: Range1d) -> figure | None:
    """Torque at the input shaft."""
    if run.torque is None:
        return None
    fig = style.time_figure("Torque at the input shaft (ring)", "Torque (MN m)", time_range, height=210)
    source = style.band_source(run.torque.select(("ring",)), run.start, 1e-6, max(BREAK, 2.0 * run.torque.width))
    line = style.draw_band(fig, source, "ring", style.VERMILION, mean=True)[-1]
    style.level(fig, source.data["mean_ring"])
    style.hover(fig, [line], [("time", "@t{0.0} s"), ("torque", "@mean_ring{0.000} MN m")], "vline")
    return fig


def power(run: RunData, time_range: Range1d) -> figure | None:
    """Power into the gearbox, torque times speed of the input shaft."""
    if run.torque is None or run.speed is None or len(run.torque.time) != len(run.speed.time):
        return None
    fig = style.time_figure("Power at the input shaft", "Power (MW)", time_range, height=210)
    values = run.torque.select(("ring",)).mean[:, 0] * run.speed.select(("ring",)).mean[:, 0]
    source = ColumnDataSource({"t": style.small(run.speed.time - run.start), "p": style.small(1e-6 * values)})
    line = fig.line("t", "p", source=source, line_color=style.GREEN, line_width=1.5)
    style.level(fig, source.data["p"])
    style.hover(fig, [line], [("time", "@t{0.0} s"), ("power", "@p{0.000} MW")], "vline")
    return fig


def mesh_frequency(run: RunData, time_range: Range1d) -> figure | None:
    """Mesh frequencies of the three stages, from the phases in the waveform."""
    if run.waveform is None:
        return None
    band = run.waveform.mesh_frequency
    fig = style.time_figure("Mesh frequencies", "Frequency (Hz)", time_range, height=230)
    source = style.band_source(band, run.start, 1.0, max(BREAK, 2.0 * band.width))
    lines = [
        (s, fig.line("t", f"mean_{s}", source=source, line_color=style.STAGE_COLOURS[s], line_width=1.5))
        for s in band.channels
    ]
    style.add_legend(fig, [(f"stage {stage}", [line]) for stage, line in lines])
    for stage, line in lines:
        style.hover(fig, [line], [("stage", stage), ("time", "@t{0.0} s"), ("frequency", f"@mean_{stage}{{0.00}} Hz")])
    return fig
