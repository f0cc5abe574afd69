"""What share of a mesh's vibration lies in lines at known orders, and whether fractions of f_m are among them.

rho = residual variance / total variance after the lines k f_I + l f_II + m f_III and own harmonics are fitted and taken
out. Regular motion leaves little (roller passage), chaotic motion a lot. Where a group f_s p / n explains more than
LEAST_SHARE of the variance and LEAST_PART of rho, stage s repeats after n mesh periods, and its lines join the comb.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_monitor.signals import comb as combs
from nw_gear_monitor.signals.comb import Comb, Subharmonic
from nw_gear_monitor.signals.linefit import LineFit, fit
from nw_gear_monitor.signals.normal import SHAPES, NormalSecond, extended_second, normal_second

LEAST_SHARE = 0.005
LEAST_PART = 0.2
AT_ONCE = 3
"""Seconds whose normal equations are formed in one hop for a comb that is new, the newest first: 20 to 30 ms each."""
LEAST_REFINED = 8
"""Newest seconds that must be formed before a rebuilt comb is fitted."""
EARLY = 4
"""Seconds from which on subharmonics are looked for, so that the rebuilt comb is there when labels begin."""
KEPT = 3
"""Combs whose normal equations a second keeps: the base one and two rebuilt ones."""


@dataclass(eq=False)
class LineSecond:
    """One second as the fit needs it; normal equations are formed once per comb and kept with it.

    Attributes:
        start: beginning, s.
        rate: samples per second, Hz.
        time: (samples,) s; phase: (samples, phases) rad; x: (samples, channels).
    """

    start: float
    rate: float
    time: Array
    phase: Array
    x: Array
    _formed: dict[Comb, NormalSecond] = field(default_factory=dict)

    def normal(self, comb: Comb, base: Comb | None = None) -> NormalSecond:
        """The normal equations of this second for a comb; `base` is one that it extends, and that is formed."""
        if comb not in self._formed:
            if len(self._formed) == KEPT:
                self._formed.pop(list(self._formed)[1])
            self._formed[comb] = self._form(comb, base)
        return self._formed[comb]

    def _form(self, comb: Comb, base: Comb | None) -> NormalSecond:
        if base is None:
            return normal_second(self.time, self.phase, self.x, self.start, comb)
        stays = 2 * SHAPES * len(base.modulated) + 2 * len(base.steady)
        return extended_second(self.time, self.phase, self.x, self.start, comb, self._formed[base], stays)

    def has(self, comb: Comb) -> bool:
        """Whether they are formed already."""
        return comb in self._formed


@dataclass(frozen=True, eq=False)
class Explained:
    """The outcome for a window.

    Attributes:
        fit: the fit with the comb that was settled on.
        rho: stage -> residual over total variance, all its meshes together.
        subharmonic: (stage number, n) that was accepted, None for none.
        shares: stage -> share of its variance in that subharmonic's lines before the comb was rebuilt.
    """

    fit: LineFit
    rho: dict[str, float]
    subharmonic: Subharmonic | None
    shares: dict[str, float]

    def channel_rho(self, channel: int) -> float:
        """Residual over total variance of one channel; NaN without variance."""
        return _ratio(self.fit.residual[channel : channel + 1], self.fit.energy[channel : channel + 1])


class LineExplainer:
    """Fits windows of one machine.

    Args:
        frequency: (phases,) nominal mesh frequencies, then those of shafts, Hz.
        places: stage -> numbers of its channels, in the order of the stages.
        shafts: for each shaft, the number of the stage whose mesh lines it stands beside.
        sidebands: of shafts, on either side of a mesh line.
        loaded: channels whose mean follows the load; all where None.
    """

    def __init__(
        self,
        frequency: Array,
        places: Mapping[str, list[int]],
        *,
        shafts: Sequence[int] = (),
        sidebands: int = 0,
        loaded: Sequence[int] | None = None,
    ) -> None:
        self._frequency = frequency
        self._places = places
        self._loaded = loaded
        self.base = combs.base(frequency, shafts, sidebands)
        self._refined: dict[Subharmonic, Comb] = {}

    def prepare(self, window: list[LineSecond]) -> None:
        """Do the work for a window too short to be judged that later windows can build on; gives no result."""
        window[-1].normal(self.base)
        if len(window) >= EARLY:
            found = self._best(self._first(window))
            if found is not None:
                _ready(window, self._rebuilt(found), self.base)

    def explain(self, window: list[LineSecond]) -> Explained:
        """Fit the base comb; where a subharmonic is found, fit again with the comb rebuilt on it.

        Forming a new comb's normal equations for a whole window takes too long for one hop. They are formed AT_ONCE
        seconds a hop; until LEAST_REFINED are there, rho is that of the base comb less the subharmonic's share, and
        until the window is complete the newest seconds that are there are fitted. All that depends on the seconds seen
        since the window began, not on time.
        """
        first = self._first(window)
        found = self._best(first)
        if found is None:
            return Explained(first, self._rho(first), None, dict.fromkeys(self._places, 0.0))
        shares = self._by_stage(first, first.candidates[found])
        comb = self._rebuilt(found)
        ready = _ready(window, comb, self.base)
        if len(ready) < LEAST_REFINED:
            rho = {stage: max(value - shares[stage], 0.0) for stage, value in self._rho(first).items()}
            return Explained(first, rho, found, shares)
        second_fit = fit([second.normal(comb) for second in ready], comb, window[-1].rate, self._loaded)
        return Explained(second_fit, self._rho(second_fit), found, shares)

    def _first(self, window: list[LineSecond]) -> LineFit:
        return fit([second.normal(self.base) for second in window], self.base, window[-1].rate, self._loaded)

    def _rebuilt(self, found: Subharmonic) -> Comb:
        if found not in self._refined:
            self._refined[found] = combs.refined(self.base, self._frequency, len(self._places), found)
        return self._refined[found]

    def _best(self, first: LineFit) -> Subharmonic | None:
        """The candidate that explains the largest part of rho in a stage, if it passes; 4 is tried where 2 passed."""
        rho = self._rho(first)
        parts: dict[Subharmonic, float] = {}
        for candidate, gain in first.candidates.items():
            shares = self._by_stage(first, gain)
            passed = [
                shares[stage] / rho[stage] for stage in self._places if shares[stage] > LEAST_SHARE and rho[stage] > 0
            ]
            parts[candidate] = max(passed, default=0.0)
        best = max((c for c in parts if c[1] != 4), key=lambda c: parts[c])
        if parts[best] <= LEAST_PART:
            return None
        stage, divisor = best
        if divisor == 2 and self._adds_to_two(first, stage, rho):
            return stage, 4
        return best

    def _adds_to_two(self, first: LineFit, stage: int, rho: dict[str, float]) -> bool:
        """Whether quarters explain enough of what the halves leave."""
        halves, quarters = (
            self._by_stage(first, first.candidates[stage, 2]),
            self._by_stage(first, first.candidates[stage, 4]),
        )
        left = {name: max(rho[name] - halves[name], 1e-12) for name in self._places}
        return any(quarters[name] > LEAST_SHARE and quarters[name] > LEAST_PART * left[name] for name in self._places)

    def _by_stage(self, first: LineFit, gain: Array) -> dict[str, float]:
        return {
            stage: _ratio(gain[c] * first.energy[c], first.energy[c], nothing=0.0) for stage, c in self._places.items()
        }

    def _rho(self, done: LineFit) -> dict[str, float]:
        return {stage: _ratio(done.residual[c], done.energy[c]) for stage, c in self._places.items()}


def _ready(window: list[LineSecond], comb: Comb, base: Comb) -> list[LineSecond]:
    """Form up to AT_ONCE more seconds, the newest first; returns the newest seconds that are formed without a hole."""
    formed = 0
    for count, second in enumerate(reversed(window)):
        if not second.has(comb):
            if formed == AT_ONCE:
                return window[len(window) - count :]
            second.normal(comb, base)
            formed += 1
    return window


def _ratio(part: Array, whole: Array, nothing: float = float("nan")) -> float:
    total = float(np.sum(whole))
    return float(np.sum(part)) / total if total > 0.0 else nothing
