"""Quality of service as rosbag2 writes it: a YAML list with words for the policies (metadata version 9)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import yaml

from nw_gear_monitor.records.yamltext import plain

INFINITE = {"sec": 9223372036, "nsec": 854775807}
"""What ROS writes for a duration without end."""

HISTORIES = {0: "system_default", 1: "keep_last", 2: "keep_all", 3: "unknown"}
RELIABILITIES = {0: "system_default", 1: "reliable", 2: "best_effort", 3: "unknown", 4: "best_available"}
DURABILITIES = {0: "system_default", 1: "transient_local", 2: "volatile", 3: "unknown", 4: "best_available"}
"""Numbers of rmw, in which version 8 and older wrote the same policies."""


MOST_DEPTH = 100_000
"""History that a middleware could be asked for; a larger one isn't believed."""


@dataclass(frozen=True)
class Qos:
    """What one publisher offered.

    Attributes:
        reliability: `reliable` or `best_effort`.
        durability: `volatile` or `transient_local`.
        history: `keep_last`, `keep_all`, or `unknown`: over the network a middleware doesn't tell.
        depth: of the history, 0 where unknown.
    """

    reliability: str = "reliable"
    durability: str = "volatile"
    history: str = "unknown"
    depth: int = 0


def as_list(profiles: Sequence[Qos]) -> list[dict[str, Any]]:
    """The profiles as `metadata.yaml` wants them."""
    return [
        {
            "history": profile.history,
            "depth": profile.depth,
            "reliability": profile.reliability,
            "durability": profile.durability,
            "deadline": dict(INFINITE),
            "lifespan": dict(INFINITE),
            "liveliness": "automatic",
            "liveliness_lease_duration": dict(INFINITE),
            "avoid_ros_namespace_conventions": False,
        }
        for profile in profiles
    ]


def to_yaml(profiles: Sequence[Qos]) -> str:
    """The profiles as the metadata of an MCAP channel wants them."""
    return yaml.safe_dump(as_list(profiles), sort_keys=False)


def from_yaml(text: str) -> tuple[Qos, ...]:
    """Read the profiles of a channel, words (version 9) or numbers (older); what can't be understood is left out."""
    try:
        entries = plain(text) or []
    except ValueError:
        return ()
    if not isinstance(entries, list):
        return ()
    return tuple(_profile(entry) for entry in entries if isinstance(entry, dict))


def _profile(entry: dict[str, Any]) -> Qos:
    def word(key: str, numbers: dict[int, str]) -> str:
        value = entry.get(key, "unknown")
        if isinstance(value, int):
            return numbers.get(value, "unknown")
        return value if value in numbers.values() else "unknown"

    depth = entry.get("depth", 0)
    return Qos(
        reliability=word("reliability", RELIABILITIES),
        durability=word("durability", DURABILITIES),
        history=word("history", HISTORIES),
        depth=depth if isinstance(depth, int) and 0 <= depth <= MOST_DEPTH else 0,
    )
