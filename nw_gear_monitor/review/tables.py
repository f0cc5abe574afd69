"""The tables of the report, as text with units in the heads."""

from __future__ import annotations

from dataclasses import dataclass

from nw_gear_common import names
from nw_gear_monitor.indicators.window import Column
from nw_gear_monitor.review.figures import style
from nw_gear_monitor.review.rundata import RunData, Span
from nw_gear_monitor.review.summary import StageSummary, Summary, in_words, level_words

MOST_ALARMS = 60
MICRO = 1e6
KILO = 1e-3
DARK = frozenset({names.CHAOTIC, names.STALE})


@dataclass(frozen=True)
class Chip:
    """A coloured word."""

    text: str
    colour: str
    ink: str = style.INK


Cell = str | tuple[Chip, ...]


@dataclass(frozen=True)
class DataTable:
    """A table of texts; `numeric` are the columns set to the right, `folded` is shown on demand."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    numeric: frozenset[int] = frozenset()
    note: str = ""
    folded: bool = False


def state_chip(state: str, share: float | None = None) -> Chip:
    """A state in its colour, with its share of the time where that is given."""
    text = state if share is None else f"{state} {100 * share:.0f} %"
    return Chip(text, style.state_colour(state), "#fff" if state in DARK else style.INK)


def _stage_row(row: StageSummary, run: RunData) -> tuple[Cell, ...]:
    worst: tuple[Cell, Cell] = ("not judged", "")
    if row.worst is not None:
        at = f"{row.worst.start - run.start:.0f} to {row.worst.end - run.start:.0f} s"
        worst = ((state_chip(row.worst.state),), f"{at}: {row.worst.reason}" if row.worst.reason else at)
    return (
        row.stage,
        in_words(row.frequency, 1.0, "Hz", 1),
        f"{MICRO * row.rms:.2f}",
        f"{MICRO * row.peak_to_peak:.1f}",
        "not known" if row.contact_lost is None else f"{100 * row.contact_lost:.1f}",
        tuple(state_chip(state, share) for state, share in row.shares.items()) or "not judged",
        *worst,
    )


def stages(summary: Summary, run: RunData) -> DataTable:
    """Speed, displacement and states of each stage."""
    head = (
        "Stage",
        "Mesh frequency",
        "RMS (µm)",
        "Peak to peak (µm)",
        "Open (%)",
        "States (share of time)",
        "Worst",
        "When and why",
    )
    note = (
        "RMS about the mean and spread of the meshing displacement, and share of time without tooth contact as the "
        "simulator knows it, over the whole run; the largest of the stage's meshes."
    )
    return DataTable("Stages", head, tuple(_stage_row(row, run) for row in summary.stages), frozenset({2, 3, 4}), note)


def contact(run: RunData) -> DataTable | None:
    """How long each mesh had no contact, or contact on its back flank; None where the truth doesn't say."""
    rows = []
    for mesh in names.MESHES:
        shares = [run.contact(kind, mesh) for kind in ("open", "back-flank")]
        if None not in shares:
            rows.append((mesh, *(f"{100 * share:.2f}" for share in shares if share is not None)))
    if not rows:
        return None
    head = ("Mesh", "Open (% of the run)", "On the back flank (% of the run)")
    return DataTable("Contact of the teeth", head, tuple(rows), frozenset({1, 2}))


def truth(run: RunData) -> DataTable:
    """What else the simulator said."""
    rows = tuple((key, value) for key, value in sorted(run.truth.items()) if " fraction " not in key)
    return DataTable("Last values", ("Quantity", "Value"), rows)


def displacement(run: RunData) -> DataTable:
    """Extremes of every mesh over the run."""
    wave = run.waveform
    assert wave is not None, "only called where there is a waveform"
    rows = tuple(
        (m, f"{MICRO * wave.lowest[m]:.2f}", f"{MICRO * wave.highest[m]:.2f}", f"{MICRO * wave.rms[m]:.3f}")
        for m in names.MESHES
    )
    return DataTable(
        "Displacement of every mesh",
        ("Mesh", "Least (µm)", "Largest (µm)", "RMS (µm)"),
        rows,
        frozenset({1, 2, 3}),
        folded=True,
    )


def gaps(run: RunData) -> DataTable:
    """Samples that are missing in the waveform."""
    wave = run.waveform
    assert wave is not None, "only called where there is a waveform"
    rows = tuple((f"{gap.start - run.start:.3f}", f"{1e3 * gap.seconds:.1f}") for gap in wave.gaps[:MOST_ALARMS])
    note = f"The first {MOST_ALARMS} of {len(wave.gaps)}." if len(wave.gaps) > MOST_ALARMS else ""
    return DataTable(
        "Gaps in the waveform", ("Last sample before (s)", "Until the next (ms)"), rows, frozenset({0, 1}), note
    )


def bearings(run: RunData) -> DataTable:
    """Radial and axial forces of every bearing at the view rate."""
    rows = []
    for bearing, radial in run.bearing_radial.items():
        axial = run.bearing_axial[bearing]
        numbers = (
            radial.mean.mean(),
            radial.high.max(),
            axial.mean.mean(),
            abs(axial.low).max(),
            abs(axial.high).max(),
        )
        mean, largest, thrust, low, high = (KILO * float(n) for n in numbers)
        rows.append((bearing, f"{mean:.2f}", f"{largest:.2f}", f"{thrust:.2f}", f"{max(low, high):.2f}"))
    head = ("Bearing", "Radial mean (kN)", "Radial largest (kN)", "Axial mean (kN)", "Axial largest magnitude (kN)")
    note = "From the view topics (momentary values); the envelopes above hold every sample."
    return DataTable("Bearing forces", head, tuple(rows), frozenset({1, 2, 3, 4}), note, folded=True)


def _alarm_row(span: Span, run: RunData) -> tuple[Cell, ...]:
    chip = Chip(level_words(span.level), {1: style.ORANGE, 2: style.VERMILION}.get(span.level, style.GREY))
    text = f"{span.state}: {span.reason}" if span.state and span.reason else span.state or span.reason
    return (f"{span.start - run.start:.1f}", f"{span.duration:.1f}", (chip,), span.name, text)


def alarms(run: RunData, summary: Summary) -> DataTable:
    """Every stretch above OK."""
    rows = tuple(_alarm_row(span, run) for span in summary.alarms[:MOST_ALARMS])
    note = f"The first {MOST_ALARMS} of {len(summary.alarms)}." if len(summary.alarms) > MOST_ALARMS else ""
    head = ("Start (s)", "Lasted (s)", "Level", "Status", "Message")
    return DataTable("Warnings and alarms", head, rows, frozenset({0, 1}), note)


def indicators(title: str, columns: list[str], known: tuple[Column, ...]) -> DataTable:
    """What each indicator is, of those that are known."""
    texts = {c.name: c for c in known}
    rows = tuple((c, texts[c].unit or "-", texts[c].text) for c in columns if c in texts)
    return DataTable(title, ("Column", "Unit in the recording", "Meaning"), rows, folded=True)


def topics(run: RunData) -> DataTable:
    """What the recording holds."""
    rows = tuple((name, kind, f"{count}") for name, (kind, count) in sorted(run.topics.items()))
    return DataTable("Topics in the recording", ("Topic", "Type", "Messages"), rows, frozenset({2}), folded=True)
