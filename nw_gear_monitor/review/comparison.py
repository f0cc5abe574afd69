"""Two runs side by side: the same figures on the same axes, and tables of what differs."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from bokeh.models import DataRange1d, Model, Range1d
from bokeh.plotting import figure

import nw_gear_common
from nw_gear_common import names
from nw_gear_monitor.review import compared, page, sections, summary
from nw_gear_monitor.review.figures import (
    chooser,
    forces,
    history,
    indicators,
    operation,
    phase,
    spectra,
    states,
    waterfall,
    zoom,
)
from nw_gear_monitor.review.rundata import RunData
from nw_gear_monitor.review.sections import Section

Labels = tuple[str, str]
Draw = Callable[[RunData], figure | None]
MISSING = "Neither run has this."
INDICATORS = 8
"""Indicators that are drawn side by side."""


def render(first: RunData, second: RunData, labels: Labels) -> str:
    """The comparison of two runs as one HTML text that loads nothing from elsewhere.

    Args:
        first, second: the runs; the first stands on the left.
        labels: what they are called; the same name twice gets numbers.
    """
    if labels[0] == labels[1]:
        labels = (f"{labels[0]} (1)", f"{labels[1]} (2)")
    runs = (first, second)
    numbers = tuple(summary.summarise(run) for run in runs)
    heads = [page.headline(run, found) for run, found in zip(runs, numbers, strict=True)]
    head = page.Head(
        title=f"{labels[0]} beside {labels[1]}",
        subtitle=f"{labels[0]}: {first.duration:.1f} s; {labels[1]}: {second.duration:.1f} s",
        headlines=[(colour, f"{label}: {words}") for label, (colour, words) in zip(labels, heads, strict=True)],
        remarks=[f"{label}: {words}" for label, run in zip(labels, runs, strict=True) for words in run.remarks],
        facts=[],
        footer=f"Made by nw_gear {nw_gear_common.__version__} from {first.source} and {second.source}.",
    )
    return page.assemble(head, build(runs, labels))


def build(runs: tuple[RunData, RunData], labels: Labels) -> list[Section]:
    """All sections of the comparison, in order."""
    longest = max(0.0, *(run.duration for run in runs)) or 1.0
    time_range = Range1d(0.0, longest, bounds=(-0.02 * longest, 1.02 * longest), name="time")
    beside = _Beside(runs, labels)
    return [
        _summary(runs, labels),
        _operation(beside, time_range),
        _states(beside, time_range),
        _displacement(beside, time_range),
        _forces(beside, time_range),
        _spectra(beside),
        _waterfall(beside, time_range),
        _phase(beside),
        _indicators(beside, time_range),
        _alarms(runs, labels),
    ]


class _Beside:
    """Draws figures of two runs in pairs."""

    def __init__(self, runs: tuple[RunData, RunData], labels: Labels) -> None:
        self.runs = runs
        self.labels = labels

    def pair(self, section: Section, draw: Draw, otherwise: str = MISSING) -> None:
        """Draw a figure of both runs on the same axes, with the run's name before its title."""
        self.drawn(section, [draw(run) for run in self.runs], otherwise)

    def drawn(self, section: Section, figures: Sequence[figure | None], otherwise: str = MISSING) -> None:
        """Put figures of the two runs side by side; where one has none, say so."""
        for fig, label in zip(figures, self.labels, strict=True):
            if fig is not None:
                fig.title.text = f"{label} · {fig.title.text}"
            elif any(figures):
                words = f"{label} has nothing to set beside some of the figures."
                section.missing += [words] if words not in section.missing else []
        both = [fig for fig in figures if fig is not None]
        if len(both) > 1:
            share(both)
        section.add(2, both, otherwise)


def share(figures: Sequence[figure]) -> None:
    """Give figures the same axes: each spans what any of them needs, and follows when one is zoomed."""
    first = figures[0]
    for axis in ("x_range", "y_range"):
        ranges = [getattr(fig, axis) for fig in figures]
        if all(isinstance(r, Range1d) for r in ranges):
            start, end = min(r.start for r in ranges), max(r.end for r in ranges)
            if ranges[0] not in ranges[1:]:
                bounds = ranges[0].bounds
                wide = bounds if not isinstance(bounds, tuple) else _widest([r.bounds for r in ranges])
                ranges[0].update(start=start, end=end, bounds=wide)
        elif not all(isinstance(r, DataRange1d) for r in ranges):
            continue
        for fig in figures[1:]:
            setattr(fig, axis, getattr(first, axis))


def _widest(bounds: Sequence[tuple[float, float]]) -> tuple[float, float]:
    return min(low for low, _ in bounds), max(high for _, high in bounds)


def _summary(runs: tuple[RunData, RunData], labels: Labels) -> Section:
    tables = [compared.facts(runs, labels), compared.stages(runs, labels), compared.indicators(runs, labels)]
    return Section("summary", "Summary", tables=[table for table in tables if table.rows])


