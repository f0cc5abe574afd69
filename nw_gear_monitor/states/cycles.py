"""A signal cut at its strobes, and what is left of it when a waveform of n cycles is taken out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import make_interp_spline

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals.resample import whole_turns

TURN = 2.0 * np.pi
MOST_POINTS = 48
"""Points a cycle and channel; faster signals are averaged down to about this."""
LEAST_POINTS = 4
POINTS_A_SAMPLE = 0.8
KNOTS = 600
"""Knots to a cycle of a folded waveform."""
SAMPLES_A_KNOT = 6
FINE = 100
"""Knots below which samples aren't folded: the means of the cycles are taken out instead."""
SUBHARMONICS = (2, 3, 4, 5, 7, 8)
ABSORBED = 0.35
"""Share of a subharmonic that a waveform of one cycle may take for its own."""
GOLDEN = 0.6180339887498949
APART = 20
"""Cycles apart, in periods, from which on neighbours in place aren't neighbours in time."""


@dataclass(frozen=True, eq=False)
class Record:
    """A signal that can be cut into cycles.

    Attributes:
        channels: each (samples,), without mean, in units of its standard deviation.
        phase: (samples,) rad, 2 pi a cycle; None where there is one point a cycle.
        knots: to a cycle of a folded waveform.
    """

    channels: tuple[Array, ...]
    phase: Array | None
    knots: int = 0

    @property
    def count(self) -> int:
        """Number of whole cycles."""
        if self.phase is None:
            return int(self.channels[0].size)
        return int((self.phase[-1] - self.phase[0]) / TURN) - 1

    def halves(self) -> tuple[Record, Record]:
        """The first and the second half."""
        middle = self.channels[0].size // 2
        parts = (slice(None, middle), slice(middle, None))
        first, second = (
            Record(tuple(c[part] for c in self.channels), None if self.phase is None else self.phase[part], self.knots)
            for part in parts
        )
        return first, second

    def without(self, period: int) -> Array:
        """Cycles less the mean waveform of `period` cycles.

        Of a sampled signal the samples themselves are folded at the phase modulo 2 pi period and the waveform is taken
        from them, before anything is interpolated: what lies above half the sample rate doesn't fold back into cycles.

        Args:
            period: cycles to the waveform, 1 or more.

        Returns:
            (cycles, points) the channels side by side.
        """
        if self.phase is None:
            return _less_means(np.column_stack(self.channels), period)
        points = max(int(POINTS_A_SAMPLE * self._per_cycle), LEAST_POINTS)
        parts = []
        if self.knots < FINE:
            turns = [whole_turns(self.phase, channel, per_turn=points).values for channel in self.channels]
            return _less_means(np.hstack(turns), period)
        for channel in self.channels:
            left = channel - folded(channel, self.phase, period, self.knots)
            parts.append(whole_turns(self.phase, left, per_turn=points).values if np.any(left) else None)
        present = [part for part in parts if part is not None]
        if not present:
            return np.zeros((int((self.phase[-1] - self.phase[0]) / TURN), points * len(parts)))
        return np.ascontiguousarray(np.hstack([np.zeros_like(present[0]) if p is None else p for p in parts]))

    def sampling(self, rest: Array, period: int) -> float:
        """How little the place of the samples in a cycle says about the cycle: 1 nothing, 0 everything.

        A signal with jumps differs from cycle to cycle because the samples fall before or after them. Cycles are put in
        the order of the place of their first sample; half the mean square step between neighbours in that order, which
        mustn't be neighbours in time, is compared with the variance.

        Args:
            rest: (cycles, points) less the waveform of `period` cycles.
            period: cycles that are compared with each other are whole multiples of it apart.
        """
        if self.phase is None:
            return 1.0
        first = int(np.ceil(self.phase[0] / TURN - 1e-9))
        at = np.interp(TURN * (first + np.arange(len(rest))), self.phase, np.arange(self.phase.size))
        place, number = np.mod(at, 1.0), np.arange(len(rest))
        order = np.lexsort((np.mod(GOLDEN * number, 1.0), np.round(place, 2) % 1.0, number % period))
        together = (np.diff(number[order] % period) == 0) & (np.abs(np.diff(number[order])) > APART * period)
        if np.count_nonzero(together) < len(rest) // 4:
            return 1.0
        steps = np.sum(np.diff(rest[order], axis=0)[together] ** 2, axis=1)
        return float(0.5 * np.mean(steps) / np.mean(np.sum(rest**2, axis=1)))

    @property
    def _per_cycle(self) -> float:
        return 0.0 if self.phase is None else TURN * (self.phase.size - 1) / float(self.phase[-1] - self.phase[0])


