"""Spectra over time as a map: how lines move with speed and when others appear."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt
from bokeh.models import ColorBar, FixedTicker, LinearColorMapper, Range1d
from bokeh.palettes import Viridis256
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.review.decimate import pool
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.rundata import RunData

Image = npt.NDArray[np.uint8]

MICRO = 1e6
ROWS = 220
"""About as many as the figure has pixels, so that no thin line falls between two of them."""
DECADES = 4.0
SLOW = 5.0
"""Below this frequency (Hz) is drift of the load, which doesn't set the colours."""
HIGHEST = {"I": 400.0, "II": 800.0, "III": 1600.0}


def waterfall(run: RunData, stage: str, time_range: Range1d, top: float | None = None) -> figure | None:
    """Amplitude over time and frequency, the largest of the stage's meshes, with its mesh frequency as a line.

    `top` is the largest amplitude of the colours as a power of ten (µm), by default what the run needs.
    """
    spectra, found = run.spectra, _amplitude(run, stage)
    if spectra is None or found is None:
        return None
    amplitude, highest = found
    top = largest(run, stage) if top is None else top
    image = levels(amplitude, top)
    hop = float(np.median(np.diff(spectra.times)))
    title = f"Stage {stage}: amplitude (µm) over time; dotted: mesh frequency f_{stage}"
    fig = style.time_figure(title, "Frequency (Hz)", time_range, height=290)
    fig.y_range = Range1d(0.0, highest)
    fig.grid.visible = False
    mapper = LinearColorMapper(palette=Viridis256, low=0, high=255)
    for begin, end in _stretches(spectra.times, hop):
        fig.image(
            [image[:, begin:end]],
            x=float(spectra.times[begin]) - run.start - hop,
            y=0.0,
            dw=hop * (end - begin),
            dh=highest,
            color_mapper=mapper,
        )
    fig.add_layout(colour_bar(mapper, top, DECADES), "right")
    if run.waveform is not None:
        band = run.waveform.mesh_frequency
        frequency = band.mean[:, band.channels.index(stage)]
        fig.line(style.small(band.time - run.start), style.small(frequency), line_color="white", line_dash="dotted")
    return fig


def largest(run: RunData, stage: str) -> float:
    """The power of ten (µm) above all amplitudes but the drift's; -inf where there is no map."""
    spectra, found = run.spectra, _amplitude(run, stage)
    if spectra is None or found is None:
        return -np.inf
    amplitude, highest = found
    turning = np.linspace(0.0, highest, len(amplitude)) >= SLOW
    return float(np.ceil(np.log10(max(float(amplitude[turning].max()), 1e-5))))


def _amplitude(run: RunData, stage: str) -> tuple[Array, float] | None:
    """The map of a stage (µm), frequencies by times, and its highest frequency (Hz)."""
    spectra = run.spectra
    if spectra is None or len(spectra.times) < 2:
        return None
    stages = [s for s in names.STAGES if any(names.STAGE_OF_MESH[m] == s for m in spectra.meshes)]
    if stage not in stages:
        return None
    highest = min(HIGHEST[stage], float(spectra.axis[-1]))
    shown = spectra.axis <= highest
    factor = max(1, int(shown.sum()) // ROWS)
    return MICRO * pool(spectra.waterfall[:, shown, stages.index(stage)].T.astype(np.float64), factor), highest


def levels(amplitude: Array, top: float) -> Image:
    """Amplitudes as the 256 colours of the map: logarithmic, DECADES below 10^top; a byte each on the page."""
    share = (np.log10(np.maximum(amplitude, 1e-12)) - (top - DECADES)) / DECADES
    return np.round(255.0 * np.clip(share, 0.0, 1.0)).astype(np.uint8)


def colour_bar(mapper: LinearColorMapper, top: float, decades: float) -> ColorBar:
    """The key to the colours of `levels`."""
    exponents = list(range(int(top - decades), int(top) + 1))
    places = [255.0 * (e - top + decades) / decades for e in exponents]
    return ColorBar(
        color_mapper=mapper,
        ticker=FixedTicker(ticks=places),
        major_label_overrides={place: f"{10.0**e:g}" for place, e in zip(places, exponents, strict=True)},
        width=10,
        major_label_text_font_size="10px",
    )


def _stretches(times: np.ndarray[tuple[int], np.dtype[np.float64]], hop: float) -> list[tuple[int, int]]:
    """Runs of columns without a missing message in between."""
    cuts = np.flatnonzero(np.diff(times) > 1.5 * hop) + 1
    edges = [0, *cuts.tolist(), len(times)]
    return list(pairwise(edges))
