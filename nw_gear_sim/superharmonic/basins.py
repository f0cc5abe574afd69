"""Basins: from which displacement and velocity the delay equation ends in which of its stable motions.

The state of a delay equation is its history; a map shows the plane of displacement and velocity at time 0, where the
excitation has its phase 0, with one history before each point:

    constant   at rest at x0, and set off with v0 at time 0
    free       x0 cos(w0 t) + v0/w0 sin(w0 t), the linear motion without excitation through the point
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.superharmonic.floquet import is_stable
from nw_gear_sim.superharmonic.harmonics import NoOrbit, Orbit
from nw_gear_sim.superharmonic.lanes import Stepper, advance, stepper
from nw_gear_sim.superharmonic.laws import balance_of, project
from nw_gear_sim.superharmonic.pair import GearPair

HISTORIES = ("constant", "free")
MOST_STARTS = 250_000
MOST_PERIODS = 1000
STEPS_PER_PERIOD = {"cubic": 128, "backlash": 256}
LANES = 128
BLOCK = 5
"""Periods between two looks."""
NEAR = 0.1
"""A motion is taken as arrived within this part of the distance from its orbit to the closest other one."""
PHASES = 8
"""Instants of a period at which motions and orbits are compared."""
ATTEMPTS = 6
"""Motions that end nowhere known and are tried as starts of Newton's method for a further orbit."""
Whole = npt.NDArray[np.int64]
Orbits = tuple[tuple[Orbit, bool], ...]


@dataclass(frozen=True, eq=False)
class Basins:
    """A map of basins.

    Attributes:
        omega: excitation frequency; history: of HISTORIES.
        x, v: (n,) and (m,) axes.
        orbits: periodic orbits known at that frequency, each with whether it is stable.
        ends: (n, m) index of the orbit in which a start ends; -1 where it ends in none within the periods allowed.
        periods: (n, m) that it took to get near.
    """

    omega: float
    history: str
    x: Array
    v: Array
    orbits: Orbits
    ends: Whole
    periods: Whole

    @property
    def shares(self) -> list[float]:
        """Part of the starts that ends in each orbit."""
        return [float(np.mean(self.ends == k)) for k in range(len(self.orbits))]

    @property
    def elsewhere(self) -> float:
        """Part of the starts that ends in none of them."""
        return float(np.mean(self.ends < 0))

    def table(self) -> dict[str, Any]:
        """Return columns with one row per start; alpha is NaN where it ends in no known orbit."""
        x, v = np.meshgrid(self.x, self.v, indexing="ij")
        alphas = np.array([*(orbit.amplitude(3) for orbit, _ in self.orbits), np.nan])
        columns = {"x": x, "v": v, "orbit": self.ends, "alpha": alphas[self.ends], "periods": self.periods}
        return {name: np.ravel(values) for name, values in columns.items()}

    def as_object(self) -> dict[str, Any]:
        """Return what JSON shows."""
        return {
            "omega": self.omega,
            "history": self.history,
            "x": self.x.tolist(),
            "v": self.v.tolist(),
            "orbits": [
                {"alpha": o.amplitude(3), "stable": stable, "x": state(o)[0], "v": state(o)[1], "share": share}
                for (o, stable), share in zip(self.orbits, self.shares, strict=True)
            ],
            "elsewhere": self.elsewhere,
            "ends": self.ends.tolist(),
        }


def state(orbit: Orbit) -> tuple[float, float]:
    """Return displacement and velocity of an orbit at phase 0."""
    k = np.arange(1, orbit.order + 1)
    return float(orbit.coefficients[: orbit.order + 1].sum()), float(
        orbit.omega * k @ orbit.coefficients[orbit.order + 1 :]
    )


def basins(
    pair: GearPair,
    omega: float,
    x: Array,
    v: Array,
    orbits: Sequence[tuple[Orbit, bool]],
    *,
    slope: float | None = None,
    history: str = "constant",
    periods: int = MOST_PERIODS,
    workers: int | None = None,
    say: Callable[[int, int], None] = lambda _done, _total: None,
) -> Basins:
    """Integrate from every point of a grid until it is clear where it ends.

    Args:
        pair: the gear pair; omega: nu; x, v: axes of the grid.
        orbits: known at that frequency, from `exact.orbits_at`; where starts end elsewhere, more are looked for.
        slope: of a true backlash in the place of the cubic; history: of HISTORIES.
        periods: at most; workers: threads, as many as cores by default.
        say: told how many starts are done, of how many.

    Raises:
        InputError: an unknown history, or numbers out of range.
    """
    if history not in HISTORIES:
        raise InputError("--history", " or ".join(HISTORIES), history)
    if x.size * v.size > MOST_STARTS:
        raise InputError("--basin", f"at most {MOST_STARTS} starts", str(x.size * v.size))
    if periods < BLOCK:
        raise InputError("--periods", f"at least {BLOCK} for --basin", str(periods))
    count = len(os.sched_getaffinity(0)) if workers is None else workers
    if count < 1:
        raise InputError("--workers", "at least 1", str(count))
    step = stepper(pair, omega, slope, STEPS_PER_PERIOD["cubic" if slope is None else "backlash"])
    starts = np.stack(np.meshgrid(x, v, indexing="ij"), axis=-1).reshape(-1, 2)
    targets = _targets(orbits)
    chunks = [starts[k : k + LANES] for k in range(0, len(starts), LANES)]
    ended: list[_Ended] = []
    with ThreadPoolExecutor(count) as threads:
        work = (threads.submit(_run, step, _history(step, pair, chunk, history), targets, periods) for chunk in chunks)
        for future in list(work):
            ended.append(future.result())
            say(min(len(ended) * LANES, len(starts)), len(starts))
    ends = np.concatenate([part.ends for part in ended])
    known, ends = _further(
        pair, omega, slope, tuple(orbits), ends, np.concatenate([part.last for part in ended], axis=1)
    )
    shape = (x.size, v.size)
    taken = np.concatenate([part.periods for part in ended]).reshape(shape)
    return Basins(omega, history, x, v, known, ends.reshape(shape), taken)


