"""From what a window shows to a stage's state: label, reason; and the three windows in a row that make it stick."""

from __future__ import annotations

import math
from dataclasses import dataclass

from nw_gear_common import names

REGULAR_RHO = 0.05
CHAOTIC_RHO = 0.10
CHAOTIC_K = 0.8
TONAL = 0.6
NO_LINES_RHO = 0.9
"""With more than this outside known lines there is no gear motion in the signal; forced chaos keeps its mesh lines."""
LEAST_SECONDS = 8
IN_A_ROW = 3
LEAST_DEVIATION = 1e-12
LEAST_RELATIVE_DEVIATION = 1e-9
"""A standard deviation below 1 pm, or below this share of the largest value, is no vibration but rounding."""
SPREAD_LIMIT = 0.3
RATE_LIMIT = 0.05
"""Speed spread of the window, and fastest relative change (1/s), above which a large residual tells nothing of chaos.

Measured on the simulated gearbox: a regular one reached rho = 0.08 in stage II when speed changed by 7 % a second
across a weakly damped mode, and stayed under 0.03 up to 4 % a second (Weibull wind); a rattling one kept 0.27 at 3.5 %
a second. A small residual needs no such limit: it proves itself.
"""


@dataclass(frozen=True)
class Evidence:
    """What one window shows of one stage.

    Attributes:
        seconds: length of the window, s.
        rho: residual over total variance after the lines.
        tau, k: tonal share of the residual, and 0-1 test of its strobes; NaN where rho is too small for them to mean
            anything.
        subharmonic_stage, subharmonic_order: the accepted f_s / n; "" and 1 for none.
        subharmonic_share: its share of this stage's variance.
        unlisted_order: mesh order of the strongest line of the residual (folded at the strobe rate), 0 for none.
        deviation: standard deviation without trend, m.
        level: largest |x|, m.
        speed_spread, load_spread: (largest - smallest) / mean over the window.
        speed_rate: fastest relative change of speed, 1/s.
        lines: number of lines fitted.
    """

    seconds: int
    rho: float
    tau: float
    k: float
    subharmonic_stage: str
    subharmonic_order: int
    subharmonic_share: float
    unlisted_order: float
    deviation: float
    level: float
    speed_spread: float
    speed_rate: float
    load_spread: float
    lines: int


@dataclass(frozen=True)
class State:
    """A label of the vocabulary, and why."""

    label: str
    reason: str


def judge(stage: str, evidence: Evidence) -> State:
    """Give one window's label, before any memory of earlier ones."""
    e = evidence
    if not math.isfinite(e.rho) or e.deviation < max(LEAST_DEVIATION, LEAST_RELATIVE_DEVIATION * e.level):
        return State(names.UNKNOWN, "no vibration")
    if e.rho < REGULAR_RHO:
        return _periodic(stage, e)
    if e.speed_spread > SPREAD_LIMIT or e.speed_rate > RATE_LIMIT:
        change = f"{100 * e.speed_spread:.0f} % within {e.seconds} s, up to {100 * e.speed_rate:.1f} % a second"
        return State(names.TRANSIENT, f"speed changed by {change}, too much to judge the residual")
    return _irregular(e)


def _irregular(e: Evidence) -> State:
    share = f"{100 * e.rho:.0f} % of the variance outside known lines"
    if e.tau > TONAL:
        return State(names.QUASI_PERIODIC, f"{share}, most of it in lines; strongest at order {e.unlisted_order:.4g}")
    if e.rho > NO_LINES_RHO:
        return State(names.UNKNOWN, f"no mesh lines: {share}")
    if e.rho > CHAOTIC_RHO and e.k > CHAOTIC_K:
        return State(names.CHAOTIC, f"irregular: {share}, broadband")
    return State(names.UNKNOWN, f"undecided: {share}")


def _periodic(stage: str, e: Evidence) -> State:
    explained = f"{100 * (1 - e.rho):.1f} % of the variance in known lines"
    if e.subharmonic_order == 1:
        return State(names.PERIODS[0], explained)
    line = f"f_{e.subharmonic_stage}/{e.subharmonic_order}"
    if e.subharmonic_stage == stage:
        own = f"{100 * e.subharmonic_share:.1f} % at multiples of {line}"
        return State(names.PERIODS[e.subharmonic_order - 1], f"{explained}; {own}")
    return State(names.PERIODS[0], f"{explained}; {line} transmitted from stage {e.subharmonic_stage}")


class Persistence:
    """Lets a label change only after it was seen in IN_A_ROW windows in a row.

    Until then the old label stays, but no longer than IN_A_ROW windows that say something else: then it is `unknown`.
    """

    def __init__(self) -> None:
        self.shown = State(names.UNKNOWN, "no window yet")
        self._seen: list[str] = []

    def reset(self, state: State) -> State:
        """Show a state at once and forget what was seen (gap, standstill)."""
        self._seen = []
        self.shown = state
        return state

    def add(self, state: State) -> State:
        """Take in one window's state and return the one to show."""
        self._seen = [*self._seen[1 - IN_A_ROW :], state.label]
        if state.label == self.shown.label or self._seen.count(state.label) == IN_A_ROW:
            self.shown = state
        elif self.shown.label not in self._seen and len(self._seen) == IN_A_ROW:
            self.shown = State(names.UNKNOWN, f"undecided between windows: {', '.join(self._seen)}")
        elif self.shown.label == names.UNKNOWN:
            self.shown = State(names.UNKNOWN, f"{state.label} in {self._seen.count(state.label)} of {IN_A_ROW} windows")
        return self.shown
