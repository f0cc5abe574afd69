"""What nodes say in `/diagnostics`: the newest word of each, and how states changed over time. Bounded."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

from nw_gear_monitor.review.rundata import Span

MOST_STATUSES = 128
MOST_SPANS = 200


@dataclass(frozen=True)
class Said:
    """The newest status of one task of a node.

    Attributes:
        name: `<node>: <task>`.
        level: 0 to 3.
        message: for people.
        values: further values by key.
        heard: wall time (s, monotonic).
    """

    name: str
    level: int
    message: str
    values: Mapping[str, str]
    heard: float

    @property
    def node(self) -> str:
        """Who said it."""
        return self.name.partition(": ")[0]

    @property
    def task(self) -> str:
        """What it is about."""
        return self.name.partition(": ")[2]

    @property
    def state(self) -> str:
        """The label, "" where the status has none."""
        return self.values.get("state", "")

    @property
    def reason(self) -> str:
        """The message without the label."""
        return self.message.removeprefix(self.state).lstrip(": ") if self.state else self.message


class States:
    """Newest statuses by name, and stretches of constant state of the stages over the run's time."""

    def __init__(self) -> None:
        self.latest: dict[str, Said] = {}
        self.spans: dict[str, deque[Span]] = {}
        self.version = 0

    def add(self, said: Said, time: float) -> None:
        """Take a status that was heard when the newest sample was `time` old (s of ROS time)."""
        if said.name not in self.latest and len(self.latest) >= MOST_STATUSES:
            return
        self.latest[said.name] = said
        self.version += 1
        if not said.state or not said.task.startswith("stage ") or math.isnan(time):
            return
        spans = self.spans.setdefault(said.task, deque(maxlen=MOST_SPANS))
        begin, reason = time, said.reason
        if spans:
            before = spans.pop()
            if (before.level, before.state) == (said.level, said.state):
                begin, reason = before.start, before.reason
            else:
                spans.append(Span(before.name, before.start, time, before.level, before.state, before.reason))
        spans.append(Span(said.task, begin, time, said.level, said.state, reason))

    def begin(self) -> None:
        """Forget the history: a new run begins."""
        self.spans.clear()
        self.version += 1

    def about(self, task: str) -> tuple[Said, ...]:
        """Newest statuses whose task begins with a word, in the order in which they became known."""
        return tuple(said for said in self.latest.values() if said.task.startswith(task))

    def entry(self, task: str) -> Said | None:
        """Newest status of one task, of whichever node spoke of it last."""
        found = [said for said in self.latest.values() if said.task == task]
        return max(found, key=lambda said: said.heard, default=None)
