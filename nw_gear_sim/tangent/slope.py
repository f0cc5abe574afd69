"""Memory of the tangent of the equations of motion: the derivative of the forces, and the deviations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.integrator import etdrk4
from nw_gear_sim.modal.laws import ModalLaws

MESHES, PLANETS = 7, 3
"""Meshes, and those of the ring, which come first."""
UNKNOWN = -1.0
"""Whether a mesh carried before the first step."""


class Slope(NamedTuple):
    """Derivative of the forces, and k deviations; names with `flat` are the same memory with n k numbers in a row.

    Attributes:
        bearing: of the forces on the housings by the shafts' displacements, N/m, (bearings, 3, 3).
        row: of the ring's meshes: elongation by the modes, friction over elastic force, first by time (1/s),
            (3, 3, modes).
        carrying: whether a mesh carried when a step began, (7,); UNKNOWN before the first.
        here, stage: deviations of displacement and velocity at a step's start and in a stage, (2, n, k).
        push: forces per mass on them in each stage, (4, n, k).
        reach: deviations of a mesh's elongation and of its rate, (2, k).
        divergence: sum over the steps of the trace of the derivative of the motion, 1/s, (1,).
    """

    bearing: Array
    row: Array
    carrying: Array
    here: Array
    here_flat: Array
    stage: Array
    stage_flat: Array
    push: Array
    push_flat: Array
    reach: Array
    divergence: Array


def new_slope(laws: ModalLaws, count: int) -> Slope:
    """Return memory for `count` deviations."""
    n = len(laws.weight)
    here, stage, push = np.zeros((2, n, count)), np.zeros((2, n, count)), np.zeros((4, n, count))
    return Slope(
        bearing=np.zeros((len(laws.cage_wheel), 3, 3)),
        row=np.zeros((PLANETS, 3, len(laws.turn))),
        carrying=np.full(MESHES, UNKNOWN),
        here=here, here_flat=here.reshape(2, -1),
        stage=stage, stage_flat=stage.reshape(2, -1),
        push=push, push_flat=push.reshape(4, -1),
        reach=np.zeros((2, count)),
        divergence=np.zeros(1),
    )  # fmt: skip


def repeated(oscillators: etdrk4.Coefficients, count: int) -> etdrk4.Coefficients:
    """Return the integrator's coefficients for `count` deviations of each motion."""
    return etdrk4.Coefficients(*(np.repeat(part, count, axis=1) for part in oscillators))
