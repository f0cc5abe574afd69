"""Stretches of the run that the report shows sample by sample: the largest vibration, the first alarm, the end.

The envelopes keep extremes of everything, but not samples. After the recording has been read once, what is worth a
closer look is known; the chunks that hold it are read a second time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.records.bulk import BulkReader
from nw_gear_monitor.records.chunks import Place
from nw_gear_monitor.review.decimate import Band
from nw_gear_monitor.review.rundata import OK, SILENT, RunData, Span, Window

SECONDS = 2.0
"""Length of a stretch that the report chooses by itself."""
ROWS = 10240
"""Most samples of such a stretch: at high rates it is shorter."""
MOST_ROWS = 120_000
"""Most samples that may be asked for: they all go into the page."""

LEAST = 4
"""Fewest samples that are shown."""

Chunks = Sequence[tuple[float, float, Place]]


@dataclass(frozen=True)
class Choice:
    """A stretch to show: why, and from when until when (s of ROS time)."""

    title: str
    start: float
    stop: float


def asked(run: RunData, spans: Sequence[tuple[float, float]]) -> list[Choice]:
    """Stretches that the user named, in seconds since the start of the run.

    Raises:
        InputError: one lies outside of the run, or they hold more samples than a page can.
    """
    if spans and run.waveform is None:
        raise InputError("--zoom", "a recording of this gearbox's waveform", "none")
    for begin, end in spans:
        if begin >= run.duration:
            raise InputError(f"--zoom {begin:g}:{end:g}", f"a begin within {run.duration:.1f} s", f"{begin:g} s")
    rows = sum(end - begin for begin, end in spans) * (run.waveform.rate if run.waveform else 0.0)
    if rows > MOST_ROWS:
        most = MOST_ROWS / (run.waveform.rate if run.waveform else 1.0)
        raise InputError("--zoom", f"at most {most:.1f} s in all", f"{sum(e - b for b, e in spans):.1f} s")
    return [Choice(f"{b:g} to {e:g} s", run.start + b, run.start + min(e, run.duration)) for b, e in spans]


def worth(run: RunData) -> list[Choice]:
    """Stretches that are worth a look in any run; those that nearly coincide are one."""
    wave = run.waveform
    if wave is None:
        return []
    half = 0.5 * min(SECONDS, ROWS / wave.rate, run.duration)
    found: dict[float, list[str]] = {}
    for words, moment in _moments(run):
        near = next((at for at in found if abs(at - moment) < 0.5 * half), None)
        found.setdefault(moment if near is None else near, []).append(words)
    choices = []
    for at, reasons in found.items():
        centre = min(max(at, run.start + half), run.end - half)
        title = f"{', '.join(reasons)} ({at - run.start:.1f} s)"
        choices.append(Choice(title[0].upper() + title[1:], centre - half, centre + half))
    return choices


def _moments(run: RunData) -> list[tuple[str, float]]:
    assert run.waveform is not None, "only called where there is a waveform"
    found = []
    for stage in names.STAGES:
        moment = largest(run.waveform.displacement.select(names.MESHES_OF_STAGE[stage]))
        found.append((f"largest vibration of stage {stage}", moment))
    spans = [s for own in run.spans.values() for s in own if s.level not in (OK, SILENT) and s.start <= run.end]
    worst = max(spans, key=_rank, default=None)
    if worst is not None:
        found.append((f"begin of “{worst.name.split(': ')[-1]}: {worst.state or worst.reason[:40]}”", worst.start))
    return found


def _rank(span: Span) -> tuple[int, float]:
    return span.level, -span.start


def largest(band: Band) -> float:
    """When the spread of the values in one bin was largest, s."""
    spread: Array = (band.high - band.low).max(axis=1)
    return float(band.time[int(np.argmax(spread))])


def tail(run: RunData) -> Window | None:
    """The last seconds, which are held anyway."""
    if run.waveform is None or len(run.waveform.tail) < LEAST:
        return None
    table = run.waveform.tail
    rows = min(len(table), 2 * ROWS)
    kept = Table(table.row, table.columns, table.data[-rows:])
    return Window(f"End of the run (last {rows / run.waveform.rate:.2g} s)", kept)


def fetch(reader: BulkReader, topic: str, chunks: Chunks, choice: Choice) -> Window | None:
    """Read a stretch again.

    Args:
        reader: of the recording.
        topic: name of the waveform in it.
        chunks: first and last stamp (s) in every place of the recording.
        choice: what is wanted.
    """
    blocks: list[Array] = []
    columns: tuple[str, ...] = ()
    for first, last, place in chunks:
        if last < choice.start or first > choice.stop:
            continue
        batch = reader.again(place)
        for number in batch.of(topic).tolist():
            value = batch.value(number)
            if not isinstance(value, Table) or (columns and value.columns != columns):
                continue
            columns = value.columns
            time = value.column("time")
            blocks.append(value.data[(time >= choice.start) & (time <= choice.stop)])
    rows: Array = np.concatenate(blocks) if blocks else np.empty((0, 0))
    if len(rows) < LEAST:
        return None
    ascending = np.append(True, np.diff(np.maximum.accumulate(rows[:, 0])) > 0.0)
    return Window(choice.title, Table(names.ROW_SAMPLE, columns, rows[ascending]))
