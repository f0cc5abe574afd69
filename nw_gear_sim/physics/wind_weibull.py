"""Weibull distributed wind speed that is correlated in time (paper Eq 1, with what it leaves out added)."""

from __future__ import annotations

import math

from nw_gear_sim.noise import GaussianNodes, unit_variance_weights


def from_normal(z: float, shape: float, scale: float) -> float:
    """Return the wind speed (m/s) whose Weibull probability is the normal probability of z.

    v = C (-ln(1 - Phi(z)))^(1/k), the inverse of the distribution function that belongs to Eq 1 of the paper,
    P(v) = 1 - exp(-(v/C)^k).

    Args:
        z: standard normal number.
        shape: k > 0.
        scale: C > 0, m/s.
    """
    if z > 0.0:
        hazard = -math.log(0.5 * math.erfc(z / math.sqrt(2.0)))
    else:
        hazard = -math.log1p(-0.5 * math.erfc(-z / math.sqrt(2.0)))
    return scale * math.pow(hazard, 1.0 / shape)


class WeibullWind:
    """A Weibull process with a Gaussian copula; the paper gives only the distribution, and no correlation.

    Every `interval` a Gaussian number is drawn, correlated with the one before by exp(-interval / correlation_time); in
    between a cubic through four numbers, scaled to unit variance, is followed; the result is mapped to the Weibull
    distribution. Hence the distribution is exact at every moment, speed and its slope are continuous, and the
    autocorrelation at multiples of the interval is that of an Ornstein-Uhlenbeck process (in terms of the underlying
    normal numbers). There is nothing faster than the interval in it: no rotational sampling by the blades.

    Args:
        shape: k, paper: 5.0.
        scale: C, m/s, paper: 11.5.
        interval: s between draws, > 0.
        correlation_time: s in which the correlation falls to 1/e; 0 = uncorrelated draws.
        seed: whole number >= 0.
    """

    def __init__(self, shape: float, scale: float, interval: float, correlation_time: float, seed: int) -> None:
        self._shape = shape
        self._scale = scale
        self._interval = interval
        self._rho = math.exp(-interval / correlation_time) if correlation_time > 0.0 else 0.0
        self._nodes = GaussianNodes(seed, self._rho)

    def at(self, time: float) -> float:
        """Wind speed (m/s) at a time >= 0 (s), a function of time and seed alone."""
        node, share = divmod(time / self._interval, 1.0)
        weights = unit_variance_weights(share, self._rho)
        # Node 0 of the process is the one before the start, so that the cubic has its four nodes there too.
        z = sum(weight * self._nodes[int(node) + i] for i, weight in enumerate(weights))
        return from_normal(z, self._shape, self._scale)
