"""Which stretch of samples is shown, which time of phase diagrams and Poincaré sections: widgets of the page."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from bokeh.models import ColumnDataSource, CustomJS, Model, RangeSlider, Select, Slider
from bokeh.plotting import figure

from nw_gear_common import names
from nw_gear_monitor.review.figures import history, phase, scripts, style, wavelet, zoom
from nw_gear_monitor.review.rundata import RunData

KNOTS = 0.05
"""Seconds between the values of the slow mean that go with a stretch."""
POINTS_SHOWN = 16.0
"""Seconds of Poincaré sections shown at first: the last ones."""
MOST_CYCLES = 200


@dataclass
class Chosen:
    """Everything on the page that follows the choice of a stretch.

    Attributes:
        windows: samples of every stretch.
        pick: the choice.
        samples: figures over time, one per stage.
        maps: wavelet maps, one per stage.
        portraits: phase diagrams, None where a stage stood still.
        controls: sliders of the phase diagrams.
    """

    windows: list[ColumnDataSource]
    pick: Select
    samples: list[figure]
    maps: list[wavelet.Map]
    portraits: list[figure | None] = field(default_factory=list)
    controls: list[Model] = field(default_factory=list)


def choose(run: RunData, windows: list[ColumnDataSource]) -> Chosen | None:
    """Figures of the chosen stretch, None without a waveform."""
    if not run.windows:
        return None
    titles = [f"{i}. {window.title}" for i, window in enumerate(run.windows, start=1)]
    begins, last = zoom.begins(run), len(run.windows) - 1
    pick = Select(title="Stretch of samples shown here and in the phase diagrams", value=titles[last], options=titles)
    pick.name = "pick"
    now = history.samples_source(run, windows[last], begins[last])
    now.name = "chosen"
    figures = [history.samples(run, stage, now, run.windows[last]) for stage in names.STAGES]
    chosen = Chosen(windows, pick, figures, wavelet.maps(run, begins))
    place, many = _sliders(run)
    axes = {stage: phase.axes(run, stage) for stage in names.STAGES}
    paths = {m: ColumnDataSource({"x": np.empty(0), "v": np.empty(0)}, name=f"path_{m}") for m in names.MESHES}
    chosen.portraits = [phase.portrait(run, stage, axes[stage], paths) for stage in names.STAGES]
    chosen.controls = [place, many] if any(chosen.portraits) else []
    frequencies = [[history.mesh_frequency(w, stage) for stage in names.STAGES] for w in run.windows]
    shared = {
        "pick": pick,
        "windows": windows,
        "begins": begins,
        "frequencies": frequencies,
        "stages": list(names.STAGES),
        "meshes": [list(names.MESHES_OF_STAGE[stage]) for stage in names.STAGES],
        "place": place,
    }
    shows = CustomJS(
        args={
            **shared,
            "now": now,
            "figures": figures,
            "cycles": history.CYCLES_SHOWN,
            "maps": [one.arguments() for one in chosen.maps],
        },
        code=scripts.CHOOSE,
    )
    turns = CustomJS(
        args={
            **shared,
            "knots": _knots(run),
            "paths": paths,
            "portraits": chosen.portraits,
            "many": many,
            "rate": run.waveform.rate if run.waveform else 1.0,
            "points": phase.POINTS_PER_CYCLE,
        },
        code=scripts.PATHS,
    )
    pick.js_on_change("value", shows, turns)
    place.js_on_change("value", turns)
    many.js_on_change("value", turns)
    return chosen


def portrait(run: RunData, stage: str) -> figure | None:
    """The phase diagram of a stage at the end of a run, with nothing to choose."""
    paths = {m: ColumnDataSource({"x": np.empty(0), "v": np.empty(0)}) for m in names.MESHES}
    return phase.portrait(run, stage, phase.axes(run, stage), paths)


def _sliders(run: RunData) -> tuple[Slider, Slider]:
    time = run.windows[-1].samples.column("time")
    length = float(time[-1] - time[0])
    place = Slider(title="Until (s after the begin of the stretch)", start=0.0, end=length, value=length, step=0.01)
    many = Slider(title="Mesh cycles", start=1, end=MOST_CYCLES, value=phase.CYCLES, step=1)
    return place, many


def _knots(run: RunData) -> list[ColumnDataSource]:
    """The slow mean (µm) of every mesh in every stretch."""
    assert run.waveform is not None, "windows are cut out of it"
    found = []
    for window in run.windows:
        time = window.samples.column("time")
        at = np.linspace(time[0], time[-1], max(2, int((time[-1] - time[0]) / KNOTS)))
        levels = {m: style.small(zoom.MICRO * phase.slow(run.waveform, m, at)) for m in names.MESHES}
        found.append(ColumnDataSource({"t": style.small(at - time[0]), **levels}))
    return found


def poincare(run: RunData) -> tuple[list[figure], RangeSlider | None]:
    """Poincaré sections of the stages that have points, and the choice of their time."""
    stages = [stage for stage in names.STAGES if len(phase.points(run, stage))]
    if not stages:
        return [], None
    first = max(0.0, run.duration - POINTS_SHOWN)
    every, planets, figures = [], [], []
    for stage in stages:
        points = phase.points(run, stage)
        time = run.sections[stage][:, 0] - run.start
        columns = {"t": time, "planet": points[:, 0], "x": phase.MICRO * points[:, 1], "v": phase.MILLI * points[:, 2]}
        every.append(ColumnDataSource({name: style.small(values) for name, values in columns.items()}))
        fig, sources = phase.section(run, stage, phase.axes(run, stage), first)
        for planet, source in sources.items():
            source.name = f"points_{stage}_{planet}"
        figures.append(fig)
        planets.append(sources)
    end = max(run.duration, 0.01)
    when = RangeSlider(
        title="Time of the Poincaré sections (s)", start=0.0, end=end, value=(first, end), step=max(0.01, end / 1000.0)
    )
    when.name = "when"
    arguments = {"when": when, "every": every, "planets": planets, "sections": figures, "stages": stages}
    when.js_on_change("value", CustomJS(args=arguments, code=scripts.POINTS))
    return figures, when
