"""Responses of the whole gearbox at points of one axis: the meshing displacements over time, and what is read of them.

A piece of work is one block of the batch, as in a bifurcation study, whose judgement of periods and states is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import scipy.interpolate
import scipy.signal

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim import config
from nw_gear_sim.batch.lanes import LANES
from nw_gear_sim.kinematics import derive
from nw_gear_sim.nondimensional import Scales, scales
from nw_gear_sim.params import Configuration
from nw_gear_sim.studies import bifurcation
from nw_gear_sim.studies.bifurcation import Plan
from nw_gear_sim.studies.store import Store

SAMPLES_PER_PERIOD = {"tied": 32, "kinematic": 16}
"""Least number of samples in a period of the fastest mesh."""


@dataclass(frozen=True, eq=False)
class Piece:
    """Points that are computed together, and the rate of their samples, Hz."""

    plan: Plan
    configurations: tuple[Configuration, ...]
    rate: float


@dataclass(frozen=True, eq=False)
class Response:
    """How one mesh moves at one point.

    Attributes:
        value: of the axis; mesh: its name; mesh_frequency: with which it is excited, Hz; scales: b and omega_n.
        time: s from the beginning of the record, (n,); x: displacement, m, (n,); v: its rate, m/s, (n,).
        section_time, section_x, section_v: Poincare points, (k,).
    """

    value: float
    mesh: str
    mesh_frequency: float
    scales: Scales
    time: Array
    x: Array
    v: Array
    section_time: Array
    section_x: Array
    section_v: Array

    @property
    def rate(self) -> float:
        """Samples per second, Hz."""
        return float((len(self.time) - 1) / (self.time[-1] - self.time[0]))

    @property
    def whole(self) -> bool:
        """Whether the motion stayed within bounds."""
        return bool(np.isfinite(self.x).all())

    def spectrum(self) -> tuple[Array, Array]:
        """Return frequencies (Hz) and amplitudes (m) of the displacement about its mean."""
        return spectrum(self.x, self.rate)


def spectrum(x: Array, rate: float) -> tuple[Array, Array]:
    """Return frequencies (Hz) and amplitudes of a signal about its mean.

    A Hann window, 2 |X| / sum w: a sine shows its amplitude, at worst 15 % less between two frequencies.
    Source: Harris, Proc. IEEE 66 (1978) 51, Table 1 (scalloping loss 1.42 dB).

    Args:
        x: samples, (n,); rate: Hz.
    """
    window = scipy.signal.windows.hann(len(x), sym=False)
    amplitude = 2.0 * np.abs(np.fft.rfft(window * (x - x.mean()))) / window.sum()
    return np.asarray(np.fft.rfftfreq(len(x), 1.0 / rate)), np.asarray(amplitude)


def sample_rate(points: Sequence[Configuration], plan: Plan) -> float:
    """Return the rate of the waveforms of all points, Hz: a whole share of that of the steps."""
    fastest = max(frequency(c, "III", plan) for c in points)
    steps = 1.0 / plan.step
    return steps / max(1, int(steps / (SAMPLES_PER_PERIOD[plan.excitation] * fastest)))


def frequency(point: Configuration, stage: str, plan: Plan) -> float:
    """Return the mesh frequency of a stage, Hz: that of stage II for all where they are tied."""
    kinematics = derive(point)
    return kinematics.mesh_frequency_hz("II" if plan.excitation == "tied" else stage, kinematics.ring_speed)


def blocks(points: Sequence[Configuration], plan: Plan) -> dict[str, Piece]:
    """Return independent pieces, by key."""
    rate = sample_rate(points, plan)
    return {f"points-{k:06d}": Piece(plan, tuple(points[k : k + LANES]), rate) for k in range(0, len(points), LANES)}


def compute(piece: Piece) -> dict[str, Array]:
    """Compute the points of a piece.

    Returns:
        what `bifurcation.compute` gives but the end; `section_time` (points, 7, n), s; `wave_x` (points, samples, 7),
        m; `wave_time` (samples,), s. All times count from the beginning of the record.
    """
    plan = piece.plan
    batch = bifurcation.begin(bifurcation.Piece(plan, piece.configurations), piece.rate)
    if plan.transient:
        batch.advance(periods=plan.transient, stage=plan.stage)
    span = batch.advance(periods=plan.record, stage=plan.stage)
    return {
        **bifurcation.readings(span),
        **bifurcation.exponents(batch, list(piece.configurations), plan),
        "section_time": span.section_time - span.start,
        "wave_time": span.time - span.start,
        "wave_x": span.x,
    }


def describe(base: Configuration, key: str, values: Array, plan: Plan) -> dict[str, Any]:
    """Return what a store has to know to tell this study from another."""
    return {
        "study": "response",
        "configuration": config.to_yaml(base),
        "axes": {key: values.tolist()},
        "plan": asdict(plan),
    }


def responses(
    store: Store, key: str, points: Sequence[Configuration], values: Array, plan: Plan, meshes: Sequence[str]
) -> Iterator[Response]:
    """Yield the responses of one finished piece, point by point and mesh by mesh."""
    arrays, first = store.get(key), int(key.split("-")[1])
    for k in range(len(arrays["wave_x"])):
        for mesh in meshes:
            yield _response(arrays, k, float(values[first + k]), points[first + k], plan, mesh)


def _response(
    arrays: Mapping[str, Array], k: int, value: float, point: Configuration, plan: Plan, mesh: str
) -> Response:
    m = names.MESHES.index(mesh)
    time = arrays["wave_time"]
    period = 1.0 / frequency(point, plan.stage, plan)
    shown = time < time[0] + plan.record * period * (1.0 - 1e-9)  # faster points than the slowest have a longer record
    time, x = time[shown], arrays["wave_x"][k, shown, m]
    there = np.isfinite(arrays["x"][k, m])
    section = (arrays[name][k, m][there] for name in ("section_time", "x", "v"))
    stage = names.STAGE_OF_MESH[mesh]
    return Response(
        value, mesh, frequency(point, stage, plan), scales(point, derive(point)), time, x, slope(time, x), *section
    )


def slope(time: Array, x: Array) -> Array:
    """Return dx/dt by a spline of fifth degree through the samples; NaN where the motion left its bounds.

    With 16 samples in a period the rate of a sine is right to 1e-4, but for the first and last few samples.
    """
    if not np.isfinite(x).all():
        return np.full(len(x), np.nan)
    return np.asarray(scipy.interpolate.make_interp_spline(time, x, k=5).derivative()(time))
