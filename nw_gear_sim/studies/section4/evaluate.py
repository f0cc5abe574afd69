"""Computes what is needed to judge the motions of one parameter set: one block of the batch, what is kept of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from nw_gear_common import names
from nw_gear_common.tables import Array
from nw_gear_sim import config
from nw_gear_sim.batch.batch import Batch
from nw_gear_sim.equilibrium import NoEquilibrium
from nw_gear_sim.kinematics import derive
from nw_gear_sim.params import Configuration
from nw_gear_sim.studies import bifurcation
from nw_gear_sim.studies.bifurcation import Plan
from nw_gear_sim.studies.exponents import largest_exponents

MESHES = tuple(names.MESHES.index(mesh) for mesh in ("I_1", "II_1", "III"))
"""The paper's x_n1, x_n2, x_n3: of planet 1 where a stage has three meshes."""
PLAN = Plan(transient=200, record=200, exponent_periods=16)
INTERVALS = 8
"""Pulls of the twins: few and far apart, since putting a block together costs as much as a hundred periods."""


@dataclass(frozen=True, eq=False)
class Labelled:
    """Frequencies whose motions are to be labelled.

    Attributes:
        plan: as for a bifurcation diagram; configuration: all but the frequency; omega_e: up to a block of them.
        seconds: of transient instead of the plan's periods, where above 0.
    """

    plan: Plan
    configuration: Configuration
    omega_e: tuple[float, ...]
    seconds: float = 0.0


def at(configuration: Configuration, omega_e: tuple[float, ...]) -> tuple[Configuration, ...]:
    """Return the configuration at each frequency."""
    return tuple(config.with_values({"excitation.omega_e": omega}, configuration) for omega in omega_e)


def label(piece: Labelled) -> dict[str, Array]:
    """Compute the motions of a piece.

    Returns:
        `omega_e` (points,), `rate`, `error`, `diverged` (points,) as `bifurcation.compute` has them; `period`,
        `settled`, `deviation`, `open` (points, 3) of MESHES; `x` (points, 3, n), m, their sections. Motions begin in
        static equilibrium, and with zero displacements, as in the paper, where none is found. Where all diverge, the
        step is too long for the set's dampers, and half of it is taken.
    """
    points = at(piece.configuration, piece.omega_e)
    plan = piece.plan
    if piece.seconds > 0.0:
        plan = replace(plan, transient=_periods(points, plan.stage, piece.seconds))
    recorded = replace(plan, exponent_periods=0)
    try:
        found = bifurcation.compute(bifurcation.Piece(recorded, points))
    except NoEquilibrium:
        zero = Batch(points, excitation=plan.excitation, ring=plan.ring, step=plan.step, start="zero", threads=1).end()
        found = bifurcation.compute(bifurcation.Piece(recorded, points, zero))
    if np.all(np.isfinite(found["diverged"])) and plan.step >= PLAN.step:
        return label(replace(piece, plan=replace(plan, step=plan.step / 2)))
    chosen = list(MESHES)
    exponents = largest_exponents(
        points, bifurcation.carried(found, plan), excitation=plan.excitation, ring=plan.ring, step=plan.step,
        interval=_seconds(points, plan.stage, plan.exponent_periods), intervals=INTERVALS,
    )  # fmt: skip
    return {
        "omega_e": np.array(piece.omega_e), "diverged": found["diverged"],
        "rate": exponents.rate, "error": exponents.error,
        **{name: found[name][:, chosen] for name in ("period", "settled", "deviation", "open")},
        "x": found["x"][:, chosen].astype(np.float32),
    }  # fmt: skip


def _periods(points: tuple[Configuration, ...], stage: str, seconds: float) -> int:
    """Return the periods of a stage, at the slowest point, that take so long."""
    return round(seconds / _seconds(points, stage, 1))


def _seconds(points: tuple[Configuration, ...], stage: str, periods: int) -> float:
    """Return how long the slowest point takes for so many periods."""
    frequencies = [derive(c).mesh_frequency_hz(stage, derive(c).ring_speed) for c in points]
    return periods / min(frequencies)
