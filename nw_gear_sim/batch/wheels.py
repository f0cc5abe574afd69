"""Gears and bearings of many points at once: springs along the shafts, and the step of every motion.

The springs are those of `physics.spring`. Motions are sorted for straight loops: first the x, y, z of the shafts, the
first part of every shaft and direction, then the second and so on; then one end of every torsion spring, then the
other. A motion that stays at rest fills the gaps.
"""

from __future__ import annotations

from typing import NamedTuple

from nw_gear_common.tables import Array
from nw_gear_sim.batch.lanes import LANES, exact, of
from nw_gear_sim.compiled import apart

CHAINS = 14
"""Shafts times directions: three planets and the sun with x, y, z, the output shaft with x, y."""
TWISTS = 5
"""Torsion springs: three planets, the sun, the generator."""
MOTIONS = 4 * CHAINS + 2 * TWISTS


class WheelLaw(NamedTuple):
    """Constants; tables read by `lanes.of`.

    Attributes:
        spring: between neighbours on a shaft, N/m, (3 CHAINS).
        aa, ab, bb: of the torsion springs, as in `physics.spring`, (TWISTS).
        load: constant forces, N, flat (MOTIONS, lanes).
        decay, gain, lag: of the step, see `step_wheels`, (MOTIONS).
    """

    spring: Array
    aa: Array
    ab: Array
    bb: Array
    load: Array
    decay: Array
    gain: Array
    lag: Array


@apart
def set_spring_forces(law: WheelLaw, led: Array, force: Array) -> None:
    """Set the forces of springs and constant loads on all motions (N), by `led` of `step_wheels`, flat."""
    row = CHAINS * LANES
    for c in range(CHAINS):
        for lane in range(LANES):
            i = c * LANES + lane
            first, second, third, fourth = led[i], led[i + row], led[i + 2 * row], led[i + 3 * row]
            a = exact(of(law.spring, c, lane), first - second)
            b = exact(of(law.spring, c + CHAINS, lane), second - third)
            d = exact(of(law.spring, c + 2 * CHAINS, lane), third - fourth)
            force[i] = law.load[i] - a
            force[i + row] = law.load[i + row] + a - b
            force[i + 2 * row] = law.load[i + 2 * row] + b - d
            force[i + 3 * row] = law.load[i + 3 * row] + d
    for t in range(TWISTS):
        for lane in range(LANES):
            i = 4 * row + t * LANES + lane
            k = i + TWISTS * LANES
            force[i] = law.load[i] - of(law.aa, t, lane) * led[i] + of(law.ab, t, lane) * led[k]
            force[k] = law.load[k] + of(law.ab, t, lane) * led[i] - of(law.bb, t, lane) * led[k]


@apart
def step_wheels(law: WheelLaw, force: Array, x: Array, moved: Array, led: Array) -> None:
    """Move all motions by one step, in place: d' = decay d + gain F, x' = x + d'.

    Args:
        law: constants.
        force: N; x, moved: displacements and those of the last step (d), m; flat.
        led: x + beta v for springs of damping time beta, m, with v = (3 d' - d) / (2 h) extrapolated.
    """
    for row in range(0, MOTIONS, 2):
        for lane in range(LANES):
            i, k = row * LANES + lane, row * LANES + LANES + lane
            before, before_2 = moved[i], moved[k]
            d = exact(of(law.decay, row, lane), before) + of(law.gain, row, lane) * force[i]
            d_2 = exact(of(law.decay, row + 1, lane), before_2) + of(law.gain, row + 1, lane) * force[k]
            place, place_2 = x[i] + d, x[k] + d_2
            moved[i], moved[k] = d, d_2
            x[i], x[k] = place, place_2
            led[i] = place + of(law.lag, row, lane) * (3.0 * d - before)
            led[k] = place_2 + of(law.lag, row + 1, lane) * (3.0 * d_2 - before_2)
