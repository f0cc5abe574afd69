"""What a user asks the superharmonic studies: which gear pair, which theory, which restoring force."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from nw_gear_common.errors import InputError
from nw_gear_sim.superharmonic.firstorder import MODES
from nw_gear_sim.superharmonic.laws import LAWS, equivalent, fitted
from nw_gear_sim.superharmonic.pair import GearPair, gear_pair
from nw_gear_sim.superharmonic.restoring import Fit


@dataclass(frozen=True)
class Question:
    """A question.

    Attributes:
        pair: the gear pair, with the cubic of a fit where one was asked for.
        mode: of the first order.
        slope: of the backlash that the delay equation has; None for the cubic.
        fit: the fit that was asked for, or the one that stands behind the backlash; None for the paper's cubic.
        fit_slope: c k_m of that fit.
    """

    pair: GearPair
    mode: str
    slope: float | None
    fit: Fit | None
    fit_slope: float | None

    @property
    def law(self) -> str:
        """Name of the restoring force of the delay equation."""
        return "cubic" if self.slope is None else "backlash"

    def as_object(self) -> dict[str, Any]:
        """Return what JSON shows of it."""
        shown: dict[str, Any] = {"stage": self.pair.stage, "mode": self.mode, "restoring": self.law}
        shown |= {name: getattr(self.pair, name) for name in ("eps", "w0", "q", "tau_d", "tau_v")}
        if self.slope is not None:
            shown["slope"] = self.slope
        if self.fit is not None:
            fit = self.fit
            shown["fit"] = {
                "interval": fit.interval, "delta_1": fit.delta_1, "delta_2": fit.delta_2, "rms": fit.rms,
                "greatest": fit.greatest, "rms_relative": fit.error, "slope": self.fit_slope,
            }  # fmt: skip
        return shown

    def in_words(self) -> str:
        """Return one line about the fit, "" without."""
        if self.fit is None:
            return ""
        fit = self.fit
        return (
            f"Cubic of the unit backlash on [-{fit.interval:.5g}, {fit.interval:.5g}]: delta_1 = {fit.delta_1:.6g}, "
            f"delta_2 = {fit.delta_2:.6g}; error {fit.rms:.4g} RMS ({100 * fit.error:.3g} % of the backlash), "
            f"{fit.greatest:.4g} at most, in half backlashes. With c k_m = {self.fit_slope:.6g}: "
            f"w0 = {self.pair.w0:.6g}, q = {self.pair.q:.6g}."
        )


def ask(
    stage: str,
    mode: str,
    given: Mapping[str, float | None],
    *,
    restoring: str = "cubic",
    slope: float | None = None,
    fit: float | None = None,
) -> Question:
    """Put a question together.

    Args:
        stage: I, II or III; mode: of `firstorder.MODES`.
        given: parameters in the place of the paper's; None leaves one as it is.
        restoring: of `laws.LAWS`; slope: c k_m beside the gap, that of the pair's own cubic if None.
        fit: half width of the interval of a fit that replaces the pair's cubic.

    Raises:
        InputError: unknown names, or numbers out of range.
    """
    if mode not in MODES:
        raise InputError("mode", " or ".join(MODES), mode)
    if restoring not in LAWS:
        raise InputError("--restoring", " or ".join(LAWS), restoring)
    pair = gear_pair(stage).having(**{name: value for name, value in given.items() if value is not None})
    if restoring == "cubic" and fit is None:
        if slope is not None:
            raise InputError("--slope", "with --restoring backlash or --fit", f"{slope:g}")
        return Question(pair, mode, None, None, None)
    own, own_slope = equivalent(pair)
    stiffness = own_slope if slope is None else slope
    interval = own.interval if fit is None else fit
    made, found = fitted(pair, interval, stiffness)
    return Question(made, mode, stiffness if restoring == "backlash" else None, found, stiffness)
