"""What a healthy gearbox shows: statistics of every feature in every bin of speed and load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.alarms.kernel import COUNT, INDEPENDENT, LAST, STATISTICS, Whole
from nw_gear_monitor.alarms.operating import Bin


@dataclass(frozen=True)
class Progress:
    """How far learning is: bins seen, those in which at least one feature judges, windows learned."""

    bins: int
    judging: int
    windows: int


class Baseline:
    """Statistics by bin; features get columns as they are first met.

    Attributes:
        names: of the features, in the order of columns.
        bins: bin -> (STATISTICS, features).
        frozen: whether learning has been ended by hand.
        rate: sample rate of the waveform that was learned from, Hz; None before the first.
    """

    def __init__(self) -> None:
        self.names: list[str] = []
        self.bins: dict[Bin, Array] = {}
        self.frozen = False
        self.rate: float | None = None
        self._column: dict[str, int] = {}

    def columns(self, names: Sequence[str]) -> Whole:
        """Columns of features; those met for the first time get one."""
        new = [name for name in names if name not in self._column]
        for name in new:
            self._column[name] = len(self.names)
            self.names.append(name)
        if new:
            self.bins = {key: _widened(block, len(self.names)) for key, block in self.bins.items()}
        return np.array([self._column[name] for name in names], dtype=np.int64)

    def statistics(self, key: Bin) -> Array:
        """The statistics of a bin, empty ones where it has never been seen."""
        if key not in self.bins:
            self.bins[key] = empty(len(self.names))
        return self.bins[key]

    def progress(self, least: int) -> Progress:
        """How far it is, where a bin judges from `least` independent windows on."""
        judging = sum(bool(np.any(block[INDEPENDENT] >= least)) for block in self.bins.values())
        windows = sum(int(np.max(block[COUNT], initial=0.0)) for block in self.bins.values())
        return Progress(len(self.bins), judging, windows)


def empty(features: int) -> Array:
    """Statistics of a bin in which nothing has been seen."""
    block = np.zeros((STATISTICS, features))
    block[LAST] = np.nan
    return block


def _widened(block: Array, features: int) -> Array:
    wider = empty(features)
    wider[:, : block.shape[1]] = block
    return wider
