"""Who was heard, and when: a part that has gone quiet is stale until it is heard again."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

WAITING, LIVE, STALE = "waiting", "live", "stale"


@dataclass(frozen=True)
class Presence:
    """State of one node or topic.

    Attributes:
        name: of it.
        state: `waiting` (never heard), `live` or `stale`.
        silent: seconds since it was heard, 0 where it never was.
    """

    name: str
    state: str
    silent: float


class Register:
    """When each of several parts was last heard.

    Args:
        expected: names that are listed although they were never heard.
        stale_after: seconds of silence after which a part is stale.
        most: names that are remembered.
    """

    def __init__(self, expected: Iterable[str], stale_after: float, most: int = 64) -> None:
        self._heard: dict[str, float | None] = dict.fromkeys(expected)
        self._stale_after = stale_after
        self._most = most

    def heard(self, name: str, now: float) -> None:
        """Note that a part was heard (wall time, s, monotonic)."""
        if name in self._heard or len(self._heard) < self._most:
            self._heard[name] = now

    def forget(self, name: str) -> None:
        """Take a part off the list."""
        self._heard.pop(name, None)

    def look(self, name: str, now: float) -> Presence:
        """State of one part."""
        last = self._heard.get(name)
        if last is None:
            return Presence(name, WAITING, 0.0)
        silent = max(0.0, now - last)
        return Presence(name, STALE if silent > self._stale_after else LIVE, silent)

    def everyone(self, now: float) -> tuple[Presence, ...]:
        """State of every part, in the order in which they became known."""
        return tuple(self.look(name, now) for name in self._heard)