@dataclass(frozen=True, eq=False)
class _Targets:
    """Stable orbits: their indices, (PHASES, orbits) displacements, and how near is arrived."""

    indices: Whole
    x: Array
    near: Array


@dataclass(frozen=True, eq=False)
class _Ended:
    """Where lanes ended (index or -1), after how many periods, and the last period (steps, k) of the k that didn't."""

    ends: Whole
    periods: Whole
    last: Array


def _at_phases(orbit: Orbit) -> Array:
    return orbit.at(2.0 * np.pi / orbit.omega * np.arange(PHASES) / PHASES)


def _targets(orbits: Sequence[tuple[Orbit, bool]]) -> _Targets:
    every = [_at_phases(orbit) for orbit, _ in orbits]
    indices = [k for k, (_, stable) in enumerate(orbits) if stable]
    near = []
    for k in indices:
        others = [float(np.max(np.abs(every[k] - other))) for j, other in enumerate(every) if j != k]
        near.append(NEAR * min(others, default=float(np.max(np.abs(every[k])))))
    wanted = np.stack([every[k] for k in indices], axis=1) if indices else np.zeros((PHASES, 0))
    return _Targets(np.array(indices, dtype=np.int64), wanted, np.array(near))


def _history(step: Stepper, pair: GearPair, starts: Array, kind: str) -> tuple[Array, Array, Array]:
    """Return the histories of some starts (n, 2)."""
    x0, v0 = starts.T
    if kind == "constant":
        rows = (step.back + 1, len(starts))
        x, v = np.broadcast_to(x0, rows).copy(), np.zeros(rows)
        v[-1] = v0
        return x, v, np.zeros(rows)
    angle = pair.w0 * step.h * np.arange(-step.back, 1)[:, None]
    x = x0 * np.cos(angle) + v0 / pair.w0 * np.sin(angle)
    v = v0 * np.cos(angle) - x0 * pair.w0 * np.sin(angle)
    return x, v, -(pair.w0**2) * x


def _run(step: Stepper, history: tuple[Array, Array, Array], targets: _Targets, periods: int) -> _Ended:
    """Integrate lanes until each has been near the same orbit at two looks running, leaving out those that are done."""
    count = history[0].shape[1]
    ends, taken = np.full(count, -1, dtype=np.int64), np.full(count, periods, dtype=np.int64)
    before, lanes = np.full(count, -1, dtype=np.int64), np.arange(count)
    period = history[0][:0]
    done = 0
    while len(lanes) and done + BLOCK <= periods:
        history = advance(step, history, BLOCK)
        done += BLOCK
        period = history[0][-step.steps - 1 : -1]
        here = _nearest(period, targets)
        arrived = (here >= 0) & (here == before[lanes])
        before[lanes] = here
        ends[lanes[arrived]], taken[lanes[arrived]] = targets.indices[here[arrived]], done
        lanes, period = lanes[~arrived], period[:, ~arrived]
        if arrived.any():
            history = (history[0][:, ~arrived], history[1][:, ~arrived], history[2][:, ~arrived])
    return _Ended(ends, taken, period)


def _nearest(period: Array, targets: _Targets) -> Whole:
    """Return for each lane which target its last period is near, -1 for none."""
    places = np.round(np.arange(PHASES) / PHASES * len(period)).astype(int)
    seen = period[places]
    found = np.full(period.shape[1], -1, dtype=np.int64)
    for k, near in enumerate(targets.near):
        found[np.max(np.abs(seen - targets.x[:, k : k + 1]), axis=0) < near] = k
    return found


def _further(
    pair: GearPair, omega: float, slope: float | None, known: Orbits, ends: Whole, last: Array
) -> tuple[Orbits, Whole]:
    """Look for stable orbits of the excitation's period among the motions that ended nowhere, (steps, k) in `last`."""
    balance = balance_of(pair, slope)
    lost = np.flatnonzero(ends < 0)
    ends = ends.copy()
    untried = np.ones(len(lost), dtype=bool)
    for _ in range(ATTEMPTS):
        left = np.flatnonzero(untried)
        if len(left) == 0:
            break
        untried[left[0]] = False
        try:
            orbit = balance.solve(omega, project(last[:, left[0]], balance.order))
        except NoOrbit:
            continue
        if not is_stable(balance, orbit):
            continue
        targets = _targets([*known, (orbit, True)])
        own = replace(targets, indices=targets.indices[-1:], x=targets.x[:, -1:], near=targets.near[-1:])
        near = left[_nearest(last[:, left], own) >= 0]
        new = min((float(np.max(np.abs(_at_phases(orbit) - _at_phases(o)))) for o, _ in known), default=1.0) > 1e-6
        if len(near) and new:
            ends[lost[near]], untried[near] = len(known), False
            known = (*known, (orbit, True))
    return known, ends
