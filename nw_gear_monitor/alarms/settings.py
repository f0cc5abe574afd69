"""What can be set about baselines and alarms."""

from __future__ import annotations

from dataclasses import dataclass

from nw_gear_common.quantities import quantity

SPEED_RATIO = 1.1
"""Upper over lower limit of a bin in speed."""
LOAD_RATIO = 1.2
"""Upper over lower limit of a bin in load."""
LEAST_SPREAD = 0.05
"""Standard deviation of ln(feature + offset) that a bin has at least: WARN never comes under +16 %, ERROR under +35 %.

Without it a steady run would learn a spread of next to nothing, and the first other wind would raise an alarm. From
0.035 on 0.9 of the limit lies above the mean, so that an alarm can be cleared.
"""

LONG_SPREAD = 2.0
"""So much more may speed and load move within the long window than within the short one."""


@dataclass(frozen=True)
class AlarmSettings:
    """Limits, and what a bin needs before it judges."""

    warn_deviations: float = quantity(
        3.0, "WARN above the mean plus so many standard deviations.", "1", minimum=1.0, maximum=100.0
    )
    error_deviations: float = quantity(
        6.0, "ERROR above the mean plus so many standard deviations.", "1", minimum=1.0, maximum=100.0
    )
    least_windows: int = quantity(30, "Windows that don't overlap before a bin judges.", "1", minimum=5, maximum=100000)
    most_windows: int = quantity(
        1000, "Windows that don't overlap after which a bin has learned enough.", "1", minimum=5, maximum=10000000
    )
    steady_speed: float = quantity(
        0.05,
        "Spread of speed in a short window, over its mean, above which nothing is learned or judged.",
        "1",
        minimum=0.001,
        maximum=1.0,
    )
    steady_load: float = quantity(
        0.2,
        "Spread of load in a short window, over its mean, above which nothing is learned or judged.",
        "1",
        minimum=0.001,
        maximum=2.0,
    )
