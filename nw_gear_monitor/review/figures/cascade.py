"""Spectra over time as lines one behind the other: the 3D spectrum."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, Label, Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.review.decimate import pool
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.figures.waterfall import HIGHEST, SLOW
from nw_gear_monitor.review.rundata import RunData

MICRO = 1e6
LINES = 32
BINS = 420
DEPTH = 1.6
"""Height of the stack of lines over the height of the largest amplitude."""
LEAN = 0.12
"""How far the last line is moved to the right, as a share of the frequencies shown."""
LABELS = 5


def cascade(run: RunData, stage: str) -> figure | None:
    """Amplitude over frequency at moments spread over the run, the first in front; largest of the stage's meshes."""
    spectra = run.spectra
    if spectra is None or len(spectra.times) < 2:
        return None
    stages = [s for s in names.STAGES if any(names.STAGE_OF_MESH[m] == s for m in spectra.meshes)]
    if stage not in stages:
        return None
    highest = min(HIGHEST[stage], float(spectra.axis[-1]))
    shown = (spectra.axis <= highest) & (spectra.axis >= SLOW)
    factor = max(1, int(shown.sum()) // BINS)
    axis: Array = spectra.axis[shown][::factor]
    groups = np.array_split(np.arange(len(spectra.times)), min(LINES, len(spectra.times)))
    levels = spectra.waterfall[:, shown, stages.index(stage)].astype(np.float64)
    lines = [MICRO * pool(levels[group].max(axis=0), factor) for group in groups]
    top = max(float(np.max(lines)), 1e-6)
    title = f"Stage {stage}: 3D spectrum, amplitude (µm) over frequency, later moments behind"
    fig = style.make_figure(
        title, "Frequency of the line in front (Hz)", "Amplitude of the line in front (µm)", height=330
    )
    fig.x_range = Range1d(0.0, highest * (1.0 + LEAN) + 0.08 * highest)
    fig.y_range = Range1d(-0.04 * top, top * (1.05 + DEPTH))
    fig.ygrid.visible = False
    labelled = set(np.linspace(0, len(lines) - 1, min(LABELS, len(lines))).astype(int).tolist())
    colour = style.STAGE_COLOURS[stage]
    for i in reversed(range(len(lines))):  # the last line first: nearer ones cover it
        back = i / max(1, len(lines) - 1)
        x, base = axis + LEAN * highest * back, DEPTH * top * back
        data = {"x": style.small(x), "y": style.small(base + lines[i]), "base": np.full(len(x), base, dtype=np.float32)}
        source = ColumnDataSource(data)
        fig.varea("x", "base", "y", source=source, fill_color="white", fill_alpha=0.85)
        fig.line("x", "y", source=source, line_color=colour, line_width=1.0)
        if i in labelled:
            moment = float(spectra.times[groups[i][0]]) - run.start
            text = f"{moment:.0f} s"
            fig.add_layout(Label(x=float(x[-1]), y=base, x_offset=4, y_offset=-6, text=text, text_font_size="10px"))
    return fig
