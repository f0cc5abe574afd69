"""Cycles of a signal as rows of a matrix: all that happens between two strobes, not one point of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked
from nw_gear_monitor.signals.resample import whole_turns

MOST_POINTS = 48
"""Points a cycle and channel; faster signals are averaged down to them."""
LEAST_POINTS = 2
INTERPOLATION_SHARE = 0.1
"""Error of the spline of degree 5, as a share of its distance from the spline of degree 3."""


@dataclass(frozen=True, eq=False)
class Cycles:
    """A signal cut at its strobes.

    Attributes:
        rows: (cycles, points), every channel in units of its standard deviation, channels side by side.
        floor: error of the interpolation between samples, rms in the same unit.
        strobed: whether there are several points to a cycle (False: a map or a signal that came strobed).
    """

    rows: Array
    floor: float
    strobed: bool

    @property
    def count(self) -> int:
        """Number of cycles."""
        return int(self.rows.shape[0])


def from_points(x: Array, v: Array | None) -> Cycles:
    """Cycles of one point each: a map, or a signal that was strobed before."""
    channels = [x] if v is None else [x, v]
    rows = np.column_stack([(channel - channel.mean()) / _spread(channel) for channel in channels])
    return Cycles(np.ascontiguousarray(rows), 0.0, strobed=False)


def from_samples(x: Array, phase: Array, v: Array | None) -> Cycles:
    """Cut a sampled signal at whole turns of a phase.

    Args:
        x: (samples,) any unit.
        phase: (samples,) rad, growing by 2 pi a cycle.
        v: (samples,) second channel, such as the derivative, or None.

    Raises:
        InputError: fewer than LEAST_POINTS samples to a cycle.
    """
    channels = [x] if v is None else [x, v]
    per_cycle = 2.0 * np.pi * (phase.size - 1) / (phase[-1] - phase[0])
    if per_cycle < LEAST_POINTS:
        raise InputError("strobe", f"at least {LEAST_POINTS} samples to a cycle", f"{per_cycle:.3g}")
    wide = int(per_cycle // MOST_POINTS)
    if wide > 1:
        channels = [_averaged(channel, wide) for channel in channels]
        phase = _averaged(phase, wide)
        per_cycle /= wide
    points = max(int(0.8 * per_cycle), LEAST_POINTS)
    parts, error = [], 0.0
    for channel in channels:
        scaled = (channel - channel.mean()) / _spread(channel)
        fine = whole_turns(phase, scaled, per_turn=points).values
        coarse = whole_turns(phase, scaled, per_turn=points, degree=3).values
        parts.append(fine)
        error += float(np.mean((fine - coarse) ** 2)) / len(channels)
    return Cycles(np.ascontiguousarray(np.hstack(parts)), INTERPOLATION_SHARE * float(np.sqrt(error)), strobed=True)


def _averaged(values: Array, wide: int) -> Array:
    kept = values.size // wide * wide
    return np.asarray(values[:kept].reshape(-1, wide).mean(axis=1), dtype=np.float64)


def _spread(channel: Array) -> float:
    return float(np.std(channel)) or 1.0


def dominant_phase(x: Array) -> Array | None:
    """Phase (rad) of the strongest line of a sampled signal; None where no line stands out.

    The line is found in the Hann-windowed spectrum and placed between bins by the phase that its halves differ by.
    """
    values = checked.signal("x", x, 64)
    size = values.size
    window = np.hanning(size)
    power = np.abs(np.fft.rfft((values - values.mean()) * window)) ** 2
    power[:3] = 0.0
    peak = int(np.argmax(power))
    near = power[max(peak - 2, 0) : peak + 3].sum()
    if near < 0.1 * power.sum():
        return None
    half = size // 2
    short = np.hanning(half)
    n: Array = np.arange(half, dtype=np.float64)
    angle = 2.0 * np.pi * peak / size
    for _ in range(3):
        turn = np.exp(-1j * angle * n)
        first = np.sum((values[:half] - values.mean()) * short * turn)
        second = np.sum((values[half : 2 * half] - values.mean()) * short * turn) * np.exp(-1j * angle * half)
        angle += float(np.angle(second * np.conj(first))) / half
    return np.arange(size, dtype=np.float64) * angle
