"""From the columns of a file to the table `waveform` of a machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.datafiles.source import Source
from nw_gear_monitor.datafiles.timing import sample_rate
from nw_gear_monitor.foreign.phases import pulses, unwrapped
from nw_gear_monitor.machine import Machine
from nw_gear_monitor.signals import checked
from nw_gear_monitor.signals.stream import LEAST_RATE, RATE_ROUNDING
from nw_gear_monitor.signals.tacho import Fault

LEAST_SAMPLES = 64


@dataclass(frozen=True)
class Options:
    """How a file is to be read.

    Attributes:
        columns: column of the waveform -> column of the file, where their names differ.
        rate: samples per second, Hz, where the file doesn't tell.
        tacho: column with the tacho of the reference shaft, from which its phase is made; "" for none.
        pulses: of the tacho, in a turn.
        angle: unit of the phase columns (`phases.ANGLES`).
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    rate: float | None = None
    tacho: str = ""
    pulses: int = 1
    angle: str = "rad"


@dataclass(frozen=True, eq=False)
class Imported:
    """A waveform made from a file.

    Attributes:
        table: the samples.
        rate: of them, Hz.
        left_out: seconds at either end of the file without tacho.
        faults: what was wrong with the tacho's pulses.
    """

    table: Table
    rate: float
    left_out: float
    faults: tuple[Fault, ...]


def waveform(source: Source, machine: Machine, options: Options) -> Imported:
    """Put the columns that a machine's description asks for together.

    Args:
        source: the file.
        machine: what it was measured on.
        options: how to read it.

    Raises:
        InputError: a missing column, columns of different length, samples that aren't finite, times at uneven steps, a
            phase that doesn't grow, a tacho that can't be used, an option that names no column of the waveform.
    """
    layout = machine.layout
    known = (*layout.phases, *layout.values, *layout.optional)
    for name in options.columns:
        if name not in known:
            raise InputError(f"--column {name}", "a column of the machine: " + ", ".join(known), name)
    rate = _rounded(sample_rate(source, options.rate))
    wanted = [*layout.values, *(name for name in layout.optional if options.columns.get(name, name) in source.columns)]
    values = {name: _column(source, name, options) for name in wanted}
    samples = len(next(iter(values.values())))
    time = _start(source) + np.arange(samples) / rate
    inside = np.ones(samples, dtype=bool)
    faults: tuple[Fault, ...] = ()
    phases = {}
    for name in layout.phases:
        if options.tacho and name == layout.phases[0]:
            found = pulses(f"{source.place}: column {options.tacho}", time, _tacho(source, options), options.pulses)
            inside = (time >= found.times[0]) & (time <= found.times[-1])
            phases[name], faults = np.zeros(samples), found.faults
            phases[name][inside] = found.phase(time[inside])
        else:
            place = f"{source.place}: column {options.columns.get(name, name)}"
            phases[name] = unwrapped(place, _column(source, name, options), options.angle)
    columns = {"time": time, **phases, **values}
    lengths = {name: column.size for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        raise InputError(source.place, "columns of one length", ", ".join(f"{k}: {n}" for k, n in lengths.items()))
    table = Table(names.ROW_SAMPLE, tuple(columns), np.column_stack(list(columns.values()))[inside])
    if len(table) < LEAST_SAMPLES:
        raise InputError(source.place, f"at least {LEAST_SAMPLES} samples", str(len(table)))
    return Imported(table, rate, (samples - len(table)) / rate, faults)


def _rounded(rate: float) -> float:
    """The rate, as a whole number where it is close to one, as the monitor takes it."""
    whole = round(rate)
    found = float(whole) if whole and abs(rate / whole - 1.0) < RATE_ROUNDING else rate
    if found < LEAST_RATE:
        raise InputError("sample rate", f"at least {LEAST_RATE:g} Hz", f"{found:g} Hz")
    return found


def _start(source: Source) -> float:
    """Time of the first sample, s; 0 where the file has no times, or begins before 0."""
    return max(float(source.columns[source.time][0]), 0.0) if source.time else 0.0


def _column(source: Source, name: str, options: Options) -> Array:
    column = options.columns.get(name, name)
    return checked.finite(f"{source.place}: column {column}", source.column(column, f"--column {name}="))


def _tacho(source: Source, options: Options) -> Array:
    return source.column(options.tacho, "--tacho")
