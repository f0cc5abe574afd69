"""The derivative of samples by central differences, for channels that come without one."""

from __future__ import annotations

import numpy as np

from nw_gear_common.tables import Array

WEIGHTS = (4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0)
"""Of the differences x(n + k) - x(n - k), k = 1..4: exact for polynomials up to degree 8."""


def derivative(x: Array, rate: float) -> Array:
    """Differentiate columns of equally spaced samples.

    x'(t_n) = rate * sum_k w_k (x_(n+k) - x_(n-k)), k = 1..4; for a sine the error is (w h)^8 / 630 of its amplitude,
    2 % at four samples a period. The four samples at either end use parabolas, whose error is (w h)^2 / 3.

    Args:
        x: (samples, columns), at least 3 samples.
        rate: samples per second, Hz.
    """
    found = np.gradient(x, 1.0 / rate, axis=0, edge_order=2)
    reach = len(WEIGHTS)
    size = len(x) - 2 * reach
    if size > 0:
        inner = found[reach:-reach]
        inner[:] = 0.0
        for k, weight in enumerate(WEIGHTS, start=1):
            inner += (weight * rate) * (x[reach + k : reach + k + size] - x[reach - k : reach - k + size])
    result: Array = found
    return result
