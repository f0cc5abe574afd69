"""Single teeth and gears that differ: cracked teeth, pitch errors, eccentricity.

A tooth is engaged for as many mesh cycles as the total contact ratio eps says. p cycles after it enters it carries the
share

    w(p) = S(p / (eps - 1)) - S((p - 1) / (eps - 1)),   S(u) = u - sin(2 pi u) / (2 pi) within [0, 1]

of the mesh: smooth, and the shares of all engaged teeth add up to 1. With share w it takes the same share of its own
deviation into the mesh: K is less by (loss w), e is more by (error w). An eccentric gear adds a wave once a turn to e
(Chaari et al. 2006 and 2008 for cracks and eccentricity in planetary gears: stiffness loss of the pair that holds the
tooth, sine of the shaft's angle).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nw_gear_common.tables import Array
from nw_gear_sim.compiled import kernel

ROWS = 32
"""Most deviations at once; a gear that meshes with three others takes three rows for each of its deviations."""

Indices = npt.NDArray[np.int64]


class ToothLaw(NamedTuple):
    """Rows of deviations, arrays of shape (ROWS,), changed in place; `used`, shape (1,), are in use.

    Attributes:
        mesh: 0..6; teeth: Z of the gear.
        tooth: number of the tooth that deviates most, counted as it enters this mesh; need not be whole.
        fade: eps - 1, cycles in which a tooth takes over the load.
        loss: of the tooth pair's stiffness, 0 to 1; error: deviation of the tooth, m; runout: of the gear, m.
    """

    used: Indices
    mesh: Indices
    teeth: Array
    tooth: Array
    fade: Array
    loss: Array
    error: Array
    runout: Array


def sound_teeth() -> ToothLaw:
    """Return rows of which none is in use."""
    teeth, tooth, fade, loss, error, runout = np.zeros((6, ROWS))
    return ToothLaw(np.zeros(1, np.int64), np.zeros(ROWS, np.int64), teeth, tooth, fade, loss, error, runout)


@kernel
def share(p: float, fade: float) -> float:
    """Share of the mesh that a tooth carries p cycles after it entered."""
    return float(_step(p / fade) - _step((p - 1.0) / fade))


@kernel
def share_slope(p: float, fade: float) -> float:
    """Derivative of `share` by p."""
    return float((_step_slope(p / fade) - _step_slope((p - 1.0) / fade)) / fade)


@kernel
def _step(u: float) -> float:
    if u <= 0.0:
        return 0.0
    if u >= 1.0:
        return 1.0
    return u - math.sin(2.0 * math.pi * u) / (2.0 * math.pi)


@kernel
def _step_slope(u: float) -> float:
    return 1.0 - math.cos(2.0 * math.pi * u) if 0.0 < u < 1.0 else 0.0


@kernel
def deviate(law: ToothLaw, row: int, phase: float, rate: float, excitation: Array) -> None:
    """Put one deviation into its mesh.

    Args:
        law: the rows; row: which.
        phase: mesh phase, 0 where tooth 0 enters, not folded, rad; rate: of it, rad/s.
        excitation: of the mesh: K (N/m), e (m), e' (m/s), two friction shares, K' by deviations (N/m/s), (6,).
    """
    teeth = law.teeth[row]
    cycles = phase / (2.0 * math.pi) - law.tooth[row]
    p = cycles - teeth * math.floor(cycles / teeth)
    per_second = rate / (2.0 * math.pi)
    if p < 1.0 + law.fade[row]:
        w, slope = share(p, law.fade[row]), share_slope(p, law.fade[row]) * per_second
        excitation[5] -= law.loss[row] * (excitation[0] * slope)
        excitation[0] *= 1.0 - law.loss[row] * w
        excitation[1] += law.error[row] * w
        excitation[2] += law.error[row] * slope
    if law.runout[row] != 0.0:
        turn = 2.0 * math.pi * p / teeth
        excitation[1] += law.runout[row] * math.cos(turn)
        excitation[2] -= law.runout[row] * math.sin(turn) * 2.0 * math.pi * per_second / teeth
