"""How sure a label is: the least distance of what was measured from what would have changed the label."""

from __future__ import annotations

import math

import numpy as np

from nw_gear_common import names

MARGINS = (0.0, 0.1, 0.3, 1.0)
SHARES = (0.6, 0.8, 0.95, 0.99)


def margin(label: str, values: dict[str, float]) -> float:
    """Least logarithm of a measured ratio over its limit, 0 at the limit."""
    sides = [abs(math.log(max(values["refused"], 1e-9)))] if label in names.PERIODS and values["refused"] > 0.0 else []
    if math.isfinite(values["strength"]) and label in names.PERIODS:
        sides.append(math.log(max(values["strength"], 1.0)))
    if "near" in values:
        near, linear, far = (max(values[key], 1e-9) for key in ("near", "linear", "far"))
        if label == names.QUASI_PERIODIC:
            sides.append(max(math.log(0.12 / far), math.log(2.5 * near / far)))
        elif label == names.CHAOTIC:
            sides += [math.log(0.8 * linear / near), max(math.log(far / 0.12), 0.0)]
        else:
            sides.append(abs(math.log(near / 0.8 / linear)))
    return min(sides, default=math.inf)


def confidence(label: str, values: dict[str, float]) -> float:
    """Probability that a label is right, from its margin."""
    return float(SHARES[int(np.searchsorted(MARGINS, margin(label, values), side="right")) - 1])
