"""Many parameter points of the gearbox integrated at once, for sweeps."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_sim.assembly import start_phases
from nw_gear_sim.batch.beginning import begin, resting_state
from nw_gear_sim.batch.blocks import new_samples, new_state, new_strobe, new_work, with_room
from nw_gear_sim.batch.constants import block_laws
from nw_gear_sim.batch.lanes import LANES
from nw_gear_sim.batch.meshes import STAGE
from nw_gear_sim.batch.points import Point, make_points, ring_keys
from nw_gear_sim.batch.rest import TOLERANCE
from nw_gear_sim.batch.results import End, Span
from nw_gear_sim.batch.stepping import Laws, Samples, State, Strobe, Work, advance
from nw_gear_sim.equilibrium import NoEquilibrium
from nw_gear_sim.params import Configuration

T = TypeVar("T")

LARGEST_DISPLACEMENT = 0.05
"""A point diverges where a displacement leaves +- this, m."""
SECTIONS = ("own", *names.STAGES)
"""Where Poincare points are taken: at the mesh phase of the mesh's own stage, or of one stage for all."""
STARTS = ("equilibrium", "zero")
LEAST_PERIOD = 4
"""Steps in the period of a Poincare section."""


@dataclass(frozen=True, eq=False)
class _Block:
    """LANES points with their memory; the last one is repeated where there are fewer."""

    points: slice
    laws: Laws
    state: State
    work: Work
    strobe: Strobe


