"""Scrolling figures: wind, speed and torque; meshing displacements and bearing forces between minimum and maximum."""

from __future__ import annotations

import math

import numpy as np
from bokeh.models import ColumnDataSource, DataRange1d, Model
from bokeh.models.renderers import GlyphRenderer
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_monitor.dashboard.feed import Feed
from nw_gear_monitor.dashboard.figures.follow import Follower, fit_to, follow
from nw_gear_monitor.dashboard.waves import BINS
from nw_gear_monitor.review.figures import style

RPM = 30.0 / math.pi
ROWS = 2000
FEWEST = {"wind": 0.1, "speed": 0.02, "torque": 0.02, "displacement": 0.2, "force": 1.0}
"""Least height of the axes (m/s, r/min, MN m, µm, kN), so that a steady line is seen as one."""


def _figure(title: str, label: str, shared: DataRange1d, least: float, height: int) -> figure:
    fig = style.time_figure(title, label, shared, height=height)
    fig.y_range.default_span = least
    fig.y_range.min_interval = least
    return fig


class Operation:
    """Wind at the rotor, speed and torque of the input shaft."""

    def __init__(self, shared: DataRange1d) -> None:
        self._wind = Follower(("t", "wind"), (1.0,), ROWS)
        self._shaft = Follower(("t", "speed", "torque"), (RPM, 1e-6), ROWS)
        wind = _figure("Wind speed at the rotor", "Wind speed (m/s)", shared, FEWEST["wind"], 200)
        speed = _figure("Speed of the input shaft (ring)", "Speed (r/min)", shared, FEWEST["speed"], 200)
        torque = _figure("Torque at the input shaft (ring)", "Torque (MN m)", shared, FEWEST["torque"], 200)
        for fig, follower, name, colour in (
            (wind, self._wind, "wind", style.BLUE),
            (speed, self._shaft, "speed", style.BLUE),
            (torque, self._shaft, "torque", style.VERMILION),
        ):
            line = fig.line("t", name, source=follower.source, line_color=colour, line_width=1.5)
            style.hover(fig, [line], [("time", "@t{0.0} s"), (name, f"@{name}{{0.000}}")], "vline")
        self.roots: dict[str, Model] = {"wind": wind, "speed": speed, "torque": torque}

    def update(self, feed: Feed) -> None:
        """Send what is new."""
        with feed.lock:
            self._wind.update(feed.wind, feed.epoch, feed.origin)
            self._shaft.update(feed.operation, feed.epoch, feed.origin)


class Scrolling:
    """Thirteen channels of the waveform (as many bearings as it has), every sample between exact extremes.

    Args:
        history: seconds that are shown.
    """

    def __init__(self, history: float) -> None:
        self.shared = follow(history)
        columns = ("t", *names.MESHES, *names.BEARINGS)
        self.source = ColumnDataSource({name: np.empty(0, np.float32) for name in columns})
        self._follower: Follower | None = None
        self._channels: tuple[str, ...] = ()
        width = 1e3 * history / BINS
        self.roots: dict[str, Model] = {}
        for stage in names.STAGES:
            title = f"Stage {stage}: meshing displacement (min and max of {width:.3g} ms)"
            fig = _figure(title, "Displacement (µm)", self.shared, FEWEST["displacement"], 220)
            meshes = names.MESHES_OF_STAGE[stage]
            self._draw(fig, {m: (style.mesh_label(m), style.MESH_COLOURS[m]) for m in meshes})
            self.roots[f"displacement_{stage}"] = fig
        self._forces = _figure("Bearings: radial force (min and max)", "Force (kN)", self.shared, FEWEST["force"], 220)
        colours = zip(names.BEARINGS, style.PALETTE, strict=True)
        self._bearings = self._draw(self._forces, {b: (b, colour) for b, colour in colours})
        self._entries = dict(zip(names.BEARINGS, self._forces.legend[0].items, strict=True))
        self.roots["forces"] = self._forces

    def _draw(self, fig: figure, channels: dict[str, tuple[str, str]]) -> dict[str, GlyphRenderer]:
        lines = {
            name: fig.line("t", name, source=self.source, line_color=colour, line_width=1, name=name)
            for name, (_label, colour) in channels.items()
        }
        if len(lines) > 1:
            style.add_legend(fig, [(channels[name][0], [line]) for name, line in lines.items()])
        fit_to(self.shared, list(lines.values())[:1])
        return lines

    def update(self, feed: Feed) -> None:
        """Send what is new."""
        with feed.lock:
            waves = feed.waves
            if waves is None or waves.foreign:
                return
            if self._follower is None or waves.channels != self._channels:
                self._begin(waves.channels)
            if self._follower is not None:
                self._follower.update(waves.lines, feed.epoch, feed.origin)

    def _begin(self, channels: tuple[str, ...]) -> None:
        """Make the columns those of the waveform; bearings that aren't in it aren't drawn."""
        self._channels = channels
        scales = [1e6 if name in names.MESHES else 1e-3 for name in channels]
        self._follower = Follower(("t", *channels), scales, 2 * BINS)
        self._follower.source = self.source
        shown = [bearing for bearing in names.BEARINGS if bearing in channels]
        self._forces.renderers = [self._bearings[bearing] for bearing in shown]
        self._forces.legend[0].items = [self._entries[bearing] for bearing in shown]
