"""FM4: kurtosis of what a gear's mean turn holds beside its regular lines."""

from __future__ import annotations

import numpy as np

from nw_gear_common.errors import InputError
from nw_gear_common.tables import Array
from nw_gear_monitor.indicators.kurtosis import kurtosis
from nw_gear_monitor.signals import checked

LEAST_SHARE = 1e-10
"""A difference signal whose rms is a smaller share of the regular one's is rounding."""


def fm4(difference: Array, regular: Array | None = None) -> float:
    """Kurtosis of the difference signal.

    FM4 = mean((d - mean d)^4) / mean((d - mean d)^2)^2 (no 3 is subtracted): 3 for a normally distributed difference,
    about N for a single spike in N points; it rises with damage to one or two teeth and falls again as damage spreads.
    Source: Stewart (1977, see `fm0`), from memory.

    Args:
        difference: (per_turn,) `separate(...).difference`, any unit.
        regular: (per_turn,) `separate(...).regular`: where given, a difference that is rounding beside it is refused.

    Raises:
        InputError: fewer than 8 points, a value that isn't finite, nothing but a constant or rounding.
    """
    d = checked.signal("difference", difference, 8)
    if regular is not None:
        limit = LEAST_SHARE * float(np.std(checked.finite("regular", regular, 8)))
        if float(np.std(d)) <= limit:
            raise InputError("difference", "something beside the regular lines", f"rms {np.std(d):.3g}, rounding")
    return kurtosis(d / float(np.max(np.abs(d))))
