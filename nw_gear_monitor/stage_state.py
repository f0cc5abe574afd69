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
LOAD_LIMIT = 1.5
"""Spread of load in the window, over its mean, above which the same holds.

Measured in a shutdown within 10 s: rho of stage II is under 0.01 up to a spread of 0.8 and 0.13 to 0.45 from 1.9 on,
where the load goes to zero and the teeth part once; a rattling gearbox keeps its label at 0.6.
"""
FORGETS = 0.05
"""r above which a motion doesn't repeat: regular ones at constant speed keep to 0.02, chaotic ones exceed 0.1."""
REPEATS_NOT = 0.10
"""r above which a motion isn't called regular though lines explain it, where speed and load are steady."""
STEADY_SPEED, STEADY_LOAD = 0.005, 0.05
"""Spreads up to which amplitudes stay as they are, so that r tells of repetition alone."""


@dataclass(frozen=True)
class Evidence:
    """What one window shows of one stage.

    Attributes:
        seconds: length of the window, s.
        rho: residual over total variance after the lines.
        noise: share of white noise in the variance (`indicators.noise_floor`), which is part of rho.
        repetition: r (`indicators.repetition`), NaN where the window doesn't reach back far enough.
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
    noise: float
    repetition: float
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

    @property
    def irregular(self) -> float:
        """Share of the variance outside known lines that isn't white noise."""
        return max(self.rho - self.noise, 0.0)

    @property
    def remembered(self) -> float:
        """What of r isn't white noise."""
        return max(self.repetition - self.noise, 0.0) if math.isfinite(self.repetition) else math.nan

    @property
    def steady(self) -> bool:
        """Whether speed and load are constant."""
        return self.speed_spread < STEADY_SPEED and self.load_spread < STEADY_LOAD


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
    if e.rho > NO_LINES_RHO and not e.tau > TONAL:
        return State(names.UNKNOWN, f"no mesh lines: {_share(e)}")
    if e.irregular < REGULAR_RHO:
        return _regular(stage, e)
    if e.speed_spread > SPREAD_LIMIT or e.speed_rate > RATE_LIMIT:
        change = f"{100 * e.speed_spread:.0f} % within {e.seconds} s, up to {100 * e.speed_rate:.1f} % a second"
        return State(names.TRANSIENT, f"speed changed by {change}, too much to judge the residual")
    if e.load_spread > LOAD_LIMIT:
        change = f"{100 * e.load_spread:.0f} % of its mean within {e.seconds} s"
        return State(names.TRANSIENT, f"load changed by {change}, too much to judge the residual")
    return _irregular(e)


def _share(e: Evidence) -> str:
    return f"{100 * e.rho:.0f} % of the variance outside known lines"


def _irregular(e: Evidence) -> State:
    share = _share(e)
    broadband = e.irregular > CHAOTIC_RHO and e.k > CHAOTIC_K
    if e.remembered < FORGETS and (e.tau > TONAL or broadband):
        return State(names.UNKNOWN, f"undecided: {share}, but the motion repeats (r = {e.repetition:.2g})")
    if e.tau > TONAL:
        return State(names.QUASI_PERIODIC, f"{share}, most of it in lines; strongest at order {e.unlisted_order:.4g}")
    if broadband:
        return State(names.CHAOTIC, f"irregular: {share}, broadband")
    return State(names.UNKNOWN, f"undecided: {share}")


def _regular(stage: str, e: Evidence) -> State:
    if e.steady and e.subharmonic_order != 3 and e.remembered > REPEATS_NOT:  # a third doesn't repeat after 200 cycles
        return State(names.UNKNOWN, f"undecided: lines explain it, but it doesn't repeat (r = {e.repetition:.2g})")
    return _periodic(stage, e)


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
