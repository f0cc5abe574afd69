"""Order tracking by the pulses of a tacho alone.

    pulses = read_pulses(times, pulses_per_turn=1)      names what is wrong with them
    phase = pulses.phase(time)                          of the shaft, at any time between the first and the last
    spectrum = tacho_orders(pulses, time, x)            amplitude over the shaft's order
    strongest(spectrum, 19.0, 21.0)                     order and amplitude of a line

The number of turns is a cubic spline through the pulses, so what happens between two of them is seen as far as it is
smooth: a speed that changes over many pulses is followed to the fourth order of their distance; a torsional vibration
faster than half the pulse rate isn't, and what the pulses catch of it looks like a slow one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline, PchipInterpolator

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked
from nw_gear_monitor.signals.resample import TURN, whole_turns
from nw_gear_monitor.signals.spectrum import hann

LEAST_PULSES = 6
NEIGHBOURS = 3
"""Intervals on either side from which the length of one is expected."""
SHORT, LONG = 0.6, 1.5
"""Shares of the expected interval below which a pulse is one too many, and above which one is missing."""
MOST_MISSING = 8
"""A longer gap can't be counted through."""
LEAST_TURNS = 8
FAULTY, FEW = 0.05, 3
"""Share of the pulses that may be wrong, and how many in any case, before nothing is believed any more."""
STEADY = 1e-6
"""Steps of time may differ by this share: sampling is uniform."""

MISSING, DOUBLE = "missing", "double"


@dataclass(frozen=True)
class Fault:
    """What was wrong with pulses: `kind` (MISSING or DOUBLE), at `time` (s), how many `pulses`."""

    kind: str
    time: float
    pulses: int


@dataclass(frozen=True, eq=False)
class Pulses:
    """Pulses of a shaft that turns forwards.

    Attributes:
        times: (pulses,) s; number: (pulses,) of each pulse, 0 the first; a missing one has a number but no time.
        per_turn: pulses in a turn.
        faults: what was found, in order of time.
    """

    times: Array
    number: npt.NDArray[np.int64]
    per_turn: int
    faults: tuple[Fault, ...]

    def phase(self, time: Array) -> Array:
        """Return the angle of the shaft since the first pulse, rad, at times (s) between first and last pulse.

        Raises:
            InputError: a time outside.
        """
        return np.asarray(TURN * self._turns()(self._inside(time)))

    def speed(self, time: Array) -> Array:
        """Return the speed of the shaft, rad/s, at times (s) between first and last pulse; InputError outside."""
        return np.asarray(TURN * self._turns().derivative()(self._inside(time)))

    def _inside(self, time: Array) -> Array:
        time = checked.finite("time", time)
        if time.min() < self.times[0] or time.max() > self.times[-1]:
            expected = f"times from the first pulse to the last, {self.times[0]:.6g} to {self.times[-1]:.6g} s"
            raise InputError("time", expected, f"{time.min():.6g} to {time.max():.6g} s")
        return time

    def _turns(self) -> CubicSpline | PchipInterpolator:
        """The spline; where it turns back somewhere, the monotone cubic of Fritsch and Butland (1984)."""
        turns = self.number / self.per_turn
        spline = CubicSpline(self.times, turns)
        return spline if _grows(spline) else PchipInterpolator(self.times, turns)


@dataclass(frozen=True, eq=False)
class OrderSpectrum:
    """Amplitude over the order of a shaft.

    Attributes:
        order: (bins,) from 0; amplitude: (bins,) in the unit of the signal.
        turns: of the shaft in one segment: bins are 1 / turns apart; segments: how many were averaged.
    """

    order: Array
    amplitude: Array
    turns: int
    segments: int