def record(x: Array, phase: Array | None, v: Array | None) -> Record:
    """Take in a signal.

    Args:
        x: (samples,) any unit, not constant.
        phase: (samples,) rad, growing by 2 pi a cycle; None for one point a cycle.
        v: (samples,) second channel, or None.

    Raises:
        InputError: fewer than LEAST_POINTS samples to a cycle.
    """
    channels = [x] if v is None or not np.ptp(v) else [x, v]
    if phase is not None:
        per_cycle = TURN * (phase.size - 1) / float(phase[-1] - phase[0])
        if per_cycle < LEAST_POINTS:
            raise InputError("strobe", f"at least {LEAST_POINTS} samples to a cycle", f"{per_cycle:.3g}")
        wide = int(per_cycle // MOST_POINTS)
        if wide > 1:
            channels = [_averaged(channel, wide) for channel in channels]
            phase = _averaged(phase, wide)
    scaled = tuple((channel - channel.mean()) / (float(np.std(channel)) or 1.0) for channel in channels)
    return Record(scaled, phase, 0 if phase is None else _knots(phase))


def _knots(phase: Array) -> int:
    """The most knots with which the waveform of one cycle can't pass for subharmonics.

    Where the samples fall on the same places again every q cycles (23.7 samples a cycle: q = 10), a finely folded cycle
    would follow a motion of period 2 or 5, since each place is seen in even or in odd cycles alone.
    """
    whole: Array = np.floor(phase / TURN)
    place: Array = phase / TURN - whole
    turns = [np.exp(1j * TURN * (whole % m) / m) for m in SUBHARMONICS]
    knots = KNOTS
    while knots >= FINE:
        bins: npt.NDArray[np.int64] = (place * float(knots)).astype(np.int64)
        count: Array = np.maximum(np.bincount(bins, minlength=knots), 1.0)
        sums = ((np.bincount(bins, t.real, knots), np.bincount(bins, t.imag, knots)) for t in turns)
        if max(float(np.sum((a * a + b * b) / count)) for a, b in sums) < ABSORBED * phase.size:
            return knots
        knots = int(knots / 1.5)
    return 0


def folded(values: Array, phase: Array, period: int, knots: int) -> Array:
    """The mean waveform over `period` cycles at each sample's phase: a cubic spline through the means of bins."""
    length = TURN * period
    place = np.mod(phase, length)
    bins = max(min(knots * period, values.size // SAMPLES_A_KNOT), 4)
    number = np.minimum((place / length * bins).astype(np.int64), bins - 1)
    count = np.bincount(number, minlength=bins)
    kept = count > 0
    centre = np.bincount(number, place, bins)[kept] / count[kept]
    mean = np.bincount(number, values, bins)[kept] / count[kept]
    far = 4
    sites = np.concatenate([centre[-far:] - length, centre, centre[:far] + length])
    spline = make_interp_spline(sites, np.concatenate([mean[-far:], mean, mean[:far]]), k=3)
    return np.asarray(spline(place), dtype=np.float64)


def _less_means(rows: Array, period: int) -> Array:
    left = rows.copy()
    for group in range(period):
        left[group::period] -= left[group::period].mean(axis=0)
    return left


def _averaged(values: Array, wide: int) -> Array:
    kept = values.size // wide * wide
    return np.asarray(values[:kept].reshape(-1, wide).mean(axis=1), dtype=np.float64)
