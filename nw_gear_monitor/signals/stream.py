"""Turns blocks of the waveform into whole seconds of contiguous samples; finds gaps by the stamps, never bridges one.

Everything downstream works on `Second` objects: all samples whose stamps lie in [k, k + 1) for a whole number k. What
is computed is therefore a function of the stamped samples alone, not of their cut into messages or of wall time.
A second that is not whole (start of a run at a fraction of a second, either side of a gap) is left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from nw_gear_common.tables import Array, Table
from nw_gear_monitor.signals.late import Late
from nw_gear_monitor.signals.layout import Layout, malformed

STEP_TOLERANCE = 0.5
"""A stamp that is off by more than this share of a sample interval breaks the stream."""
PHASE_TOLERANCE = 0.1
"""A mesh phase whose step changes by more than this from one sample to the next (rad) breaks the stream."""
RATE_ROUNDING = 1e-3
"""A sample rate this close to a whole number (relative) is taken to be that number: stamps near the wall clock carry
only 2.4e-7 s, 0.5 % of a block of two samples at 20 kHz, so that a measured rate needs rounding."""

LEAST_RATE = 64.0
"""Fewer samples per second than this aren't taken for a waveform (Hz)."""


@dataclass(frozen=True, eq=False)
class Second:
    """All samples of one whole second.

    Attributes:
        start: the second, in seconds of the stamps.
        epoch: number of the contiguous piece of the stream; windows never span two.
        rate: samples per second (Hz).
        columns: column names.
        data: array (samples, columns), SI.
    """

    start: int
    epoch: int
    rate: float
    columns: tuple[str, ...]
    data: Array

    def column(self, name: str) -> Array:
        """Return one column, a view of shape (samples,)."""
        return self.data[:, self.columns.index(name)]


@dataclass
class Continuity:
    """What went wrong with the stream so far.

    Attributes:
        blocks: blocks accepted.
        gaps, lost_seconds: stretches of missing samples and their total length (s).
        restarts: jumps back in time, jumps of phase, changes of columns or rate: each starts a new epoch.
        malformed, last_malformed: blocks dropped because they can't be read, and what was wrong with the last.
        repeated, disordered, last_late: blocks dropped because they came twice or too late, and the last of them.
        constant: columns that didn't change in the newest second although the machine turned.
        last_gap, last_restart: the latest of either in words; last_break: the later of both.
    """

    blocks: int = 0
    gaps: int = 0
    lost_seconds: float = 0.0
    restarts: int = 0
    malformed: int = 0
    last_malformed: str = ""
    repeated: int = 0
    disordered: int = 0
    last_late: str = ""
    constant: tuple[str, ...] = ()
    last_gap: str = ""
    last_restart: str = ""
    last_break: str = ""


