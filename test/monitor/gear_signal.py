"""Waveforms of a gearbox whose state is known by construction."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array, Table
from nw_gear_monitor.gearing import gearing
from nw_gear_monitor.machine import Machine
from nw_gear_sim import config

RATE = 5120
BLOCK = 256
LEVEL = 1e-4
"""Mean displacement at rated load (m)."""

Speed = Callable[[Array], Array]
Extra = Callable[[Array, Array], Array]
"""(time, mesh phase) -> a further displacement of every mesh of a stage (m)."""


@cache
def paper() -> Machine:
    """The gearbox of the default configuration."""
    return gearing(config.load(None))


def waveform(
    seconds: float,
    *,
    start: float = 0.0,
    rate: float = RATE,
    speed: Speed | None = None,
    load: Speed | None = None,
    noise: float = 0.0,
    extra: dict[str, Extra] | None = None,
    lines: float = 1.0,
    seed: int = 1,
) -> Table:
    """A regular gearbox: mesh harmonics and each stage's neighbours, passed through a resonance at 120 Hz.

    Args:
        seconds, start, rate: length (s), first stamp (s), samples per second (Hz).
        speed, load: of time, in shares of the rated ones; constant where None.
        noise: standard deviation of added white noise over that of the signal.
        extra: stage -> further displacement.
        lines: factor on all lines.
        seed: of the noise.
    """
    gears = paper()
    time = np.arange(round(seconds * rate)) / rate
    turn = np.ones_like(time) if speed is None else speed(time)
    torque = np.ones_like(time) if load is None else load(time)
    cycles = np.concatenate([[0.0], np.cumsum(0.5 * (turn[1:] + turn[:-1]))]) / rate
    phase = 2.0 * np.pi * np.outer(cycles, gears.rated_frequency) + 0.3
    columns = names.waveform_columns()
    data = np.zeros((time.size, len(columns)))
    data[:, 0] = start + time
    data[:, 1:4] = phase
    generator = np.random.default_rng(seed)
    for channel, mesh in enumerate(names.MESHES):
        stage = names.STAGES.index(names.STAGE_OF_MESH[mesh])
        x = LEVEL * torque
        if lines:
            x = x + lines * _lines(phase, stage, gears.planet_phase[mesh], turn * gears.rated_frequency[:, None])
        if extra and names.STAGES[stage] in extra:
            x = x + extra[names.STAGES[stage]](time, phase[:, stage] + gears.planet_phase[mesh])
        if noise:
            x = x + noise * np.std(x - LEVEL * torque) * generator.standard_normal(x.size)
        data[:, 4 + channel] = x
        data[:, 11 + channel] = np.gradient(x, 1.0 / rate)
    data[:, 18:] = 1e4
    return Table(names.ROW_SAMPLE, columns, data)


def _lines(phase: Array, stage: int, shift: float, frequency: Array) -> Array:
    """Own harmonics, the other stages' mesh lines, and a combination, shaped by a resonance (zeta 0.05)."""
    multiples = {(1, 0, 0): 1.5e-6, (0, 1, 0): 2.5e-6, (0, 0, 1): 1.0e-6, (-1, 1, 0): 0.4e-6, (0, 1, 1): 0.2e-6}
    own = [0, 0, 0]
    own[stage] = 1
    multiples[own[0], own[1], own[2]] = 5e-6
    own[stage] = 2
    multiples[own[0], own[1], own[2]] = 2e-6
    total = np.zeros(len(phase))
    for multiple, amplitude in multiples.items():
        ratio = np.dot(multiple, frequency) / 120.0
        response = amplitude / (1.0 - ratio**2 + 0.1j * ratio)
        total += np.real(response * np.exp(1j * (phase @ np.array(multiple) + multiple[stage] * shift)))
    return total


def blocks(table: Table, rows: int = BLOCK) -> list[Table]:
    """Cut a waveform into blocks."""
    return [Table(table.row, table.columns, table.data[i : i + rows]) for i in range(0, len(table), rows)]


def logistic(r: float, size: int) -> Array:
    """Orbit of the logistic map after 1000 steps."""
    x = 0.3
    orbit = []
    for step in range(size + 1000):
        x = r * x * (1.0 - x)
        if step >= 1000:
            orbit.append(x)
    return np.array(orbit)


def duffing(cycles: Array, amplitude: float) -> Array:
    """Displacement of the chaotic forced oscillator x'' + 0.05 x' + x^3 = 7.5 cos(theta) (Ueda) against forcing cycles.

    Args:
        cycles: (samples,) forcing cycles passed, increasing.
        amplitude: standard deviation of the result (m).
    """
    steps = 60
    h = 2.0 * np.pi / steps
    count = int((cycles[-1] - cycles[0]) * steps) + 3 * steps
    x, v = 3.0, 4.0
    orbit = np.empty(count)

    def acceleration(x: float, v: float, t: float) -> float:
        return float(7.5 * np.cos(t) - 0.05 * v - x**3)

    for i in range(-20 * steps, count):
        if i >= 0:
            orbit[i] = x
        t = i * h
        k1x, k1v = v, acceleration(x, v, t)
        k2x, k2v = v + 0.5 * h * k1v, acceleration(x + 0.5 * h * k1x, v + 0.5 * h * k1v, t + 0.5 * h)
        k3x, k3v = v + 0.5 * h * k2v, acceleration(x + 0.5 * h * k2x, v + 0.5 * h * k2v, t + 0.5 * h)
        k4x, k4v = v + h * k3v, acceleration(x + h * k3x, v + h * k3v, t + h)
        x += h / 6.0 * (k1x + 2.0 * k2x + 2.0 * k3x + k4x)
        v += h / 6.0 * (k1v + 2.0 * k2v + 2.0 * k3v + k4v)
    found: Array = np.interp((cycles - cycles[0]) * steps, np.arange(count), orbit)
    return amplitude * (found - found.mean()) / found.std()
