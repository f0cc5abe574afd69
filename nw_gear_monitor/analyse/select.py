"""From the columns of a file and the options to signals: one channel each, with what is known about its time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.analyse.options import Options
from nw_gear_monitor.datafiles.source import Source, listed
from nw_gear_monitor.datafiles.timing import sample_rate
from nw_gear_monitor.signals import checked

LEAST_SAMPLES = 64
MOST_CHANNELS = 64
MOST_SAMPLES = 2**26
"""Longest channel; far beyond it the indicators would need more memory than a usual machine has."""


@dataclass(frozen=True, eq=False)
class Signal:
    """One channel.

    Attributes:
        name: of its column; x: (samples,) its values; v: (samples,) their derivative, where it is known.
        rate: samples per second, Hz; None for a map, of which each sample is one step.
        phase: (samples,) unwrapped, rad, one strobe every 2 pi; None where there is none.
    """

    name: str
    x: Array
    v: Array | None
    rate: float | None
    phase: Array | None


def signals(source: Source, options: Options) -> tuple[Signal, ...]:
    """Choose and check the channels that are asked for; all of them where none is named.

    Raises:
        InputError: a missing column, a sample that isn't finite, a constant, too few samples, a phase that doesn't
            grow, times at uneven steps, a rate that isn't known or contradicts the file, a velocity for more than one
            channel.
    """
    rate = None if options.map else sample_rate(source, options.rate)
    names = options.columns or _all(source, options)
    if len(names) > MOST_CHANNELS:
        raise InputError("--column", f"at most {MOST_CHANNELS} channels at once", str(len(names)))
    velocity = None if options.velocity is None else source.column(options.velocity, "--velocity")
    if velocity is not None and len(names) != 1:
        raise InputError("--velocity", "one channel (--column)", listed(list(names)))
    found = []
    for name in dict.fromkeys(names):
        place = f"{source.place}: column {name}"
        x = checked.signal(place, source.column(name, "--column"), LEAST_SAMPLES)
        if x.size > MOST_SAMPLES:
            raise InputError(place, f"at most {MOST_SAMPLES} samples", str(x.size))
        found.append(Signal(name, x, _velocity(source, options, velocity, x.size), rate, _phase(source, options, x)))
    return tuple(_timed(source, signal) for signal in found)


def _all(source: Source, options: Options) -> tuple[str, ...]:
    """Every column that is nothing else, of those that are as long as the longest."""
    taken = {source.time, options.phase, options.velocity}
    lengths = {name: column.size for name, column in source.columns.items() if name not in taken}
    if not lengths:
        raise InputError(source.place, "a column beside time, phase and velocity", "none")
    longest = max(lengths.values())
    return tuple(name for name, length in lengths.items() if length == longest)


def _velocity(source: Source, options: Options, velocity: Array | None, samples: int) -> Array | None:
    if velocity is None:
        return None
    place = f"{source.place}: column {options.velocity}"
    values = checked.signal(place, velocity)
    if values.size != samples:
        raise InputError(place, f"one value for each of {samples} samples", str(values.size))
    return values


def _phase(source: Source, options: Options, x: Array) -> Array | None:
    if options.phase is not None:
        place = f"{source.place}: column {options.phase}"
        return checked.phase(place, source.column(options.phase, "--phase"), x.size)
    return None if options.strobe is None else _even(options.strobe, sample_rate(source, options.rate), x.size)


def _even(strobe: float, rate: float, samples: int) -> Array:
    if not strobe < 0.5 * rate:
        raise InputError("--strobe", f"less than half the sample rate ({0.5 * rate:.6g} Hz)", f"{strobe:.6g}")
    return np.asarray(2.0 * np.pi * strobe / rate * np.arange(samples), dtype=np.float64)


def _timed(source: Source, signal: Signal) -> Signal:
    if source.time is not None and source.columns[source.time].size != signal.x.size:
        place = f"{source.place}: column {source.time}"
        raise InputError(place, f"one time for each of {signal.x.size} samples", str(source.columns[source.time].size))
    return signal
