"""Wavelet maps of the stretches of samples: what happens within a fraction of a second."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, LinearColorMapper, Range1d
from bokeh.palettes import Viridis256
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_common.wavelets import WaveletMap, wavelet_map
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.figures.phase import slow
from nw_gear_monitor.review.figures.waterfall import DECADES, colour_bar, levels
from nw_gear_monitor.review.rundata import TURNING, RunData, Waveform, Window

MICRO = 1e6
BELOW, ABOVE = 0.2, 8.0
"""Band of a stage's map as multiples of its lowest and highest mesh frequency."""
LOWEST = 2.0
HIGHEST_SHARE = 0.45
"""Of the sample rate."""
LEAST = 64
"""Samples below which there is no map."""


@dataclass(frozen=True)
class Map:
    """The wavelet map of one stage.

    Attributes:
        figure: shows the last stretch at first.
        source: of the image.
        images: one of each stretch.
        low, high: frequencies (Hz) of the lower and the upper edge.
    """

    figure: figure
    source: ColumnDataSource
    images: list[np.ndarray[Any, np.dtype[np.uint8]]]
    low: float
    high: float

    def arguments(self) -> dict[str, Any]:
        """What the page needs to show another stretch."""
        span = self.high - self.low
        holder = ColumnDataSource({str(i): [image] for i, image in enumerate(self.images)})
        return {"source": self.source, "holder": holder, "y": self.low, "dh": span, "range": self.figure.x_range}


def maps(run: RunData, begins: list[float]) -> list[Map]:
    """Maps of all stages; empty where a stage stood still all the time, or a stretch is too short."""
    if run.waveform is None or any(len(window.samples) < LEAST for window in run.windows):
        return []
    found = [_map(run, stage, begins) for stage in names.STAGES]
    return [one for one in found if one is not None] if all(found) else []


def _map(run: RunData, stage: str, begins: list[float]) -> Map | None:
    assert run.waveform is not None, "looked at before"
    turning = np.abs(run.waveform.mesh_frequency.select((stage,)).mean)
    turning = turning[turning > TURNING]
    if not turning.size:
        return None
    rate = run.waveform.rate
    low, high = max(LOWEST, BELOW * float(turning.min())), min(ABOVE * float(turning.max()), HIGHEST_SHARE * rate)
    if low >= high:
        return None
    mesh = names.MESHES_OF_STAGE[stage][0]
    found = [_transform(run.waveform, window, mesh, low, high) for window in run.windows]
    top = float(np.ceil(np.log10(max(float(m.amplitude.max()) for m in found) * MICRO + 1e-12)))
    images = [levels(MICRO * m.amplitude, top) for m in found]
    time = run.windows[-1].samples.column("time")
    length = float(time[-1] - time[0])
    title = f"Stage {stage}, {style.mesh_label(mesh)}: wavelet map, amplitude (µm)"
    span = Range1d(begins[-1], begins[-1] + length, bounds=(begins[-1], begins[-1] + length))
    fig = style.make_figure(title, "Time since start (s)", "Frequency (Hz)", height=250, x_range=span, y_type="log")
    fig.y_range = Range1d(low, high, bounds=(low, high))
    fig.grid.visible = False
    place = {"x": [begins[-1]], "y": [low], "dw": [length], "dh": [high - low]}
    source = ColumnDataSource({"image": [images[-1]], **place})
    mapper = LinearColorMapper(palette=Viridis256, low=0, high=255)
    fig.image("image", x="x", y="y", dw="dw", dh="dh", source=source, color_mapper=mapper)
    fig.add_layout(colour_bar(mapper, top, DECADES), "right")
    return Map(fig, source, images, low, high)


def _transform(waveform: Waveform, window: Window, mesh: str, low: float, high: float) -> WaveletMap:
    time = window.samples.column("time")
    return wavelet_map(
        window.samples.column(f"x_{mesh}") - slow(waveform, mesh, time), waveform.rate, low=low, high=high
    )
