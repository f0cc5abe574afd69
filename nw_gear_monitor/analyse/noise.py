"""How much of a sampled signal is white noise, by its differences."""

from __future__ import annotations

from math import comb, inf, log10, sqrt

import numpy as np

from nw_gear_common.tables import Array

ORDER = 6
"""Of the differences: what is smooth over seven samples disappears, white noise grows by sqrt(924)."""


def noise_db(x: Array) -> float:
    """Standard deviation of a signal over that of its noise, dB.

    The noise is that of differences of order 6 over sqrt(C(12, 6)): exact for white noise on a signal that is sampled
    some tens of times a period, too much where it is sampled more coarsely (so that the dB are too few), too little
    where the noise went through a low-pass. Lorenz' and Rössler's flows at 100 and 113 samples a mean period give
    20.1, 30.0, 40.0, 60 dB where there are 20, 30, 40, 60.

    Args:
        x: (samples,) not constant, 7 or more, any unit.
    """
    noise = float(np.std(np.diff(x, ORDER))) / sqrt(comb(2 * ORDER, ORDER))
    return 20.0 * log10(float(np.std(x)) / noise) if noise > 0.0 else inf
