"""The waveform as the page shows it: exact minima and maxima over the last seconds, and the newest samples in full."""

from __future__ import annotations

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.dashboard.buffers import Bins, Ring, zigzag
from nw_gear_monitor.review.collect import missing_columns
from nw_gear_monitor.review.decimate import Band, Tail
from nw_gear_monitor.review.rundata import Waveform

BINS = 1000
"""Bins over the time that is shown, about as many as the figures have pixels."""
TAIL_SECONDS = 2.0
BLOCKS = 1200
BACKWARD = 0.5
"""Seconds by which time has to go back to count as a new run."""
RADIANS = 2.0 * np.pi


class Waves:
    """Reduces blocks of `waveform`; memory doesn't grow.

    Args:
        columns: of the waveform.
        history: length of what is shown (s).
        origin: time of the first sample (s).

    Attributes:
        foreign: a column that is missing, where the waveform is that of another machine; "" else.
        channels: meshing displacements, then bearings.
        lines: points of the figures: time (s), then each channel (m, N).
        last: time of the newest sample (s).
    """

    def __init__(self, columns: tuple[str, ...], history: float, origin: float) -> None:
        self.columns, self.origin, self.last = columns, origin, -np.inf
        missing = missing_columns(columns) or [f"v_{m}" for m in names.MESHES if f"v_{m}" not in columns]
        self.foreign = missing[0] if missing else ""
        self.bearings = tuple(b for b in names.BEARINGS if f"fx_{b}" in columns and f"fy_{b}" in columns)
        self.channels = () if missing else (*names.MESHES, *self.bearings)
        self.width = history / BINS
        self.lines = Ring(1 + len(self.channels), 2 * BINS)
        self._bins = Bins(len(self.channels), self.width, origin)
        self._bands = Ring(1 + 3 * len(self.channels), BINS)
        self._frequencies = Ring(1 + len(names.STAGES), BLOCKS)
        self._kept = ("time", *(f"x_{m}" for m in names.MESHES), *(f"v_{m}" for m in names.MESHES))
        self._tail = Tail(TAIL_SECONDS)
        self._rate = 0.0
        self._before: float | None = None

    def goes_back(self, table: Table) -> bool:
        """Whether a block belongs to a new run."""
        return bool(table.column("time")[0] < self.last - BACKWARD)

    def add(self, table: Table) -> None:
        """Take a block; one that isn't later than the last sample is left out."""
        time = table.column("time")
        if time[0] <= self.last:
            return
        self.last = float(time[-1])
        if self.foreign:
            return
        if len(time) > 1:
            self._rate = (len(time) - 1) / float(time[-1] - time[0])
        values = self._values(table)
        good = np.isfinite(values).all(axis=1) & np.isfinite(time)
        bins = self._bins.add(time[good], values[good])
        gap = max(1.5 * self.width, 2.0 / self._rate if self._rate else 0.0)
        self.lines.add(zigzag(bins, len(self.channels), self.width, gap, self._before))
        self._bands.add(bins)
        if len(bins):
            self._before = float(bins[-1, 0])
        self._tail.add(table.select(self._kept))
        self._add_frequency(table)

    def _values(self, table: Table) -> Array:
        x = table.select(tuple(f"x_{m}" for m in names.MESHES))
        forces = [np.hypot(table.column(f"fx_{b}"), table.column(f"fy_{b}")) for b in self.bearings]
        return np.column_stack([x, *forces])

    def _add_frequency(self, table: Table) -> None:
        time = table.column("time")
        if len(time) > 1:
            turned = [float(np.ptp(table.column(f"phase_{s}")[[0, -1]])) for s in names.STAGES]
            cycles = np.array(turned) / (RADIANS * (time[-1] - time[0]))
            self._frequencies.add(np.array([[0.5 * (time[0] + time[-1]), *cycles]]))

    def reduced(self) -> Waveform | None:
        """What is kept, in the form that the figures of the report read; None before the first bins."""
        bins, frequencies, tail = self._bands.everything(), self._frequencies.everything(), self._tail.result()
        if not len(bins) or not len(frequencies) or tail is None:
            return None
        n, m = len(self.channels), len(names.MESHES)
        low, high, mean = bins[:, 1 : 1 + n], bins[:, 1 + n : 1 + 2 * n], bins[:, 1 + 2 * n :]
        band = Band(names.MESHES, bins[:, 0], low[:, :m], high[:, :m], mean[:, :m], self.width)
        cycle = frequencies[:, 1:]
        cycles = Band(names.STAGES, frequencies[:, 0], cycle, cycle, cycle, self.width)
        return Waveform(
            rate=self._rate,
            samples=len(tail),
            displacement=band,
            bearing=None,
            mesh_frequency=cycles,
            rms={},
            lowest={},
            highest={},
            tail=Table(names.ROW_SAMPLE, self._kept, tail),
            gaps=(),
        )
