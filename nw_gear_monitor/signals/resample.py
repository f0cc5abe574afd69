"""Order tracking: a signal on equal steps of a shaft's phase instead of equal steps of time.

The signal is interpolated over phase by a spline of degree 5, the default, or 1 or 3. Its error falls as h^(degree + 1)
with the sample interval h; a sine of 10 samples a cycle comes out within 5e-6 of its amplitude at degree 5, 5e-4 at
degree 3 and 5e-2 at degree 1; one of 5 samples a cycle within 6e-4, 1e-2 and 0.2. At 2.5 samples a cycle even degree 5
is off by 16 %: what lies above a fifth of the sample rate comes out too small.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_interp_spline

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.signals import checked

TURN = 2.0 * np.pi
DEGREE = 5
DEGREES = (1, 3, 5)
LARGEST_SPEED_RATIO = 4.0
"""Fastest over mean speed, and mean over slowest, between two samples."""
LEAST_SAMPLES = 8
SLACK = 1e-9
"""Turns by which rounding may put a beginning or an end on the wrong side."""


@dataclass(frozen=True, eq=False)
class Turns:
    """A signal over whole turns.

    Attributes:
        values: (turns, per_turn); value [n, m] stands at phase 2 pi (first + n + m / per_turn).
        first: number of the first turn.
    """

    values: Array
    first: int

    @property
    def turns(self) -> int:
        """Number of turns."""
        return int(self.values.shape[0])

    @property
    def per_turn(self) -> int:
        """Points in a turn."""
        return int(self.values.shape[1])

    @property
    def flat(self) -> Array:
        """All points in a row, shape (turns * per_turn,)."""
        return self.values.reshape(-1)


def whole_turns(phase: Array, x: Array, *, per_turn: int | None = None, degree: int = DEGREE, least: int = 1) -> Turns:
    """Resample a signal to equal steps of phase over the whole turns that it holds.

    Turns begin at whole multiples of 2 pi of the phase, so that records of one machine line up with each other.

    Args:
        phase: (samples,) unwrapped phase of the shaft (or of a mesh: a turn is then a tooth pitch), rad.
        x: (samples,) any unit, sampled at equal steps of time.
        per_turn: points in a turn; None: the power of two that is no coarser than the samples where the shaft is
            slowest. Fewer than that fold high orders onto low ones.
        degree: of the spline, 1, 3 or 5.
        least: smallest number of turns.

    Raises:
        InputError: a signal or phase that can't be used (see `checked`), a speed that changes by more than
            LARGEST_SPEED_RATIO, too few whole turns.
    """
    x = checked.signal("x", x, LEAST_SAMPLES)
    phase = checked.phase("phase", phase, x.size)
    if degree not in DEGREES:
        raise InputError("degree", "1, 3 or 5", repr(degree))
    least = checked.whole("least", least, 1)
    points = _points(phase) if per_turn is None else checked.whole("per_turn", per_turn, 2)
    start, end = phase[0] / TURN, phase[-1] / TURN
    first = int(np.ceil(start - SLACK))
    turns = int(np.floor(end + 1.0 / points + SLACK)) - first
    if turns < least:
        raise InputError("phase", f"at least {least} whole turns", f"{max(turns, 0)} ({start:.6g} to {end:.6g} turns)")
    grid = TURN * (first + np.arange(turns * points) / points)
    spline = make_interp_spline(phase, x, k=degree)
    return Turns(np.asarray(spline(grid), dtype=np.float64).reshape(turns, points), first)


def _points(phase: Array) -> int:
    """The power of two that is no coarser than the samples at the slowest speed."""
    steps = np.diff(phase)
    slowest, mean, fastest = float(steps.min()), float(steps.mean()), float(steps.max())
    if mean > LARGEST_SPEED_RATIO * slowest or fastest > LARGEST_SPEED_RATIO * mean:
        raise InputError(
            "phase",
            f"a speed within a factor {LARGEST_SPEED_RATIO:g} of its mean",
            f"{slowest / mean:.3g} to {fastest / mean:.3g} of it",
        )
    return max(int(2 ** np.ceil(np.log2(TURN / slowest))), 2)
