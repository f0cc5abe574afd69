"""The sections of the report: which figures and tables stand where, and what is said where data are missing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from bokeh.models import ColumnDataSource, Model, Range1d

from nw_gear_common import names
from nw_gear_monitor.indicators import bearing_registry, registry
from nw_gear_monitor.review import tables
from nw_gear_monitor.review.figures import (
    cascade,
    chooser,
    forces,
    history,
    indicators,
    operation,
    spectra,
    states,
    waterfall,
    zoom,
)
from nw_gear_monitor.review.figures.chooser import Chosen
from nw_gear_monitor.review.measured import Measured
from nw_gear_monitor.review.rundata import RunData
from nw_gear_monitor.review.summary import Summary
from nw_gear_monitor.review.tables import DataTable

NO_MONITOR = "No monitor was recorded with this run, so there is nothing to show here."
NOT_TURNING = "The gearbox stood still at the end of the run, so there are no mesh cycles to show."
PLANET_BEARINGS = ("pb1_1", "pb1_2", "pb1_3", "pb2_1", "pb2_2", "pb2_3")
SHAFT_BEARINGS = ("sb", "b1", "b21", "b22")


@dataclass(frozen=True)
class Row:
    """Figures side by side."""

    columns: int
    names: tuple[str, ...]


@dataclass(frozen=True)
class Detail:
    """A text that is folded away."""

    title: str
    text: str


@dataclass
class Section:
    """One heading of the report with all under it."""

    anchor: str
    title: str
    text: str = ""
    rows: list[Row] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    tables: list[DataTable] = field(default_factory=list)
    details: list[Detail] = field(default_factory=list)
    figures: dict[str, Model] = field(default_factory=dict)

    def add(self, columns: int, models: Iterable[Model | None], otherwise: str = "") -> None:
        """Put figures side by side; where none could be made, say why."""
        chosen = []
        for model in models:
            if model is not None:
                name = f"{self.anchor}_{len(self.figures)}"
                self.figures[name] = model
                chosen.append(name)
        if chosen:
            self.rows.append(Row(columns, tuple(chosen)))
        elif otherwise and otherwise not in self.missing:
            self.missing.append(otherwise)


def build(run: RunData, summary: Summary, measured: Measured | None = None, remark: str = "") -> list[Section]:
    """All sections of the report, in order."""
    longest = max(0.0, run.duration) or 1.0  # a single message has a moment, and no duration
    time_range = Range1d(0.0, longest, bounds=(-0.02 * longest, 1.02 * longest), name="time")
    windows = [zoom.window_source(run, window) for window in run.windows]
    chosen = chooser.choose(run, windows)
    return [
        _summary(summary, run),
        _wind_and_load(run, time_range, measured, remark),
        _states(run, time_range),
        _displacement(run, time_range, windows),
        _forces(run, time_range, windows),
        _samples(run, chosen),
        _spectra(run),
        _waterfall(run, time_range),
        _phase(run, summary, chosen),
        _indicators(run, time_range),
        _alarms(run, summary, time_range),
        _truth(run),
        _provenance(run),
    ]


def _summary(summary: Summary, run: RunData) -> Section:
    return Section("summary", "Summary", tables=[tables.stages(summary, run)])


def _wind_and_load(run: RunData, time_range: Range1d, measured: Measured | None, remark: str) -> Section:
    fixed = "" if run.wind_drove else "The operating point was fixed: the wind was published but didn't drive. "
    text = f"{fixed}Figures over time are linked: zoom or pan one and all follow. {remark}"
    section = Section("wind-and-load", "Wind and load", text.strip())
    section.add(1, [operation.wind(run, time_range, measured)], "The wind speed was not recorded.")
    load = [f(run, time_range) for f in (operation.speed, operation.torque, operation.power, operation.mesh_frequency)]
    section.add(2, load, "Neither the shafts nor the waveform were recorded.")
    return section


def _states(run: RunData, time_range: Range1d) -> Section:
    section = Section(
        "states", "States over time", "What the monitor called each stage; point at a band for the reason."
    )
    section.add(
        1, [states.stages(run, time_range)], NO_MONITOR if not run.monitored else "The monitor published no states."
    )
    return section


def _displacement(run: RunData, time_range: Range1d, windows: list[ColumnDataSource]) -> Section:
    text = (
        "Meshing displacement x_n of every mesh, positive when the loaded flanks approach: least and largest value of "
        "all samples, none is lost by the reduction. Zoom in (wheel, box): the figures become finer, and show single "
        "samples in the shaded stretches."
    )
    section = Section("displacement", "Meshing displacement", text if run.waveform else "")
    if run.waveform is None:
        section.add(1, [], "The waveform was not recorded.")
        return section
    zoomed = zoom.follow(run, run.waveform.displacement, zoom.MICRO, "", windows, time_range)
    section.add(1, [history.envelope(run, stage, time_range, zoomed) for stage in names.STAGES])
    section.tables.append(tables.displacement(run))
    if run.waveform.gaps:
        section.tables.append(tables.gaps(run))
    return section


def _samples(run: RunData, chosen: Chosen | None) -> Section:
    section = Section("samples", "Every sample, and wavelet maps")
    if chosen is None:
        section.missing.append("The waveform was not recorded.")
        return section
    section.text = (
        "Stretches that the report keeps sample by sample: where each stage vibrates most, where the first of the "
        "worst warnings begins, the end, and what was asked for with --zoom. Wavelet maps show the same stretch over "
        "frequency: a line that comes and goes, an impact, a subharmonic."
    )
    section.add(3, [chosen.pick])
    section.add(3, chosen.samples)
    section.add(3, [one.figure for one in chosen.maps])
    return section


def _forces(run: RunData, time_range: Range1d, windows: list[ColumnDataSource]) -> Section:
    section = Section("forces", "Mesh and bearing forces")
    if run.mesh_force is not None:
        section.text = (
            "Mesh forces come from the view topic, which holds momentary values, far fewer than samples: a band "
            "from the least to the largest of them, and their mean. Bearing forces are envelopes of every sample."
        )
    section.add(3, [forces.mesh_force(run, s, time_range) for s in names.STAGES], "Mesh forces were not recorded.")
    band = run.waveform.bearing if run.waveform is not None else None
    zoomed = None if band is None else zoom.follow(run, band, zoom.KILO, "F_", windows, time_range)
    bearings = [
        forces.bearing_force(run, PLANET_BEARINGS, "Planet bearings", time_range, zoomed),
        forces.bearing_force(run, SHAFT_BEARINGS, "Sun and output shaft bearings", time_range, zoomed),
    ]
    section.add(2, bearings, "The waveform was recorded without bearing forces.")
    if run.bearing_radial:
        section.tables.append(tables.bearings(run))
    return section


def _spectra(run: RunData) -> Section:
    text = (
        "Amplitudes as the monitor published them, in its last message and on average. Dotted lines: the stage's mesh "
        "frequency with its harmonics (dark) and mesh frequencies of the other stages (light), at the end of the run."
    )
    section = Section("spectra", "Spectra", text if run.spectra or run.orders else "")
    for stage in names.STAGES:
        pair = [spectra.amplitude(run, stage), spectra.orders(run, stage)]
        section.add(2, pair, NO_MONITOR if not run.monitored else "The monitor published no spectra.")
    return section


def _waterfall(run: RunData, time_range: Range1d) -> Section:
    section = Section("waterfall", "Spectra over time")
    missing = NO_MONITOR if not run.monitored else "Fewer than two spectra were recorded: too few for a map."
    section.add(1, [waterfall.waterfall(run, stage, time_range) for stage in names.STAGES], missing)
    section.add(3, [cascade.cascade(run, stage) for stage in names.STAGES])
    return section


def _phase(run: RunData, summary: Summary, chosen: Chosen | None) -> Section:
    text = (
        "Top: the path in the plane of displacement and velocity, in the stretch of samples chosen above; the sliders "
        "say where in it, and how many mesh cycles. Below: where it is once per mesh cycle, at a fixed mesh phase, in "
        "the time chosen: n clusters per planet for period n, a curve for two frequencies, a scattered figure for "
        "chaos. Of a long run, stretches of a second spread over it are kept. Lines of the other stages widen a "
        "cluster into a ring, and a changing load smears it, without being chaos. The moving mean over 0.4 s, which "
        "follows the load, is taken out."
    )
    section = Section("phase", "Phase diagrams and Poincaré sections", text)
    still = NOT_TURNING if run.waveform is not None else "The waveform was not recorded."
    if chosen is not None:
        section.add(3, chosen.controls)
    section.add(3, [] if chosen is None else chosen.portraits, still)
    missing = NO_MONITOR if not run.monitored else "The monitor published no section points."
    figures, when = chooser.poincare(run)
    section.add(1, [when])
    section.add(3, figures, missing if summary.turning else NOT_TURNING)
    return section


def _indicators(run: RunData, time_range: Range1d) -> Section:
    section = Section("indicators", "Indicators over time")
    found = indicators.columns(run)
    sources = {mesh: indicators.source(run, mesh) for mesh in names.MESHES if mesh in run.indicators}
    models = [indicators.history(run, column, sources, time_range) for column in found]
    missing = NO_MONITOR if not run.monitored else "The monitor published no indicators (no window was filled)."
    if models:
        section.text = "Colours are stages, dashes are planets. A window that isn't filled yet gives no value."
        section.tables.append(tables.indicators("What each indicator is", found, registry.COLUMNS))
    section.add(3, models, missing)
    of_bearings = indicators.bearing_columns(run)
    section.add(3, [indicators.bearing_history(run, column, time_range) for column in of_bearings])
    if of_bearings:
        title = "What each indicator of a bearing is"
        section.tables.append(tables.indicators(title, of_bearings, bearing_registry.COLUMNS))
    return section


def _alarms(run: RunData, summary: Summary, time_range: Range1d) -> Section:
    section = Section("alarms", "Alarms and diagnostics")
    if not run.spans:
        section.missing.append("No diagnostics were recorded.")
        return section
    section.add(1, [states.levels(run, time_range)])
    if summary.alarms:
        section.tables.append(tables.alarms(run, summary))
    else:
        section.text = "No status was ever above OK."
    return section


def _truth(run: RunData) -> Section:
    section = Section("truth", "Truth of the simulator")
    if run.truth:
        section.text = f"What the simulator knows and a monitor has to find out: {run.truth_message or 'as follows'}."
        section.tables += [
            table for table in (tables.contact(run), tables.truth(run)) if table is not None and table.rows
        ]
    else:
        section.missing.append(
            "No truth was recorded: the data may come from a real machine, or the topic was left out."
        )
    return section


def _provenance(run: RunData) -> Section:
    section = Section("provenance", "Provenance")
    section.tables.append(tables.topics(run))
    if not run.provenance:
        section.missing.append("The recording carries no provenance.")
    for name, values in run.provenance.items():
        section.details.append(Detail(name, _as_text(list(values.items()))))
    return section


def _as_text(pairs: Sequence[tuple[str, str]]) -> str:
    lines = []
    for key, value in pairs:
        lines.append(f"{key}:\n{value}" if "\n" in value else f"{key}: {value}")
    return "\n".join(lines)
