"""How long the monitor takes for its hops, and how often that was too long (pure: times are handed in)."""

from __future__ import annotations

from collections import deque

import numpy as np

from nw_gear_monitor import health

HOP_SECONDS = 1.0
GOAL = 0.25
"""Share of a hop that computing it may take: the rest belongs to the simulator and to whatever else runs."""
REMEMBERED = 600
"""Hops that the percentile is taken from."""


class Computation:
    """Counts wall time spent on hops (s)."""

    def __init__(self) -> None:
        self.hops = 0
        self.largest = 0.0
        self.overruns = 0
        self.over_goal = 0
        self._total = 0.0
        self._recent: deque[float] = deque(maxlen=REMEMBERED)

    def add(self, seconds: float) -> None:
        """Count one hop."""
        self._recent.append(seconds)
        self.hops += 1
        self.largest = max(self.largest, seconds)
        self._total += seconds
        self.overruns += seconds > HOP_SECONDS
        self.over_goal += seconds > GOAL * HOP_SECONDS

    def status(self, backlog: int) -> health.Status:
        """The entry for `/diagnostics`; `backlog` blocks wait.

        WARN where the last hop took longer than a hop: samples come faster than they are worked on.
        """
        recent = list(self._recent) or [0.0]
        last = recent[-1]
        values = {
            "hop (s)": f"{last:.4f}",
            "largest hop (s)": f"{self.largest:.4f}",
            "mean hop (s)": f"{self._total / max(self.hops, 1):.4f}",
            f"p99 of the last {REMEMBERED} hops (s)": f"{float(np.percentile(recent, 99)):.4f}",
            "hops (1)": str(self.hops),
            "overruns (1)": str(self.overruns),
            f"hops over {GOAL * HOP_SECONDS:g} s (1)": str(self.over_goal),
            "blocks waiting (1)": str(backlog),
        }
        late = last > HOP_SECONDS
        reason = f"a hop took {last:.2f} s" if late else "keeping up"
        return health.Status("computation", health.WARN if late else health.OK, "", reason, values)