def read_pulses(times: Array, pulses_per_turn: int = 1) -> Pulses:
    """Check the pulses of a tacho and number them.

    Each interval is held against its NEIGHBOURS on either side. Where it is shorter than SHORT of what they lead to
    expect, the pulse that fits worse is dropped; where it is longer than LONG, the missing pulses are counted. Both are
    named in `faults`. A shaft that changes its speed so fast that neighbouring intervals differ by such factors (a
    start from rest, at one pulse a turn) looks the same; it has to be left out or given more marks.

    Args:
        times: (pulses,) s, ascending.
        pulses_per_turn: marks on the shaft.

    Raises:
        InputError: times that can't be used or aren't ascending, too few, a gap of more than MOST_MISSING pulses,
            too many faults.
    """
    per_turn = checked.whole("pulses_per_turn", pulses_per_turn, 1)
    kept = checked.finite("pulses", times, LEAST_PULSES)
    falls = np.flatnonzero(np.diff(kept) <= 0.0)
    if falls.size:
        i = int(falls[0])
        got = f"{kept[i]:.9g} s, then {kept[i + 1]:.9g} s at pulse {i + 1}"
        raise InputError("pulses", "times that ascend", got)
    kept, faults = _without_doubles(kept)
    intervals = np.diff(kept)
    share = intervals / _expected(intervals)
    steps = np.where(share > LONG, np.rint(share), 1.0).astype(np.int64)
    for i in map(int, np.flatnonzero(steps > 1)):
        if steps[i] - 1 > MOST_MISSING:
            expected = f"no gap of more than {MOST_MISSING} pulses"
            raise InputError("pulses", expected, f"{intervals[i]:.6g} s without one after {kept[i]:.6g} s")
        faults.append(Fault(MISSING, float(kept[i]), int(steps[i]) - 1))
    _refuse_many(kept, faults)
    number = np.concatenate([[0], np.cumsum(steps)]).astype(np.int64)
    return Pulses(kept, number, per_turn, tuple(sorted(faults, key=lambda fault: fault.time)))


