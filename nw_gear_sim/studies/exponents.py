"""Largest Lyapunov exponent of many parameter points at once, by twin trajectories (Benettin et al. 1980).

Beside each point runs a twin, DISTANCE away. After every interval the twin is pulled back to that distance along the
separation reached, and the logarithms of the growth are averaged. All that a batch carries on is linear in the
displacements to first order of so small a separation, so that its parts are pulled back together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.batch.batch import Batch
from nw_gear_sim.batch.lanes import LANES
from nw_gear_sim.batch.results import End
from nw_gear_sim.params import Configuration

DISTANCE = 1e-8
"""Root of the sum of squares of the displacements between twins, m: far above rounding (roller loads are computed with
single precision powers), far below clearances."""
SETTLING = 0.25
"""Share of the intervals that turn the separation into the fastest growing direction, and don't count."""


@dataclass(frozen=True, eq=False)
class Exponents:
    """Largest exponents, 1/s, (points,), and their standard errors from the scatter between intervals."""

    rate: Array
    error: Array


def largest_exponents(
    configurations: Sequence[Configuration],
    start: End,
    *,
    excitation: str,
    ring: str,
    step: float,
    interval: float,
    intervals: int,
) -> Exponents:
    """Follow twins from where a batch ended.

    Args:
        configurations: of the points; start: where each is, on its attractor.
        excitation, ring, step: as they were.
        interval: time between two pulls, s; intervals: how many, at least 8.
    """
    rates, errors = [], []
    half = LANES // 2
    for k in range(0, len(configurations), half):
        own = list(range(k, min(k + half, len(configurations))))
        growth = _growth([configurations[i] for i in own], start.take(own), excitation, ring, step, interval, intervals)
        counted = growth[int(SETTLING * intervals) :]
        rates.append(counted.mean(axis=0))
        errors.append(counted.std(axis=0, ddof=1) / np.sqrt(len(counted)))
    return Exponents(np.concatenate(rates), np.concatenate(errors))


def _growth(
    points: list[Configuration], start: End, excitation: str, ring: str, step: float, interval: float, intervals: int
) -> Array:
    """Return the rates of growth over each interval, (intervals, points), 1/s."""
    count = len(points)
    pairs = start.take([*range(count), *range(count)])
    noise = np.random.default_rng(0).standard_normal((pairs.parts["x"].shape[0], count))
    noise[~np.any(pairs.parts["moved"] != 0.0, axis=1)] = 0.0  # rows that only fill the blocks would stay for ever
    pairs.parts["x"][:, count:] += DISTANCE * noise / np.linalg.norm(noise, axis=0)
    rates = []
    for _ in range(intervals):
        batch = Batch([*points, *points], excitation=excitation, ring=ring, step=step, start=pairs, threads=1)
        batch.advance(interval)
        pairs = batch.end()
        x, z = pairs.parts["x"], pairs.parts["z"]
        apart = np.sqrt(sum(np.sum((part[:, count:] - part[:, :count]) ** 2, axis=0) for part in (x, z)))
        with np.errstate(divide="ignore", invalid="ignore"):
            rates.append(np.log(apart / DISTANCE) / batch.time)
            for part in pairs.parts.values():
                part[:, count:] = part[:, :count] + (part[:, count:] - part[:, :count]) * (DISTANCE / apart)
    return np.array(rates)
