"""Collects what nodes say about themselves: diagnostics and the simulator's truth."""

from __future__ import annotations

import contextlib
import dataclasses
from typing import Any

from nw_gear_monitor.review.rundata import SILENT, Span

AFTER_END = 1.0
"""Seconds after the last sample in which a status may still tell of the run."""
AT_END = 0.1


class TruthCollector:
    """The last values of the simulator's truth, and the mean over the run of those that are numbers."""

    def __init__(self) -> None:
        self.message = ""
        self.last: dict[str, str] = {}
        self._sums: dict[str, list[float]] = {}

    def add(self, status: Any) -> None:
        """Take one DiagnosticStatus."""
        self.message = status.message
        self.last = {pair.key: pair.value for pair in status.values}
        for key, value in self.last.items():
            with contextlib.suppress(ValueError):
                total = self._sums.setdefault(key, [0.0, 0.0])
                total[0] += float(value)
                total[1] += 1.0

    def means(self) -> dict[str, float]:
        """Mean of every number over all messages."""
        return {key: total / count for key, (total, count) in self._sums.items() if count}


def _last_start(span: Span, end: float) -> float:
    """Until when a stretch may begin to belong to the run; silence that begins with its end is no fault."""
    return end - AT_END if span.level == SILENT else end + AFTER_END


class DiagnosticsCollector:
    """Stretches of constant level and state of every status, with the reason given when they began."""

    def __init__(self) -> None:
        self._spans: dict[str, list[Span]] = {}
        self.values: dict[str, dict[str, str]] = {}

    def add(self, time: float, array: Any, namespace: str = "") -> None:
        """Take one DiagnosticArray; where a namespace is given, what nodes of another one say is left out."""
        for status in array.status:
            if namespace and status.hardware_id not in ("", namespace):
                continue
            values = {pair.key: pair.value for pair in status.values}
            self.values[status.name] = values
            level = status.level[0] if isinstance(status.level, bytes) else int(status.level)
            state = values.get("state", "")
            reason = status.message.removeprefix(state).lstrip(": ")
            spans = self._spans.setdefault(status.name, [])
            begin, same = time, bool(spans) and (spans[-1].level, spans[-1].state) == (level, state)
            if same:
                begin, reason = spans[-1].start, spans[-1].reason
                spans.pop()
            elif spans:
                before = spans[-1]
                spans[-1] = Span(before.name, before.start, time, before.level, before.state, before.reason)
            spans.append(Span(status.name, begin, time, level, state, reason))

    def result(self, start: float, end: float) -> dict[str, tuple[Span, ...]]:
        """The history of every status between two times (s); what was said before the run and after it is left out."""
        found = {}
        for name, spans in sorted(self._spans.items()):
            kept = [span for span in spans if span.end >= start and span.start <= _last_start(span, end)]
            found[name] = tuple(
                dataclasses.replace(span, start=max(span.start, start), end=min(span.end, end + AFTER_END))
                for span in kept
            )
        return {name: spans for name, spans in found.items() if spans}
