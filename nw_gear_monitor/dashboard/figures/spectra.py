"""Amplitude spectrum and order spectrum of each stage, with its mesh frequency where it is now."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, LinearScale, Model, Range1d

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_monitor.dashboard.digest import Curve, Digest
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.figures.spectra import HIGHEST, HIGHEST_ORDER

ROWS = {True: 0.97, False: 0.89}
"""Height at which names of the stage's own mesh frequencies and of others stand, as a share of the figure."""


class SpectrumFigure:
    """One spectrum of one stage.

    Args:
        topic: `spectrum` or `orders`.
        stage: I, II or III.
    """

    def __init__(self, topic: str, stage: str) -> None:
        self._key, self._stage = (topic, stage), stage
        self._number: tuple[int, int] = (-1, -1)
        self._marked: list[tuple[float, str, bool]] = []
        meshes = names.MESHES_OF_STAGE[stage]
        self._curve = ColumnDataSource({name: np.empty(0, np.float32) for name in ("axis", *meshes)})
        self._lines = ColumnDataSource({"x": [], "text": [], "colour": [], "y": []})
        by_order = topic == names.ORDERS
        title = f"Stage {stage}: {'order' if by_order else 'amplitude'} spectrum"
        label = f"Order (multiples of f_{stage})" if by_order else "Frequency (Hz)"
        shown = Range1d(0.0, HIGHEST_ORDER if by_order else HIGHEST[stage])
        self.figure = style.make_figure(title, label, "Amplitude (µm)", height=260, x_range=shown, y_type="log")
        self.figure.y_range = Range1d(1e-5, 10.0)
        self._draw(meshes)
        if by_order:
            marks = [(float(k), str(k), True) for k in range(1, int(HIGHEST_ORDER) + 1)]
            self._mark([*marks, (0.5, "1/2", False)])

    def _draw(self, meshes: tuple[str, ...]) -> None:
        fig = self.figure
        fig.extra_y_ranges = {"share": Range1d(0.0, 1.0)}
        fig.extra_y_scales = {"share": LinearScale()}
        fig.vspan(x="x", source=self._lines, line_color="colour", line_dash="dotted", line_width=1, line_alpha=0.6)
        fig.text(
            x="x",
            y="y",
            text="text",
            source=self._lines,
            y_range_name="share",
            text_color="colour",
            text_font_size="10px",
            text_baseline="top",
            x_offset=3,
        )
        lines = [
            fig.line("axis", m, source=self._curve, line_color=style.MESH_COLOURS[m], line_width=1.1) for m in meshes
        ]
        if len(lines) > 1:
            style.add_legend(fig, [(style.mesh_label(m), [line]) for m, line in zip(meshes, lines, strict=True)])
        tips = [("at", "@axis{0.00}"), *((style.mesh_label(m), f"@{m}{{0.0000}} µm") for m in meshes)]
        style.hover(fig, lines[:1], tips)

    def update(self, digest: Digest) -> None:
        """Show the newest spectrum, and where the mesh frequency is now."""
        curve = digest.curves.get(self._key)
        number = (digest.epoch, digest.numbers.get(self._key[0], -1))
        if number != self._number:
            self._number = number
            self._show(curve)
        marks = digest.marks.get(self._stage, [])
        if self._key[0] == names.SPECTRUM and marks != self._marked:
            self._marked = marks
            self._mark(marks)

    def _show(self, curve: Curve | None) -> None:
        meshes = names.MESHES_OF_STAGE[self._stage]
        empty: Array = np.empty(0)
        axis = empty if curve is None else curve.axis
        data = {"axis": style.small(axis)}
        for mesh in meshes:
            found = None if curve is None else curve.amplitude.get(mesh)
            data[mesh] = style.small(np.full(len(axis), np.nan) if found is None else found)
        self._curve.data = data
        if curve is not None and (self.figure.y_range.start, self.figure.y_range.end) != curve.shown:
            self.figure.y_range.update(start=curve.shown[0], end=curve.shown[1])

    def _mark(self, marks: list[tuple[float, str, bool]]) -> None:
        self._lines.data = {
            "x": [at for at, _text, _own in marks],
            "text": [text for _at, text, _own in marks],
            "colour": [style.INK if own else style.SKY for _at, _text, own in marks],
            "y": [ROWS[own] for _at, _text, own in marks],
        }


class SpectraPanel:
    """Both spectra of every stage."""

    def __init__(self) -> None:
        self._figures = {
            (topic, stage): SpectrumFigure(topic, stage)
            for topic in (names.SPECTRUM, names.ORDERS)
            for stage in names.STAGES
        }
        self.roots: dict[str, Model] = {f"{topic}_{stage}": f.figure for (topic, stage), f in self._figures.items()}

    def update(self, digest: Digest) -> None:
        """Show what is new."""
        for fig in self._figures.values():
            fig.update(digest)
