"""Chooses topics by names and regular expressions, for the recorder and the replay."""

from __future__ import annotations

import re
from collections.abc import Sequence

from nw_gear_common import names
from nw_gear_common.errors import InputError


class Selection:
    """Which topics are wanted.

    A topic is wanted when an entry matches the whole of its absolute name, or of its name inside the namespace. A
    plain name is a regular expression that matches itself.

    Args:
        entries: names or regular expressions; none = everything in the namespace, `/diagnostics` and the clock.
        namespace: of the node.
        clock: topic of the clock that the node follows.
        place: for the error.

    Raises:
        InputError: an entry isn't a regular expression.
    """

    def __init__(
        self, entries: Sequence[str], namespace: str, clock: str = names.CLOCK, place: str = "parameter topics"
    ) -> None:
        self._shared = (names.DIAGNOSTICS, clock)
        self._prefix = namespace.rstrip("/") + "/"
        self._patterns: list[re.Pattern[str]] = []
        for i, entry in enumerate(entry for entry in entries if entry):
            try:
                self._patterns.append(re.compile(entry))
            except re.error as error:
                raise InputError(f"{place}[{i}]", "a name or a regular expression", f"{entry!r}: {error}") from None

    def __call__(self, topic: str) -> bool:
        """Whether a topic (absolute name) is wanted."""
        inside = topic.startswith(self._prefix)
        if not self._patterns:
            return inside or topic in self._shared
        forms = (topic, topic.removeprefix(self._prefix)) if inside else (topic,)
        return any(pattern.fullmatch(form) for pattern in self._patterns for form in forms)
