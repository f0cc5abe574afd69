"""Phase diagram and Poincaré map of each stage on the same axes."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, Model, Range1d
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_monitor.dashboard.digest import Digest, Plane
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.figures.phase import CYCLES


class PlaneFigures:
    """Both pictures of one stage."""

    def __init__(self, stage: str) -> None:
        self._stage = stage
        self._meshes = names.MESHES_OF_STAGE[stage]
        self._x, self._v = Range1d(-1.0, 1.0), Range1d(-1.0, 1.0)
        self._paths = {m: _empty() for m in self._meshes}
        self._points = {m: _empty() for m in self._meshes}
        self._shown: Plane | None = None
        self.phase = self._plane(f"Stage {stage}: phase diagram, last {CYCLES} mesh cycles")
        self.section = self._plane(f"Stage {stage}: Poincaré map, once per mesh cycle")
        lines, dots = [], []
        for mesh in self._meshes:
            colour = style.MESH_COLOURS[mesh]
            path, points = self._paths[mesh], self._points[mesh]
            line = self.phase.line("x", "v", source=path, line_color=colour, line_width=0.9, line_alpha=0.8)
            scatter = self.section.scatter("x", "v", source=points, size=3.5, color=colour, alpha=0.6, line_color=None)
            lines.append((style.mesh_label(mesh), [line]))
            dots.append((style.mesh_label(mesh), [scatter]))
        if len(self._meshes) > 1:
            style.add_legend(self.phase, lines)
            style.add_legend(self.section, dots)

    def _plane(self, title: str) -> figure:
        labels = ("Displacement about its slow mean (µm)", "Velocity (mm/s)")
        return style.make_figure(title, *labels, height=320, x_range=self._x, y_range=self._v)

    def update(self, digest: Digest) -> None:
        """Show the newest plane, or nothing where there is none."""
        plane = digest.planes.get(self._stage)
        if plane is self._shown:
            return
        self._shown = plane
        for place, mesh in enumerate(self._meshes, start=1):
            path = None if plane is None else plane.paths.get(mesh)
            points = None if plane is None else plane.points[plane.points[:, 0] == place, 1:]
            for source, rows in ((self._paths[mesh], path), (self._points[mesh], points)):
                found = np.empty((0, 2)) if rows is None else rows
                if len(found) or len(source.data["x"]):
                    source.data = {"x": style.small(found[:, 0]), "v": style.small(found[:, 1])}
        if plane is not None and (self._x.start, self._x.end) != plane.x:
            self._x.update(start=plane.x[0], end=plane.x[1])
        if plane is not None and (self._v.start, self._v.end) != plane.v:
            self._v.update(start=plane.v[0], end=plane.v[1])


def _empty() -> ColumnDataSource:
    return ColumnDataSource({"x": np.empty(0, np.float32), "v": np.empty(0, np.float32)})


class PlanesPanel:
    """Phase diagrams and Poincaré maps of all stages."""

    def __init__(self) -> None:
        self._figures = {stage: PlaneFigures(stage) for stage in names.STAGES}
        self.roots: dict[str, Model] = {f"phase_{stage}": f.phase for stage, f in self._figures.items()}
        self.roots |= {f"section_{stage}": f.section for stage, f in self._figures.items()}

    def update(self, digest: Digest) -> None:
        """Show what is new."""
        for fig in self._figures.values():
            fig.update(digest)