class Stream:
    """Collects blocks and gives out whole seconds.

    Args:
        layout: the columns that it looks at.
    """

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self.continuity = Continuity()
        self.epoch = 0
        self.columns: tuple[str, ...] = ()
        self.rate = 0.0
        self._pieces: list[Array] = []
        self._tail: Array | None = None
        self._needs_rate = True
        self._late = Late()

    def reset(self) -> None:
        """Forget the samples and start a new epoch; the counters stay."""
        self._late.forget()
        self.epoch += 1
        self._pieces = []
        self._tail = None
        self._needs_rate = True

    def feed(self, table: Table) -> list[Second]:
        """Take one block in and return the seconds that became whole with it, oldest first."""
        problem = malformed(table, self._layout)
        if problem:
            self.reject(problem)
            return []
        columns = self._layout.chosen(table.columns)
        data = np.ascontiguousarray(table.data) if columns == table.columns else table.select(columns)
        if columns != self.columns:
            if self.columns:
                self._restart("the columns changed")
            self.columns = columns
        aside = self._late.begun_anew(data)
        if aside is not None:
            self._restart(f"time jumped back to {aside[0, 0]:.3f} s")
            data = np.vstack([aside, data])
        elif self._late.put_aside(data):
            self._count_late(data[:, 0])
            return []
        if _rate(data) < LEAST_RATE:
            self.reject(f"sample rate: expected at least {LEAST_RATE:g} Hz, got {_rate(data):g} Hz")
            return []
        self.continuity.blocks += 1
        return self._take(data)

    def reject(self, reason: str) -> None:
        """Count a block that can't be read."""
        self.continuity.malformed += 1
        self.continuity.last_malformed = reason

    def _take(self, data: Array) -> list[Second]:
        if self._other_rate(data):
            self._restart(f"the sample rate changed from {self.rate:g} Hz to {_rate(data):g} Hz")
        seconds: list[Second] = []
        for piece in self._split(data):
            if piece is None:
                self.reset()
            else:
                seconds += self._append(piece)
        self._late.accept(data[:, 0])
        return seconds

    def _count_late(self, time: Array) -> None:
        repeated = self._late.repeated(time)
        self.continuity.repeated += repeated
        self.continuity.disordered += not repeated
        how = "came twice" if repeated else "came after later ones"
        self.continuity.last_late = f"a block {how}: {time[0]:.3f} to {time[-1]:.3f} s"

    def _other_rate(self, data: Array) -> bool:
        if self._needs_rate or len(data) < 3 or not _contiguous(data[:, 0]):
            return False
        stamp_error = 2.0 * float(np.spacing(abs(data[-1, 0])))
        return abs(_interval(data) * self.rate - 1.0) > RATE_ROUNDING + stamp_error * self.rate

    def _split(self, data: Array) -> list[Array | None]:
        """Cut a block where its samples are not contiguous (None), at the joint to the last block too; count breaks."""
        watched = [self.columns.index(name) for name in ("time", *self._layout.phases)]
        joined = data[:, watched] if self._tail is None else np.vstack([self._tail[:, watched], data[:, watched]])
        offset = len(joined) - len(data)
        interval = 1.0 / self.rate if not self._needs_rate else _interval(data)
        steps = np.diff(joined[:, 0])
        broken = np.abs(steps - interval) > STEP_TOLERANCE * interval
        bends = np.abs(np.diff(joined[:, 1:], n=2, axis=0)) * np.array(self._layout.cycles)
        jumps = np.any(bends > PHASE_TOLERANCE, axis=1) & ~broken[:-1]
        jumps[1:] &= ~jumps[:-1]
        broken[1:] |= jumps
        pieces: list[Array | None] = []
        start = 0
        for joint in np.flatnonzero(broken):
            row = int(joint) + 1 - offset
            if row < 0:
                continue
            if row > start:
                pieces.append(data[start:row])
            pieces.append(None)
            self._count(steps[joint], interval, float(joined[joint + 1, 0]))
            start = row
        pieces.append(data[start:])
        return pieces

    def _append(self, piece: Array) -> list[Second]:
        if self._needs_rate:
            if len(piece) < 2:
                return []
            self.rate = _rate(piece)
            self._needs_rate = False
        self._pieces.append(piece)
        both = piece if self._tail is None else np.vstack([self._tail, piece[-2:]])
        self._tail = both[-2:].copy()
        return self._cut()

    def _cut(self) -> list[Second]:
        """Give out every second whose last sample has arrived."""
        half = 0.5 / self.rate
        first = float(self._pieces[0][0, 0])
        after_last = float(self._pieces[-1][-1, 0]) + 2.0 * half
        if np.floor(after_last + half) <= np.floor(first + half):
            return []
        data = np.concatenate(self._pieces)
        index = np.floor(data[:, 0] + half)
        end = math.floor(after_last + half)
        seconds = []
        for start in range(int(index[0]), int(end)):
            rows = data[np.searchsorted(index, start) : np.searchsorted(index, start + 1)]
            if rows[0, 0] - start < 1.5 / self.rate:
                seconds.append(Second(start, self.epoch, self.rate, self.columns, rows))
        rest = data[np.searchsorted(index, end) :]
        self._pieces = [rest.copy()] if len(rest) else []
        return seconds

    def _count(self, step: float, interval: float, time: float) -> None:
        if step > (1.0 + STEP_TOLERANCE) * interval:
            self.continuity.gaps += 1
            self.continuity.lost_seconds += step - interval
            self.continuity.last_gap = f"{step - interval:.4g} s missing before {time:.3f} s"
            self.continuity.last_break = self.continuity.last_gap
        elif step < (1.0 - STEP_TOLERANCE) * interval:
            self._note(f"time jumped back by {interval - step:.4g} s to {time:.3f} s")
        else:
            self._note(f"the mesh phase jumped at {time:.3f} s")

    def _restart(self, reason: str) -> None:
        self._note(reason)
        self.reset()

    def _note(self, reason: str) -> None:
        self.continuity.restarts += 1
        self.continuity.last_restart = self.continuity.last_break = reason


def _interval(data: Array) -> float:
    return float(np.median(np.diff(data[:, 0])))


def _contiguous(time: Array) -> bool:
    steps = np.diff(time)
    typical = float(np.median(steps))
    return bool(typical > 0 and np.all(np.abs(steps - typical) < STEP_TOLERANCE * typical))


def _rate(data: Array) -> float:
    """Sample rate of the first contiguous run of rows (Hz), rounded to a whole number where it is close to one."""
    steps = np.diff(data[:, 0])
    typical = float(np.median(steps))
    if typical <= 0:
        return 1.0
    regular = np.abs(steps - typical) < STEP_TOLERANCE * typical
    measured = 1.0 / float(np.mean(steps[regular]))
    whole = round(measured)
    return float(whole) if whole and abs(measured / whole - 1.0) < RATE_ROUNDING else measured