class Batch:
    """Integrates many points with the same step by the two-step Gautschi / Stoermer-Verlet scheme, in SIMD lanes.

    The ring is held in its modes in the frame of the meshes (see `pairs`): its displacement between two segments is
    interpolated by trigonometric functions instead of a blend of both, and the passing of segments excites nothing.
    Speed and torque of a point are those of its configuration and constant. A point's results depend neither on the
    others nor on the number of threads.

    Args:
        configurations: of the points; every number may differ but the ring's segments, the rollers of the bearings and
            their exponent, numerics.step and numerics.ring. `numerics.integrator` isn't looked at.
        excitation: `kinematic` or `tied`; None: as the configurations say.
        ring: `flexible` or `rigid`; None: as the configurations say.
        step: of time, s; None: numerics.step.
        sample_rate: of the waveform, Hz; None: no waveform.
        section: of SECTIONS.
        start: `equilibrium`: each point at rest in its static equilibrium; `zero`: all displacements and velocities
            zero, as in the paper; or the end of another batch.
        threads: None: as many as processors may be used.

    Raises:
        InputError: a wrong argument, a value that has to be the same in all points, a step that is too long.
        NoEquilibrium: a point has no static equilibrium.
    """

    def __init__(
        self,
        configurations: Sequence[Configuration],
        *,
        excitation: str | None = None,
        ring: str | None = None,
        step: float | None = None,
        sample_rate: float | None = None,
        section: str = "own",
        start: End | str = "equilibrium",
        threads: int | None = None,
    ) -> None:
        if not configurations:
            raise InputError("configurations", "at least one point", "none")
        self.size = len(configurations)
        self.step = _same("numerics.step", [c.numerics.time_step for c in configurations]) if step is None else step
        self._every = _every(self.step, sample_rate)
        ring = ring or _same("numerics.ring", [c.numerics.ring for c in configurations])
        excitation = excitation or _same("excitation.mode", [c.excitation.mode for c in configurations])
        for place, value, known in (
            ("ring", ring, ("flexible", "rigid")),
            ("excitation", excitation, ("kinematic", "tied")),
            ("section", section, SECTIONS),
            ("start", start if isinstance(start, str) else STARTS[0], STARTS),
        ):
            if value not in known:
                raise InputError(place, " or ".join(known), value)
        self.threads = len(os.sched_getaffinity(0)) if threads is None else threads
        if self.threads < 1:
            raise InputError("threads", "at least 1", str(threads))
        points = make_points(configurations, excitation, ring)
        self.speed = np.array([point.speed for point in points])
        self._keys = ring_keys(points)
        self._angle = start.angle if isinstance(start, End) else np.zeros(self.size)
        if isinstance(start, End):
            self._refuse(start)
        self._phase_ratio = np.array([point.laws.phase_ratio for point in points])
        self._steps = 0
        self._diverged = np.full(self.size, np.nan)
        self._blocks = [
            self._block(points, slice(k, min(k + LANES, self.size)), section, start) for k in range(0, self.size, LANES)
        ]

    @property
    def time(self) -> float:
        """Seconds since the batch began."""
        return self._steps * self.step

    def period(self, stage: str) -> Array:
        """Return the mesh period of a stage (names.STAGES), s, (points,); inf at standstill."""
        if stage not in names.STAGES:
            raise InputError("stage", " or ".join(names.STAGES), stage)
        rate = self._phase_ratio[:, names.STAGES.index(stage)] * self.speed
        with np.errstate(divide="ignore"):
            return np.asarray(2 * math.pi / rate)

    def advance(self, seconds: float | None = None, *, periods: float | None = None, stage: str = "II") -> Span:
        """Integrate all points over the same time.

        Args:
            seconds: how long; rounded to whole steps.
            periods: instead, mesh periods of a stage, at the slowest point; points that turn faster see more.
            stage: whose periods.

        Raises:
            InputError: not one of seconds and periods, less than a step, or periods at standstill.
        """
        if (seconds is None) == (periods is None):
            raise InputError("advance", "either seconds or periods", "both" if periods is not None else "neither")
        length = seconds if seconds is not None else (periods or 0.0) * float(np.max(self.period(stage)))
        if not (math.isfinite(length) and round(length / self.step) >= 1):
            raise InputError("advance", f"a time of at least a step ({self.step:g} s)", f"{length:g} s")
        steps = round(length / self.step)
        with ThreadPoolExecutor(min(self.threads, len(self._blocks))) as pool:
            parts = list(pool.map(lambda block: self._run(block, steps), self._blocks))
        span = self._collect(parts, steps)
        self._steps += steps
        return span

    def end(self) -> End:
        """Return where the points are now."""
        parts: dict[str, Array] = {}
        for name in ("x", "moved", "led", "z", "y", "y_moved", "y_before", "force"):
            rows = [_part(b.state, name).reshape(-1, LANES)[:, : b.points.stop - b.points.start] for b in self._blocks]
            parts[name] = np.hstack(rows)
        angle = np.mod(self._angle + self.speed * self.time, 2 * math.pi)
        return End(parts, angle, self._keys, self.step)

    def _refuse(self, start: End) -> None:
        count = start.angle.shape[0]
        if count != self.size:
            raise InputError("start", f"{self.size} points", str(count))
        if start.step != self.step:
            raise InputError("start", f"a batch with the same step ({self.step:g} s)", f"{start.step:g} s")
        if start.pairs != self._keys:
            raise InputError("start", "a batch with the same modes of the ring", "other ones")

    def _block(self, points: list[Point], part: slice, section: str, start: End | str) -> _Block:
        filled = [min(k, part.stop - 1) for k in range(part.start, part.start + LANES)]
        own = [points[k] for k in filled]
        angle = self._angle[filled]
        laws = block_laws(own, self.step, angle, self._keys)
        if start == "zero":
            state = new_state(laws)
            begin(laws, state)
        elif not isinstance(start, End):
            state, residual = resting_state(laws)
            for lane in np.flatnonzero(~(residual <= TOLERANCE)):
                raise NoEquilibrium(f"point {filled[lane]} has no static equilibrium: {residual[lane]:.3g} N are left")
        else:
            state = new_state(laws)
            for name, values in start.parts.items():
                _part(state, name)[:] = values[:, filled].ravel()
        return _Block(part, laws, state, new_work(), self._strobe(own, angle, section))

    def _strobe(self, points: list[Point], angle: Array, section: str) -> Strobe:
        first, period = np.zeros((7, LANES)), np.zeros((7, LANES))
        for lane, point in enumerate(points):
            for mesh, own in enumerate(STAGE):
                stage = own if section == "own" else names.STAGES.index(section)
                ratio = point.laws.phase_ratio[stage]
                advanced = ratio * point.speed * self.step / (2 * math.pi)
                if advanced <= 0.0:
                    continue
                if advanced * LEAST_PERIOD > 1:
                    wanted = f"at most {self.step / (advanced * LEAST_PERIOD):.3g} s, a quarter of a mesh period"
                    raise InputError("step", wanted, f"{self.step:g} s")
                turns = (ratio * angle[lane] + start_phases(point.kinematics)[stage]) / (2 * math.pi)
                period[mesh, lane] = 1 / advanced
                first[mesh, lane] = (math.floor(turns) + 1 - turns) / advanced
                if first[mesh, lane] < 1:
                    first[mesh, lane] += period[mesh, lane]
        return new_strobe(first, period)

    def _run(self, block: _Block, steps: int) -> tuple[_Block, Strobe, Samples, npt.NDArray[np.int64]]:
        strobe = with_room(block.strobe, steps)
        samples = new_samples(int(block.state.step[0]), steps, self._every)
        passed = block.strobe.passed.copy()
        block.state.mesh.open[:] = 0.0
        block.state.mesh.back[:] = 0.0
        advance(block.laws, block.state, block.work, strobe, samples, steps, self.step, LARGEST_DISPLACEMENT)
        return block, strobe, samples, passed

    def _collect(self, parts: list[tuple[_Block, Strobe, Samples, npt.NDArray[np.int64]]], steps: int) -> Span:
        most = max(int(strobe.found.max()) for _, strobe, _, _ in parts)
        section = np.full((3, self.size, 7, most), np.nan)
        begin = -(-self._steps // self._every) if self._every else 0
        count = len(parts[0][2].x)
        time = (begin + np.arange(count)) * self._every * self.step
        waves, shares = np.empty((2, self.size, count, 7)), np.empty((2, self.size, 7))
        for block, strobe, samples, passed in parts:
            lanes = block.points.stop - block.points.start
            order = np.arange(most)[:, None, None]
            at = (strobe.first + (passed + order) * strobe.period) * self.step
            for k, values in enumerate((at, strobe.x, strobe.v)):
                shown = values[:most]
                there = np.arange(len(shown))[:, None, None] < strobe.found
                section[k, block.points, :, : len(shown)] = np.where(there, shown, np.nan)[..., :lanes].transpose(
                    2, 1, 0
                )
            for k, wave in enumerate((samples.x, samples.force)):
                waves[k, block.points] = wave.reshape(count, 7, LANES)[..., :lanes].transpose(2, 0, 1)
            for k, total in enumerate((block.state.mesh.open, block.state.mesh.back)):
                shares[k, block.points] = total.reshape(7, LANES)[:, :lanes].T / steps
            seen = block.state.diverged[:lanes]
            self._diverged[block.points] = np.where(seen >= 0, seen * self.step, np.nan)
        span = Span(
            start=self.time,
            end=(self._steps + steps) * self.step,
            section_time=section[0],
            section_x=section[1],
            section_v=section[2],
            time=np.asarray(time),
            x=waves[0],
            force=waves[1],
            open_fraction=shares[0],
            back_fraction=shares[1],
            diverged=self._diverged.copy(),
        )
        return _without_diverged(span)


def _without_diverged(span: Span) -> Span:
    for point in np.flatnonzero(np.isfinite(span.diverged)):
        gone = span.diverged[point]
        lost = ~(span.section_time[point] < gone)
        for values in (span.section_time, span.section_x, span.section_v):
            values[point][lost] = np.nan
        for wave in (span.x, span.force):
            wave[point][span.time >= gone] = np.nan
        if gone <= span.start:
            span.open_fraction[point] = span.back_fraction[point] = np.nan
    return span


def _part(state: State, name: str) -> Array:
    mesh = state.mesh
    known = {"y": mesh.y, "y_moved": mesh.moved, "y_before": mesh.before, "force": mesh.force}
    part: Array = known[name] if name in known else getattr(state, name)
    return part


def _same(place: str, values: Sequence[T]) -> T:
    for value in values:
        if value != values[0]:
            raise InputError(place, f"the same value in all points of a batch ({values[0]})", str(value))
    return values[0]


def _every(step: float, sample_rate: float | None) -> int:
    if not (math.isfinite(step) and step > 0):
        raise InputError("step", "a time above 0 s", f"{step:g} s")
    if sample_rate is None:
        return 0
    ratio = 1 / (step * sample_rate) if sample_rate > 0 else 0.0
    if round(ratio) < 1 or abs(ratio - round(ratio)) > 1e-9 * ratio:
        raise InputError("sample_rate", f"1 / ({step:g} s) divided by a whole number", f"{sample_rate:g} Hz")
    return round(ratio)