def _operation(beside: _Beside, time_range: Range1d) -> Section:
    section = Section("wind-and-load", "Wind and load", "Both runs have the same axes: zoom one and all follow.")
    for draw in (operation.wind, operation.speed, operation.torque, operation.mesh_frequency):
        beside.pair(section, lambda run, draw=draw: draw(run, time_range))  # type: ignore[misc]
    return section


def _states(beside: _Beside, time_range: Range1d) -> Section:
    section = Section("states", "States over time", "What the monitor called each stage.")
    figures = [states.stages(run, time_range) for run in beside.runs]
    for fig, label in zip(figures, beside.labels, strict=True):
        if fig is not None:
            fig.title.text = f"{label} · {fig.title.text}"
    section.add(2, figures, sections.NO_MONITOR)
    return section


def _displacement(beside: _Beside, time_range: Range1d) -> Section:
    text = "Least and largest value of all samples; zoom in for finer figures and, in the shaded stretches, samples."
    section = Section("displacement", "Meshing displacement", text)
    zoomed = []
    for run in beside.runs:
        windows = [zoom.window_source(run, window) for window in run.windows]
        band = None if run.waveform is None else run.waveform.displacement
        zoomed.append(None if band is None else zoom.follow(run, band, zoom.MICRO, "", windows, time_range))
    for stage in names.STAGES:
        figures = [
            None if own is None else history.envelope(run, stage, time_range, own)
            for run, own in zip(beside.runs, zoomed, strict=True)
        ]
        beside.drawn(section, figures, "The waveform was not recorded.")
    return section


def _forces(beside: _Beside, time_range: Range1d) -> Section:
    section = Section("forces", "Mesh forces", "Momentary values from the view topic: spread and mean.")
    for stage in names.STAGES:
        beside.pair(section, lambda run, stage=stage: forces.mesh_force(run, stage, time_range))  # type: ignore[misc]
    return section


def _spectra(beside: _Beside) -> Section:
    section = Section("spectra", "Spectra", "Amplitudes as the monitor published them, at the end and on average.")
    for stage in names.STAGES:
        beside.pair(section, lambda run, stage=stage: spectra.amplitude(run, stage))  # type: ignore[misc]
        beside.pair(section, lambda run, stage=stage: spectra.orders(run, stage))  # type: ignore[misc]
    return section


def _waterfall(beside: _Beside, time_range: Range1d) -> Section:
    section = Section("waterfall", "Spectra over time", "The same colours mean the same amplitude on both sides.")
    for stage in names.STAGES:
        top = max(waterfall.largest(run, stage) for run in beside.runs)
        figures = [waterfall.waterfall(run, stage, time_range, top) for run in beside.runs]
        beside.drawn(section, figures)
    return section


def _phase(beside: _Beside) -> Section:
    text = "The last mesh cycles, and where they are once per mesh cycle in the last seconds."
    section = Section("phase", "Phase diagrams and Poincaré sections", text)
    for stage in names.STAGES:
        beside.pair(section, lambda run, stage=stage: chooser.portrait(run, stage))  # type: ignore[misc]
    for stage in names.STAGES:
        figures = [_section(run, stage) for run in beside.runs]
        beside.drawn(section, figures)
    return section


def _section(run: RunData, stage: str) -> figure | None:
    if not len(phase.points(run, stage)):
        return None
    first = max(0.0, run.duration - chooser.POINTS_SHOWN)
    return phase.section(run, stage, phase.axes(run, stage), first)[0]


def _indicators(beside: _Beside, time_range: Range1d) -> Section:
    text = "Those whose means differ most, in terms of their spread. Colours are stages, dashes are planets."
    section = Section("indicators", "Indicators over time", text)
    drawn = [set(indicators.columns(run)) for run in beside.runs]
    far = dict.fromkeys(row.column for row in compared.differing(beside.runs))
    shown = [column for column in far if all(column in own for own in drawn)][:INDICATORS]
    sources = [{m: indicators.source(run, m) for m in names.MESHES if m in run.indicators} for run in beside.runs]
    for column in shown:
        figures: list[Model | None] = [
            indicators.history(run, column, own, time_range) for run, own in zip(beside.runs, sources, strict=True)
        ]
        beside.drawn(section, figures)
    if not shown:
        section.missing.append("No indicator is in both runs.")
    return section


def _alarms(runs: tuple[RunData, RunData], labels: Labels) -> Section:
    section = Section("alarms", "Alarms and diagnostics")
    for run, label in zip(runs, labels, strict=True):
        found = compared.alarms(run, label)
        if found.rows:
            section.tables.append(found)
        else:
            words = "No status was ever above OK." if run.spans else "No diagnostics were recorded."
            section.missing.append(f"{label}: {words}")
    return section
