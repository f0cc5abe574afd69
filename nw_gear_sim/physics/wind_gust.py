"""The extreme operating gust of IEC 61400-1 on top of a steady wind.

All quantities of the standard are quoted from memory of its third edition (2005) and were held against public
implementations of it, not against its text: duration 10.5 s, the factors 0.37, 1.35, 3.3 and 0.1, the normal turbulence
model sigma_1 = I_ref (0.75 V_hub + 5.6 m/s), the scale Lambda_1 = 0.7 z below 60 m and 42 m above, and the wind speed
with a recurrence of one year at hub height V_e1 = 0.8 * 1.4 V_ref.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

DURATION = 10.5


def gust_magnitude(
    mean: float, reference_speed: float, turbulence_intensity: float, rotor_diameter: float, hub_height: float
) -> float:
    """Return V_gust (m/s) of the extreme operating gust.

    V_gust = min(1.35 (V_e1 - V_hub), 3.3 sigma_1 / (1 + 0.1 D / Lambda_1)), never below zero.

    Args:
        mean: V_hub, ten-minute mean at hub height, m/s.
        reference_speed: V_ref, m/s (50, 42.5, 37.5 in classes I, II, III).
        turbulence_intensity: I_ref (0.16, 0.14, 0.12 in classes A, B, C).
        rotor_diameter: D, m.
        hub_height: z, m.
    """
    once_a_year = 0.8 * 1.4 * reference_speed
    sigma_1 = turbulence_intensity * (0.75 * mean + 5.6)
    lambda_1 = 0.7 * min(hub_height, 60.0)
    limit = 1.35 * (once_a_year - mean)
    return max(0.0, min(limit, 3.3 * sigma_1 / (1.0 + 0.1 * rotor_diameter / lambda_1)))


@dataclass(frozen=True)
class GustWind:
    """A steady wind with an extreme operating gust: a dip, a peak of 0.74 V_gust above the mean, a dip.

    v(t) = V_hub - 0.37 V_gust sin(3 pi t/T) (1 - cos(2 pi t/T)) for 0 <= t <= T = 10.5 s, V_hub elsewhere. Clipped at
    zero, which matters for mean winds of about 2 m/s and less, where the standard isn't meant to apply.

    Attributes:
        mean: V_hub, m/s.
        magnitude: V_gust, m/s.
        start: begin of the first gust, s.
        period: time from gust to gust, s, at least T; 0 = a single gust.
    """

    mean: float
    magnitude: float
    start: float
    period: float

    def at(self, time: float) -> float:
        """Wind speed (m/s) at a time (s)."""
        t = time - self.start
        if self.period > 0.0 and t > 0.0:
            t %= self.period
        if not 0.0 <= t <= DURATION:
            return self.mean
        x = math.pi * t / DURATION
        return max(0.0, self.mean - 0.37 * self.magnitude * math.sin(3.0 * x) * (1.0 - math.cos(2.0 * x)))
