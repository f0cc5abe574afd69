"""Amplitude spectra and order spectra of the meshing displacements, with the lines that a gearbox must have marked."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, Label, Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_monitor.review.decimate import pool
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.rundata import TURNING, RunData, Spectra

MICRO = 1e6
FLOOR = 1e-6
"""Smallest amplitude drawn on the logarithmic axis (µm)."""
DECADES = 5
FRAME_HEIGHT = 220
HARMONICS = 5
HIGHEST = {"I": 400.0, "II": 1000.0, "III": 2000.0}
"""Frequency up to which a stage's spectrum is shown at first (Hz)."""
HIGHEST_ORDER = 8.0
BINS = 6000


def _y_range(amplitude: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Range1d:
    top = max(float(np.nanmax(amplitude, initial=0.0)), 10.0 * FLOOR)
    bottom = max(FLOOR, 0.3 * float(np.nanpercentile(np.maximum(amplitude, FLOOR), 1.0)), 10.0**-DECADES * top)
    return Range1d(bottom, 4.0 * top)


def _curves(fig: figure, spectra: Spectra, stage: str, highest: float, unit: str) -> None:
    shown = spectra.axis <= highest
    factor = -(-int(shown.sum()) // BINS)
    axis = spectra.axis[shown][::factor]
    meshes = tuple(m for m in names.MESHES_OF_STAGE[stage] if m in spectra.meshes)
    data = {"axis": style.small(axis)}
    for mesh in meshes:
        column = spectra.meshes.index(mesh)
        for kind, values in (("last", spectra.last), ("mean", spectra.mean)):
            data[f"{kind}_{mesh}"] = style.small(np.maximum(MICRO * pool(values[shown, column], factor), FLOOR))
    fig.y_range = _y_range(np.concatenate([data[f"last_{m}"] for m in meshes]))
    source = ColumnDataSource(data)
    items = []
    if spectra.count > 1:
        mean = fig.line("axis", f"mean_{meshes[0]}", source=source, line_color=style.GREY, line_width=1, line_alpha=0.7)
        items.append((f"mean of the run ({style.mesh_label(meshes[0])})", [mean]))
    lines = [
        fig.line("axis", f"last_{m}", source=source, line_color=style.MESH_COLOURS[m], line_width=1.1) for m in meshes
    ]
    items += [(f"{style.mesh_label(m)}, at the end", [line]) for m, line in zip(meshes, lines, strict=True)]
    style.add_legend(fig, items)
    pattern = "@axis{0.00}"
    style.hover(fig, lines[:1], [(unit, pattern), *((style.mesh_label(m), f"@last_{m}{{0.0000}} µm") for m in meshes)])


def _mark_lines(fig: figure, positions: list[tuple[float, str]], colour: str, highest: float, row: int) -> None:
    """Dashed lines with names at the top of the figure; `row` keeps the names of different families apart."""
    for at, text in positions:
        if at > highest:
            continue
        style.mark(fig, at, colour=colour, dash="dotted")
        fig.add_layout(
            Label(
                x=at,
                y=FRAME_HEIGHT,
                y_units="screen",
                text=text,
                text_font_size="10px",
                text_color=colour,
                x_offset=3,
                y_offset=-12 * row,
                text_baseline="top",
            )
        )


def amplitude(run: RunData, stage: str) -> figure | None:
    """Amplitude spectrum of one stage at the end of the run and its mean, with the mesh frequencies of all stages."""
    if run.spectra is None:
        return None
    highest = float(run.spectra.axis[-1])
    title = f"Stage {stage}: amplitude spectrum"
    shown = Range1d(0.0, min(HIGHEST[stage], highest), bounds=(0.0, highest))
    fig = style.make_figure(title, "Frequency (Hz)", "Amplitude (µm)", height=300, x_range=shown, y_type="log")
    fig.frame_height = FRAME_HEIGHT
    _curves(fig, run.spectra, stage, highest, "frequency (Hz)")
    if run.waveform is not None:
        now = run.waveform.mesh_frequency.mean[-1]
        rows = iter((2, 3))
        for other, frequency in zip(names.STAGES, now, strict=True):
            if abs(frequency) < TURNING:
                continue
            own = other == stage
            lines = [
                (float(k * abs(frequency)), f"{k if k > 1 else ''}f_{other}")
                for k in range(1, HARMONICS + 1 if own else 2)
            ]
            _mark_lines(fig, lines, style.INK if own else style.SKY, highest, 1 if own else next(rows))
    return fig


def orders(run: RunData, stage: str) -> figure | None:
    """Order spectrum of one stage: over multiples of its mesh frequency, not smeared by changes of speed."""
    if run.orders is None:
        return None
    highest = min(HIGHEST_ORDER, float(run.orders.axis[-1]))
    fig = style.make_figure(
        f"Stage {stage}: order spectrum",
        f"Order (multiples of f_{stage})",
        "Amplitude (µm)",
        height=300,
        x_range=Range1d(0.0, highest),
        y_type="log",
    )
    fig.frame_height = FRAME_HEIGHT
    _curves(fig, run.orders, stage, highest, "order")
    _mark_lines(fig, [(float(k), str(k)) for k in range(1, int(highest) + 1)], style.INK, highest, 1)
    _mark_lines(fig, [(0.5, "1/2")], style.PINK, highest, 2)
    return fig
