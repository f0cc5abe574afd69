"""Wind speed drawn around measured means and standard deviations (ten-minute statistics of a mast)."""

from __future__ import annotations

import math

import numpy as np

from nw_gear_common.tables import Array
from nw_gear_sim.noise import GaussianNodes, cubic_weights

NODE = 1.0
"""Spacing of the drawn nodes (s), the usual sampling of a cup anemometer."""

TRANSITION = 15.0
"""Half of the time in which level and deviation pass from one interval to the next (s), at most 1/8 of the interval."""

SHORTEST_INTERVAL = 20.0


class TurbulentWind:
    """Turbulence with given mean and standard deviation in every interval, continuous across their borders.

    At nodes 1 s apart, r = m + s g with Gaussian noise g of unit variance and autocorrelation
    exp(-lag/correlation_time); m and s pass from interval to interval along a smooth step. Within each interval r is
    then corrected to v = r + W (a + b g), where the window W is 1 inside and 0 at both borders, and a and b are such
    that mean and standard deviation of the interval's nodes are exactly the given ones. Between the nodes a cubic is
    followed.

    Limits: the spectrum is that of first-order noise, not Kaimal's; the measured maximum isn't used; negative values
    are clipped at zero, which lifts the mean slightly where the deviation is beyond a third of it; where a jump between
    neighbouring means alone makes more deviation than the file gives, the smallest possible one is taken and counted in
    `exceeded`.

    Args:
        means, deviations: shape (n,), m/s, of consecutive intervals from time 0 on.
        interval: length of an interval, s, at least 20.
        correlation_time: s in which the correlation of g falls to 1/e; 0 = uncorrelated nodes.
        seed: whole number >= 0.
        loop: begin again with the first interval's statistics after the last; otherwise the last one's hold.
    """

    def __init__(
        self, means: Array, deviations: Array, interval: float, correlation_time: float, seed: int, loop: bool
    ) -> None:
        self._means = means
        self._deviations = deviations
        self._loop = loop
        self._count = max(1, round(interval / NODE))
        self._spacing = interval / self._count
        rho = math.exp(-self._spacing / correlation_time) if correlation_time > 0.0 else 0.0
        self._noise = GaussianNodes(seed, rho)
        self._drawn: dict[int, Array] = {}
        self._exceeded: set[int] = set()
        inside = self._spacing * np.arange(self._count, dtype=np.float64)
        width = min(TRANSITION, interval / 8.0)
        self._before = 1.0 - _smooth_step((inside + width) / (2.0 * width))
        self._after = 1.0 - _smooth_step((interval - inside + width) / (2.0 * width))
        self._window = _smooth_step(inside / width) * _smooth_step((interval - inside) / width)

    @property
    def exceeded(self) -> int:
        """Number of intervals drawn so far whose deviation had to be larger than given."""
        return len(self._exceeded)

    def at(self, time: float) -> float:
        """Wind speed (m/s) at a time >= 0 (s), a function of time and seed alone."""
        node, share = divmod(time / self._spacing, 1.0)
        weights = cubic_weights(share)
        return max(0.0, sum(w * self._node(max(0, int(node) + i - 1)) for i, w in enumerate(weights)))

    def _node(self, node: int) -> float:
        interval, place = divmod(node, self._count)
        if interval not in self._drawn:
            self._drawn = {i: values for i, values in self._drawn.items() if abs(i - interval) == 1}
            self._drawn[interval] = self._draw(interval)
        return float(self._drawn[interval][place])

    def _row(self, interval: int) -> int:
        last = len(self._means) - 1
        return interval % (last + 1) if self._loop else min(interval, last)

    def _draw(self, interval: int) -> Array:
        rows = [self._row(max(0, i)) for i in (interval - 1, interval, interval + 1)]
        shares = np.stack((self._before, 1.0 - self._before - self._after, self._after))
        level: Array = self._means[rows] @ shares
        spread: Array = self._deviations[rows] @ shares
        noise = self._noise.take(interval * self._count, self._count)
        mean, deviation = float(self._means[rows[1]]), float(self._deviations[rows[1]])
        values, met = _with_moments(level + spread * noise, noise, self._window, mean, deviation)
        if not met:
            self._exceeded.add(rows[1])
        return values


def _smooth_step(x: Array) -> Array:
    t: Array = np.clip(x, 0.0, 1.0)
    result: Array = t * t * (3.0 - 2.0 * t)
    return result


def _with_moments(raw: Array, noise: Array, window: Array, mean: float, deviation: float) -> tuple[Array, bool]:
    """Add window * (a + b noise) to raw so that mean and deviation come out as given; False where only nearly."""
    base = raw + window * ((mean - raw.mean()) / window.mean())
    shape = window * (noise - (window * noise).mean() / window.mean())
    # Variance of base + b shape, both with known means: var(base) + 2 b cov + b^2 var(shape) = deviation^2.
    power = float((shape**2).mean())
    mixed = float(((base - mean) * shape).mean())
    surplus = float(((base - mean) ** 2).mean()) - deviation**2
    discriminant = mixed**2 - power * surplus
    b = (-mixed + math.copysign(math.sqrt(max(0.0, discriminant)), mixed)) / power
    values: Array = base + b * shape
    return values, discriminant >= -1e-12 * max(1.0, mixed**2)