def tacho_orders(pulses: Pulses, time: Array, x: Array, *, turns: int = 256) -> OrderSpectrum:
    """Amplitude spectrum of a signal over the order of the shaft that carries the tacho.

    The part of the signal between first and last pulse is resampled to equal angles (see `whole_turns`); segments of
    `turns` whole turns, half overlapped, are weighted by a Hann window and averaged in power.

    Args:
        pulses: of the shaft.
        time: (samples,) s, uniform; x: (samples,) any unit.
        turns: in a segment; fewer where there aren't as many.

    Raises:
        InputError: a signal that can't be used, time that isn't uniform, less than LEAST_TURNS turns.
    """
    time = checked.finite("time", time, LEAST_PULSES)
    x = checked.finite("x", x, LEAST_PULSES)
    steps = np.diff(time)
    if x.size != time.size:
        raise InputError("x", f"one value for each of {time.size} times", str(x.size))
    if not (steps.min() > 0.0 and np.ptp(steps) < STEADY * steps.mean() + 8 * np.spacing(np.abs(time).max())):
        raise InputError("time", "equal steps", f"{steps.min():.9g} to {steps.max():.9g} s")
    inside = (time >= pulses.times[0]) & (time <= pulses.times[-1])
    if np.count_nonzero(inside) < LEAST_PULSES:
        raise InputError("time", "samples between the first pulse and the last", "none")
    turned = whole_turns(pulses.phase(time[inside]), x[inside], least=LEAST_TURNS)
    length = min(checked.whole("turns", turns, LEAST_TURNS), turned.turns)
    window = hann(length * turned.per_turn)
    starts = range(0, turned.turns - length + 1, max(length // 2, 1))
    power = np.zeros(window.size // 2 + 1)
    for start in starts:
        piece = turned.values[start : start + length].reshape(-1)
        power += np.abs(2.0 * np.fft.rfft((piece - piece.mean()) * window) / window.sum()) ** 2
    order = np.arange(power.size) / length
    return OrderSpectrum(order, np.sqrt(power / len(starts)), length, len(starts))


def strongest(spectrum: OrderSpectrum, low: float, high: float) -> tuple[float, float]:
    """Return order and amplitude of the strongest line between two orders, interpolated between bins.

    The Hann window's lines have known shapes: with the ratio a of the larger neighbour to the peak the line is
    (2 a - 1) / (a + 1) bins towards it. Exact for one line of constant amplitude.

    Raises:
        InputError: no bin inside, or no line: nothing but zeros.
    """
    order, amplitude = spectrum.order, spectrum.amplitude
    inside = np.flatnonzero((order > low) & (order < high))
    inside = inside[(inside > 0) & (inside < order.size - 1)]
    if not inside.size or not amplitude[inside].max() > 0.0:
        raise InputError("orders", f"a line between {low:g} and {high:g}", "none")
    peak = int(inside[np.argmax(amplitude[inside])])
    side = 1 if amplitude[peak + 1] >= amplitude[peak - 1] else -1
    ratio = amplitude[peak + side] / amplitude[peak]
    shift = float(np.clip((2.0 * ratio - 1.0) / (ratio + 1.0), 0.0, 0.5))
    shape = np.sinc(shift) / (1.0 - shift * shift)
    return float(order[peak] + side * shift / spectrum.turns), float(amplitude[peak] / shape)


def _expected(intervals: Array) -> Array:
    """What the neighbours lead to expect of each interval: the geometric mean of the medians of both sides."""
    logs = np.log(intervals)
    windows = np.median(np.lib.stride_tricks.sliding_window_view(logs, NEIGHBOURS), axis=1)
    full = logs.size - NEIGHBOURS
    left, right = np.empty(logs.size), np.empty(logs.size)
    left[NEIGHBOURS:], right[:full] = windows[:full], windows[1 : full + 1]
    for i in range(NEIGHBOURS):
        left[i] = np.median(logs[:i]) if i else right[0]
        right[-1 - i] = np.median(logs[logs.size - i :]) if i else left[-1]
    return np.asarray(np.exp(0.5 * (left + right)))


def _without_doubles(times: Array) -> tuple[Array, list[Fault]]:
    """Drop pulses that are one too many, the worst first."""
    kept, faults = times, []
    while kept.size > LEAST_PULSES:
        intervals = np.diff(kept)
        expected = _expected(intervals)
        i = int(np.argmin(intervals / expected))
        if intervals[i] >= SHORT * expected[i]:
            break
        candidates = [np.delete(kept, i), np.delete(kept, i + 1)]
        drop = i + int(np.argmin([_roughness(times_left, i) for times_left in candidates]))
        faults.append(Fault(DOUBLE, float(kept[drop]), 1))
        kept = np.delete(kept, drop)
        _refuse_many(times, faults)
    return kept, faults


def _refuse_many(times: Array, faults: list[Fault]) -> None:
    if len(faults) > max(FEW, FAULTY * times.size):
        first = min(faults, key=lambda fault: fault.time)
        got = f"more than {len(faults) - 1}, the first a {first.kind} pulse at {first.time:.6g} s"
        raise InputError("pulses", f"at most {100 * FAULTY:g} % that are missing or double", got)


def _roughness(times: Array, near: int) -> float:
    """How much the logarithms of the intervals about a pulse differ."""
    intervals = np.diff(times[max(0, near - NEIGHBOURS) : near + NEIGHBOURS + 1])
    return float(np.std(np.log(intervals)))


def _grows(spline: CubicSpline) -> bool:
    """Whether a cubic spline grows everywhere: its slope at the knots and where the slope is least."""
    cubic, square, slope = spline.c[0], spline.c[1], spline.c[2]
    length = np.diff(spline.x)
    with np.errstate(divide="ignore", invalid="ignore"):
        lowest = np.clip(np.nan_to_num(-square / (3.0 * cubic)), 0.0, length)
    least = [slope, slope + length * (2.0 * square + 3.0 * cubic * length)]
    least.append(slope + lowest * (2.0 * square + 3.0 * cubic * lowest))
    return bool(np.min(least) > 0.0)
